#pragma once
// How likely a path that loses no light goes on at most, so that paths among surfaces of albedo 1 end. Survivors are
// weighted up: the cap costs variance, and no bias. But where it ends paths faster than their light falls, the variance
// has no bound: the light of vertices that one path in a million reaches is in no image of an affordable number of
// samples, which are too dark. So caps start late and are weak.

namespace gib {

/// Before this vertex paths are not ended for their length.
inline constexpr int first_capped_vertex = 1024;

/// Of a path that goes on from its vertex with this number.
///
/// Why 0.9999: in a closed room of albedo rho a path's light falls by rho a vertex, and the second moment of the
/// survivors' weights is a sum of (rho^2 / c)^n, which is bounded where rho^2 < c: to an albedo of 0.99995. (With 0.95,
/// to 0.975.) Of a path that never loses light, 11,000 vertices are followed in the mean.
constexpr float most_survival(int vertex) { return vertex < first_capped_vertex ? 1.f : 0.9999f; }

/// The same where no diffuse lobe takes part: by a delta lobe, or (photons) at a surface that has specular ones only.
///
/// Why 0.999: of n survivors' weights the second moment is a sum over vertices k of c^-k times the light that is left
/// at k, which has to fall. Between N interfaces of reflectance R light diffuses in one dimension, by 1 / (2 R)
/// interfaces a mean free path, and falls by e in every 2 R (N + 1 / R)^2 / pi^2 vertices: 410 for two hundred of glass
/// (R = 0.04). So -1 / log(c) = 1000 bounds the variance up to some 320 of them. Before 1024 vertices, which that light
/// reaches with 8 % of its power, it costs nothing at all. Of a path that never ends by itself, 2,000 vertices are
/// followed in the mean.
constexpr float most_specular_survival(int vertex) { return vertex < first_capped_vertex ? 1.f : 0.999f; }

}  // namespace gib
