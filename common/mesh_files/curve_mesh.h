#pragma once
// Curves with a thickness, such as hairs, as meshes.

#include "common/mesh_files/mesh_data.h"

namespace gib {

enum class CurveKind {
    linear,  ///< straight pieces from one control point to the next
    bspline  ///< uniform cubic B-splines, which begin and end beside their outer control points
};

/// Reads a file of curves as Mitsuba 3's `linearcurve` and `bsplinecurve` take it: a line `x y z radius` for each control
/// point, with blank lines between curves. The curves become tubes without ends, whose cross-sections are regular polygons
/// of the circle's area with normals as of the circle; they have 32 corners, or fewer (6 at least) if the mesh would
/// have more than some 4e6 triangles. As in Mitsuba, `to_world` does not change radii. Throws InputError at its place.
MeshData parse_curves(std::string_view text, const std::string& file, CurveKind kind, const Mat4d& to_world);

}  // namespace gib
