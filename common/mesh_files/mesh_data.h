#pragma once
// Triangles of a mesh file or a built-in shape. They are in double until the scene's origin is known.

#include "common/core/math.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gib {

struct MeshData {
    std::vector<Vec3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3>
        normals;  ///< per vertex, of any length, zero where the file has none; empty: the file has none at all
    std::vector<Vec2> uvs;  ///< per vertex or empty
};

/// Reads a Wavefront OBJ file: v, vt, vn and f; other statements are passed over. Faces are fanned into triangles.
/// The corners that name the same v/vt/vn share a vertex. Throws InputError at the place in `file`.
MeshData parse_obj(std::string_view text, const std::string& file);

/// Reads a Stanford PLY file, ascii or binary. Properties that are not needed are skipped, faces are fanned into
/// triangles. Throws InputError at the place in `file`; for binary data this is the last line of the header, with the
/// byte offset.
MeshData parse_ply(std::string_view content, const std::string& file);

struct SerializedMesh {
    MeshData data;
    bool face_normals;  ///< whether the file asks for face normals
};
/// Reads mesh number `index`, from 0, of a file in Mitsuba's `serialized` format, version 3 or 4 (Mitsuba's
/// documentation of the plugin). Vertex colours are skipped. Throws InputError for a file that is damaged in any way,
/// its checksum included.
SerializedMesh parse_serialized(std::string_view content, const std::string& file, int index);

/// Whether a normal or a texture coordinate, which are kept in float, can have this value.
inline bool fits_float(double x) { return std::isfinite(static_cast<float>(x)); }

/// The columns of to_world's linear part, which must not be singular, scaled to unit length: the rotation
/// and mirroring in it. The determinant of the linear part itself, a product of its columns' lengths, may
/// leave double's range.
Eigen::Matrix3d unit_columns(const Mat4d& to_world);

/// Transforms positions by `to_world`, and normals by its inverse transpose and to unit length.
void transform_mesh(MeshData& mesh, const Mat4d& to_world);

/// Fills the zero normals with the mean of the adjacent faces' normals, weighted with the angle at the vertex
/// (Thuermer and Wuethrich 1998, "Computing vertex normals from polygonal facets", JGT 3(1)). Vertices whose faces
/// have no area keep zero normals.
void compute_normals(MeshData& mesh);

}  // namespace gib
