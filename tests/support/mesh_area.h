#pragma once
// The area of a mesh, which tests compare with closed forms.

#include "common/mesh_files/mesh_data.h"

namespace gib::test {

inline double area_of(const MeshData& mesh) {
    double area = 0;
    for (const auto& t : mesh.triangles)
        area += 0.5 *
                (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]).norm();
    return area;
}

}  // namespace gib::test
