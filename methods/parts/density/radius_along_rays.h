#pragma once
// The radius of look-ups around the eye's rays that balances their bias and their variance, from the photons themselves.

#include "methods/parts/density/light_along_rays.h"
#include "methods/parts/transport/specular_walk.h"

#include <cstdint>

namespace gib {

/// The number of paths from the lights that the search needs for the radius of a map of `paths`: fewer would drown the bias in noise.
std::uint64_t pilot_paths(std::uint64_t paths);
/// The largest radius that the search tries with so many paths [scene units], `pilot`'s own radius.
float longest_radius_along_rays(VolumeLookUp look_up, std::uint64_t pilot_paths, float diagonal);

/// The input of a search: `light` are the photons or beams of `pilot` paths, with the radius longest_radius_along_rays().
struct RadiusSearch {
    const LightAlongRays& light;
    VolumeLookUp look_up;
    float longest;
    double pilot;  ///< paths
    double paths;  ///< of the map whose radius is sought, or of one pass of maps
    bool shrinks;  ///< the radius is that of the first of many passes
};

/// The radius [scene units] of look-ups along eye paths: two fifths of that with the least error, because a smaller radius
/// also takes less time. The variance of N
/// paths is c / (N r^n) and the squared bias b r^4, with n = 1 for beams and 2 for photons, so the error is least where the
/// squared bias is n / 4 of the variance. Both are estimated as in first_radius(): the variance by the sum of squares, as photons
/// come as a Poisson process, the bias by the difference to the radius r / sqrt 2, and its square by the product of two
/// halves of the photons. Errors count with 1 / (S^2 + the median's S^2), S the radiance found. For
/// a mean over passes whose radius shrinks the bias counts (2 - alpha) / alpha^2 = 3 times (alpha = 2/3, n = 2).
double radius_along_rays(const Scene& scene, const WalkSettings& settings, const RadiusSearch& search,
                         std::uint64_t seed, std::uint64_t& rays);

}  // namespace gib
