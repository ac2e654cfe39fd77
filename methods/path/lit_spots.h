#pragma once
// Point and spot lights so close to a surface that much of their light leaves from a spot which paths from the camera
// hardly ever meet.
//
// A point light at the height h over a plane sends half of its power there, most of it into a disc of a few h. From there the
// light goes on into the whole scene. A path from the camera finds it by a vertex in that disc, whose share of what the path
// sees is about (h / D)^2 in a scene of size D. Where no path of an image meets the disc, its light is missing from the mean and
// from the estimate of its error. Paths from the lights meet it at once.

#include "methods/parameters.h"

#include <optional>
#include <string>

namespace gib {

class Scene;

struct LitSpots {
    std::size_t light;  ///< index among the scene's lights of that with most power on such spots
    double share;       ///< share of the power of all lights that lands on such spots
    float distance;     ///< of the light from the spot [scene units]
};

/// A direction w from a point light to a surface in distance d lights the area d^2 / |cos| a steradian. The spots are where
/// this is below 1e-6 squared scene diagonals: at 1e6 paths about one meets a steradian's worth. Empty if there are none.
std::optional<LitSpots> lit_spots(const Scene& scene);

/// A warning that the method misses light of such spots: that of path tracing, if they have at least 2 % of the power. Empty
/// for other methods.
std::string seldom_found_light(const Scene& scene, const MethodLabel& label);

}  // namespace gib
