#pragma once
// Moves the vertices of a mesh along its normals by heights that a function of the texture coordinates gives.

#include "common/mesh_files/mesh_data.h"

#include <functional>

namespace gib {

/// The most triangles that a displaced mesh may have: as many as the largest mesh of the scene library.
inline constexpr std::size_t most_displaced_triangles = 10'000'000;

/// Halves the edges that are longer than `longest` [scene units] until none is left. A triangle with one, two or three
/// such edges becomes two, three or four. Whether an edge is halved depends on its two ends alone, so that triangles
/// that share an edge, or have edges in the same place, still fit together. Vertices in the middle have the mean of the
/// ends' texture coordinates and attributes, and of their normals, to unit length. Returns false, and leaves the mesh
/// unfinished, if there would be more than `most` triangles.
bool subdivide(MeshData& mesh, double longest, std::size_t most = most_displaced_triangles);

/// Moves each vertex by `height` [scene units] along the unit normal. Vertices in the same place move along the mean of
/// their normals, so that edges do not open where the height is the same on both sides. `direction` is 1, or -1 if the
/// front of the mesh is against its normals. All normals are computed again (compute_normals()). Vertices that had the
/// same place and the same normal get one normal, as on the seams of texture coordinates; edges stay sharp where the
/// normals differed. A mesh without normals is given them.
void displace(MeshData& mesh, const std::function<double(const Vec2& uv)>& height, double direction);

}  // namespace gib
