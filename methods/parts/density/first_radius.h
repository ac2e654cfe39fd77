#pragma once
// The radius of the first pass of progressive methods, from the photons themselves: a user gives none.

#include "methods/parts/photons/photon_map.h"
#include "methods/parts/transport/specular_walk.h"

#include <string>
#include <utility>
#include <vector>

namespace gib {

/// Places where eye paths look photons up.
struct SeenPlaces {
    std::vector<Vec3> on_surfaces, in_media;
};
/// The places of 8192 eye paths spread over the image; adds the rays traced to `rays`.
SeenPlaces seen_places(const Scene& scene, const WalkSettings& settings, std::uint64_t seed, std::uint64_t& rays);

/// How many passes' paths from the lights first_radius() needs, if a pass has `paths` of them.
std::uint64_t pilot_passes(double paths);

/// The radius [scene units] of a first pass for which bias and variance of the look-ups at the places are in balance, or
/// that with which a look-up finds `most` photons in the mean, if it is smaller: there more photons cost more than they
/// bring. `photons` are those of `passes` passes together, because with the few of a small image the bias would drown in
/// noise (pilot_passes()). `dimensions` is 2 for discs on surfaces and 3 for balls in media.
///
/// The squared error is least where the squared bias, which grows as r^4, is half of the variance, which falls as r^-2.
/// The search doubles the discs until it is 4 times the variance: half of that disc has the least error then. Errors are
/// relative: they count with 1 / (S^2 + the median's S^2), with S the density of the ten nearest photons. The search
/// begins with a radius within which the densest quarter of the places has 1/20 of a photon or more. The footprint of a
/// pixel would be too small in a dim scene. A fiftieth of the diagonal if there is no place with ten photons within a tenth
/// of the diagonal.
double first_radius(const PhotonMap& photons, double passes, const std::vector<Vec3>& places, double most,
                    int dimensions, float diagonal);

/// A radius [scene units] as a fact of a run, in scene diagonals.
std::pair<std::string, std::string> radius_fact(std::string name, double radius, const Scene& scene);

}  // namespace gib
