#pragma once
// Effects and components that methods leave out, as sets and in words.

#include "common/scene/effects.h"
#include "experiments/results/layer.h"

#include <string>

namespace gib {

/// The effects whose names stand in a text, separated by `;`. Names of no effect are left out.
Effects effects_named(const std::string& names);
/// "specular reflection, refraction"
std::string words_of(const Effects& effects);
/// "caustic, indirect"
std::string words_of(const Components& components);

}  // namespace gib
