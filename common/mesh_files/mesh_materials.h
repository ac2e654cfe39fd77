#pragma once
// Parts of a mesh by the materials of its file.

#include "common/mesh_files/mesh_data.h"

namespace gib {

struct MaterialPart {
    std::string material;  ///< empty for triangles without one
    MeshData mesh;
};

/// Parts a mesh by the materials of its triangles. Each material is one part, at the place of its first triangle; a vertex that
/// several parts share is repeated in each. Attributes
/// and warnings are left out.
std::vector<MaterialPart> parted_by_material(const MeshData& mesh);

/// Whether two names of a material are the same but for capitals and underscores, which differ between a scene of an
/// older version, as it is read, and its mesh file.
bool is_same_material(std::string_view a, std::string_view b);

}  // namespace gib
