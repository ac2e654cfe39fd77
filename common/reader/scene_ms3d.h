#pragma once
// Converts the materials of MilkShape 3D models, which are made for OpenGL's shading and do not conserve energy.

#include "common/materials/material.h"
#include "common/mesh_files/mesh_ms3d.h"
#include "common/reader/scene_texture.h"

namespace gib {

/// A diffuse material, or Phong's model if there is a highlight. A colour texture replaces the diffuse colour.
/// Phong's two colours are scaled down together if they sum to more than 1. A material that is not opaque stands
/// behind a mask. `where` is the shape's element, for messages about the texture.
Material material_of(const Ms3dMaterial& material, TextureFiles& files, const SourceLocation& where);

}  // namespace gib
