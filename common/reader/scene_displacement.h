#pragma once
// Reads the displacement of a shape, an addition to Mitsuba's language, and applies it.

#include "common/reader/scene_shape.h"
#include "common/reader/scene_texture.h"

namespace gib {

/// Displaces meshes whose element has the parameter `displacement`, a number or a texture; others stay as they are:
/// - `displacement_scale`, default 1 [scene units], and `displacement_midlevel`, default 0: a vertex moves to the front
///   of the surface by scale * (value - midlevel), where the value is Texture::value();
/// - `displacement_edge` [scene units], default a hundredth of the diagonal of the mesh: longer edges are halved first.
/// The lengths are those after `to_world`. Source: Cook 1984, "Shade trees", SIGGRAPH. Throws InputError at its place
/// for a shape that is no mesh, a texture on a mesh without texture coordinates, and too many triangles.
void displace_shapes(Properties& properties, ParsedShapes& shapes, TextureFiles& textures);

}  // namespace gib
