#pragma once
// The <bsdf> elements of a scene file.

#include "common/materials/material.h"
#include "common/reader/scene_texture.h"

namespace gib {

/// Any of Mitsuba's bsdfs in the table of the .cpp file, and its older `phong`. Throws InputError.
Material parse_bsdf(const NestedObject& object, TextureFiles& files);

}  // namespace gib
