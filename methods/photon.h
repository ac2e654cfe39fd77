#pragma once
// What a photon is, and the boxes in which photons travel from the walk to the map.

#include "common/math.h"

#include <cstdint>
#include <vector>

namespace gib {

/// Power that arrived at a diffuse surface. 32 bytes.
struct Photon {
    Vec3 p;
    Color power;           ///< [W]
    std::uint32_t wi;      ///< encoded: the direction that it came from, away from the surface
    std::uint16_t normal;  ///< encoded: geometric normal of the surface, on the side that it arrived at
    std::uint16_t edges;   ///< of its path, from the light to here

    Vec3 direction() const;
    Vec3 surface_normal() const;
};
static_assert(sizeof(Photon) == 32);

/// A unit vector in 2 x 16 bits (and in 2 x 8): octahedral map, rounded to the nearest cell; the angle is off by at
/// most 1e-4 (0.02) radians. Source: Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit
/// Vectors".
std::uint32_t encode_direction(const Vec3& w);
Vec3 decode_direction(std::uint32_t code);
std::uint16_t encode_normal(const Vec3& n);
Vec3 decode_normal(std::uint16_t code);

inline Vec3 Photon::direction() const { return decode_direction(wi); }
inline Vec3 Photon::surface_normal() const { return decode_normal(normal); }

}  // namespace gib
