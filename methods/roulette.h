#pragma once
// How likely a path that loses no light goes on at most, so that paths among surfaces of albedo 1 end. Survivors are
// weighted up: the cap costs variance, and no bias.

namespace gib {

inline constexpr float most_survival = 0.95f;

/// Of a path that goes on from its vertex with this number where no diffuse lobe takes part: by a delta lobe, or
/// (photons) at a surface that has specular ones only. The cap starts late and is weak: a path through a hundred shells
/// of glass has several hundred vertices. Were they ended as soon as others, one in 0.95^-200 = 30,000 would be alive
/// after 200 of them and weigh as many: images of any affordable number of samples would be too dark.
///
/// Why 0.999: of n survivors' weights the second moment is a sum over vertices k of c^-k times the light that is left
/// at k, which has to fall. Between N interfaces of reflectance R light diffuses in one dimension, by 1 / (2 R)
/// interfaces a mean free path, and falls by e in every 2 R (N + 1 / R)^2 / pi^2 vertices: 410 for two hundred of glass
/// (R = 0.04). So -1 / log(c) = 1000 bounds the variance up to some 320 of them. Before 1024 vertices, which that light
/// reaches with 8 % of its power, it costs nothing at all. Of a path that never ends by itself, 2,000 vertices are
/// followed in the mean.
constexpr float most_specular_survival(int vertex) { return vertex < 1024 ? 1.f : 0.999f; }

}  // namespace gib
