#pragma once
// The page that shows stored light in the scene: one file, with its data and three.js inside, which opens offline.

#include "experiments/photons/stored_light.h"

#include <array>
#include <cstdint>
#include <string>

namespace gib {

struct PageContent {
    const LoadedScene& scene;
    std::string method;  ///< label
    std::uint64_t seed;
    const CollectedLight& light;
    const ShownImage* estimate = nullptr;  ///< null: a click shows no estimate
};

/// A photon's power relative to its map's mean as three mantissas and an exponent of 8 bits: c = m 2^(e - 136),
/// rounded; 0 if it is not finite. Source: Ward 1991, "Real Pixels", Graphics Gems II.
std::array<std::uint8_t, 4> rgbe_of(const Colord& color);

std::string photons_page(const PageContent& content);

}  // namespace gib
