#pragma once
// Reads MilkShape 3D ASCII files: meshes with their materials, as far as a still picture needs them.

#include "common/mesh_files/mesh_data.h"

#include <optional>

namespace gib {

/// A material as the file gives it, for OpenGL's fixed lighting, with which MilkShape shows it. Colours are between 0
/// and 1.
struct Ms3dMaterial {
    std::string name;
    Color diffuse, specular, emissive;
    float shininess;      ///< exponent of the highlight, from 0 to Phong::highest_exponent
    float transparency;   ///< opacity from 0, invisible, to 1, opaque
    std::string texture;  ///< the colour texture's file name as written; empty: none
};

struct Ms3dGroup {
    std::string name;
    MeshData mesh;                          ///< mesh with normals and uv; v counts from the top of the image
    std::optional<std::uint32_t> material;  ///< index into the model's materials
};

struct Ms3dModel {
    std::vector<Ms3dGroup> groups;  ///< groups with triangles
    std::vector<Ms3dMaterial> materials;
};

/// Reads the blocks Frames, Frame, Meshes and Materials. What follows them, bones and comments, is not read: the
/// vertices stand in the rest pose. Source: the format specification in MilkShape's SDK. Empty lines and lines that
/// start with // are passed over. Throws InputError at the place in `file`.
Ms3dModel parse_ms3d(std::string_view text, const std::string& file);

}  // namespace gib
