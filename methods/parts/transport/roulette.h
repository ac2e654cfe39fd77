#pragma once
// Russian roulette, and upper bounds of its survival probability. The bounds end paths that lose no light, among surfaces of
// albedo 1. Survivors are weighted up, so a bound causes variance but no bias. Where it ends paths faster than their
// light falls, the variance is infinite: images of an affordable number of samples then miss the light of vertices
// that one path in a million reaches, and are too dark. So the bounds apply late and are weak.

#include "common/core/math.h"

namespace gib {

/// Russian roulette: the path survives with this probability, and `beta` is then divided by it. Returns false if the
/// path ends.
inline bool survives(Color& beta, float probability, float u) {
    if (!(u < probability)) return false;
    beta /= probability;
    return true;
}

/// Roulette of the camera's paths starts at the vertex of this number. Earlier vertices carry most of the image, and ending paths
/// there would add more variance than it saves time.
inline constexpr int first_roulette_vertex = 3;

/// Paths before this vertex are not ended because of their length.
inline constexpr int first_capped_vertex = 1024;

/// Largest survival probability of a path at the vertex of this number.
///
/// Why 0.9999: in a closed room of albedo rho, the light of a path falls by the factor rho a vertex. The second
/// moment of the survivors' weights is a sum of (rho^2 / c)^n for the bound c. It is finite where rho^2 < c, that is,
/// up to an albedo of 0.99995 (with c = 0.95 only up to 0.975). A path that never loses light is followed for 11,000
/// vertices on average.
constexpr float most_survival(int vertex) { return vertex < first_capped_vertex ? 1.f : 0.9999f; }

/// Largest survival probability where no diffuse lobe takes part: after a delta lobe, or for photons at a surface
/// that has specular lobes only.
///
/// Why 0.999: the second moment of the survivors' weights is a sum over vertices k of c^-k times the light that is
/// left at k, and this product has to fall with k. Between N interfaces of reflectance R, light diffuses in one
/// dimension with a mean free path of 1 / (2 R) interfaces, and falls by the factor e in 2 R (N + 1 / R)^2 / pi^2
/// vertices. That is 410 vertices for N = 200 interfaces of glass (R = 0.04). So -1 / log(c) = 1000 bounds the
/// variance for up to some 320 interfaces. The bound costs nothing before vertex 1024, which that light reaches with
/// 8 % of its power. A path that never ends by itself is followed for 2,000 vertices on average.
constexpr float most_specular_survival(int vertex) { return vertex < first_capped_vertex ? 1.f : 0.999f; }

}  // namespace gib
