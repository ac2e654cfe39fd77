#pragma once
// Triangles of a mesh file or a built-in shape. They are in double until the scene's origin is known.

#include "common/core/load_warnings.h"
#include "common/core/math.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gib {

/// Numbers or colours that a mesh file gives to its vertices or faces.
struct MeshAttribute {
    std::string name;  ///< as Mitsuba 3 names it: `vertex_` or `face_`, then what the file calls it
    bool per_face = false;
    bool grey = false;          ///< one number instead of three, in all channels of `values`
    std::vector<Color> values;  ///< one for each vertex or for each triangle
};

/// A material that a mesh file names for its triangles from number `first` on, up to the next run.
struct MaterialRun {
    std::size_t first;
    std::string name;
};

struct MeshData {
    std::vector<Vec3d> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3>
        normals;            ///< normals per vertex, of any length; zero: the file lacks this one; empty: it has none
    std::vector<Vec2> uvs;  ///< coordinates per vertex, or empty
    std::vector<MeshAttribute> attributes;
    std::vector<MaterialRun> materials;  ///< in the order of the triangles; those before the first run have no name
    LoadWarnings warnings;               ///< about what the reader passed over
};

/// The warning of faces without area.
inline constexpr const char* short_face = "faces of fewer than three corners are left out, the first here";

/// Reads a Wavefront OBJ file: v, vt, vn, f and usemtl. Other statements of the format are passed over, and so is any
/// unknown one, with a warning at the first of each name. A backslash at the end of a line joins the next one to it.
/// Faces are parted into triangles (polygon.h), and those of fewer than three corners left out with a warning, as in PLY
/// files. The corners that name the same v/vt/vn share a vertex. Throws
/// InputError at the place in `file`.
MeshData parse_obj(std::string_view text, const std::string& file);

/// Reads a Stanford PLY file, ascii or binary, with the attributes that Mitsuba 3 finds in it (ply_attributes.h). Other
/// properties are skipped, faces are parted into triangles (polygon.h). Throws InputError at the place in `file`; for
/// binary data this is the last line of the header, with the byte offset.
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

/// Replaces all normals: at each corner of a face, the mean of the normals of those faces around the same place that lean
/// away from this face by less than `angle` [degrees], weighted as by compute_normals(). Vertices are parted where that
/// gives unlike normals at a place. This is the max_smooth_angle of Mitsuba 0.6 (its documentation of the plugin obj).
void compute_normals_between_creases(MeshData& mesh, double angle);

}  // namespace gib
