#pragma once
// Reads the <bsdf> elements of a scene file.

#include "common/materials/material.h"
#include "common/reader/scene_texture.h"

namespace gib {

/// Reads any of Mitsuba's bsdfs that the table in the .cpp file lists, including `phong` of its older versions.
/// Throws InputError.
Material parse_bsdf(const NestedObject& object, TextureFiles& files);

}  // namespace gib
