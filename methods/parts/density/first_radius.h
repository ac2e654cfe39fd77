#pragma once
// The radius of the first pass of progressive methods, from the photons themselves: a user gives none.

#include "methods/parts/kd_tree/kd_tree.h"
#include "methods/parts/transport/specular_walk.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// Places where eye paths look photons up.
struct SeenPlaces {
    std::vector<Vec3> on_surfaces, in_media;
};
/// The places of about 1000 eye paths spread over the image; adds the rays traced to `rays`.
SeenPlaces seen_places(const Scene& scene, const WalkSettings& settings, std::uint64_t seed, std::uint64_t& rays);

/// A radius [scene units] as a fact of a run, in scene diagonals.
std::pair<std::string, std::string> radius_fact(std::string name, double radius, const Scene& scene);

/// The radius [scene units] within which a quarter of the places have `wanted` points for which accept(point) holds, of
/// those places that have ten within a tenth of the scene's diagonal; a fiftieth of the diagonal if there is none. So the
/// radius suits the denser light that is seen: at a focus the median would blur most of it, and the densest place would be
/// noise elsewhere for many passes. So would the footprint of a pixel in a dim scene. Densities are found from the ten
/// nearest points, over areas (`dimensions` = 2) or volumes (3).
template <typename Point, typename Accept>
double first_radius(const KdTree<Point>& points, const std::vector<Vec3>& places, double wanted, int dimensions,
                    float diagonal, const Accept& accept) {
    constexpr std::size_t nearest = 10;
    std::vector<float> distances2;
    std::vector<Neighbour> found;
    for (const Vec3& p : places) {
        points.nearest(
            p, nearest, 0.1f * diagonal, [&](const Point& point, float) { return accept(point); }, found);
        if (found.size() == nearest && found.back().distance2 > 0.f) distances2.push_back(found.back().distance2);
    }
    if (distances2.empty()) return 0.02 * double{diagonal};
    const auto quarter = distances2.begin() + static_cast<std::ptrdiff_t>(distances2.size() / 4);
    std::nth_element(distances2.begin(), quarter, distances2.end());
    return std::sqrt(double{*quarter}) * std::pow(wanted / nearest, 1.0 / dimensions);
}

}  // namespace gib
