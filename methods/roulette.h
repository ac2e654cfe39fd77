#pragma once
// How likely a path that loses no light goes on at most, so that paths among surfaces of albedo 1 end. Survivors are
// weighted up: the cap costs variance, and no bias.

namespace gib {

inline constexpr float most_survival = 0.95f;

/// Of a path that goes on by a perfectly specular lobe from its vertex with this number. The cap starts late and is weak:
/// a path through a hundred shells of glass has several hundred vertices, some have thousands. Were they ended as soon
/// as others, one in 0.95^-200 = 30,000 would be alive after 200 of them and weigh as many: images of any affordable
/// number of samples would be too dark. Of a path that never ends by itself, 2,000 vertices are followed in the mean.
constexpr float most_specular_survival(int vertex) { return vertex < 1024 ? 1.f : 0.999f; }

}  // namespace gib
