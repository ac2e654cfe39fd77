#pragma once
// What the materials of MilkShape 3D models mean here. The program has OpenGL's shading, which knows no energy.

#include "common/materials/material.h"
#include "common/mesh_files/mesh_ms3d.h"
#include "common/reader/scene_texture.h"

namespace gib {

/// Diffuse, with its colour texture in place of the diffuse colour; with a highlight Phong's model, of which both
/// colours are scaled down together where they sum to more than 1; behind a mask where it is not opaque. `where` is the
/// shape's element, for messages about the texture.
Material material_of(const Ms3dMaterial& material, TextureFiles& files, const SourceLocation& where);

}  // namespace gib
