#pragma once
// The radius of the first pass of progressive methods, from the photons themselves: a user gives none.

#include "methods/parts/density/density_estimate.h"
#include "methods/parts/kd_tree/kd_tree.h"
#include "methods/parts/transport/specular_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
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
inline std::uint64_t pilot_passes(double paths) {
    constexpr double enough = 65536;
    return static_cast<std::uint64_t>(std::max(1.0, std::ceil(enough / paths)));
}

/// A radius [scene units] as a fact of a run, in scene diagonals.
std::pair<std::string, std::string> radius_fact(std::string name, double radius, const Scene& scene);

/// The half that a point belongs to, 0 or 1, drawn from the bits of its place.
inline std::size_t random_half(const Vec3& p) {
    return combine_keys(combine_keys(std::bit_cast<std::uint32_t>(p.x()), std::bit_cast<std::uint32_t>(p.y())),
                        std::bit_cast<std::uint32_t>(p.z())) &
           1;
}

/// A place where eye paths look photons up, and how much an error there counts.
struct WeighedPlace {
    Vec3 p;
    double weight;
};

/// Look-ups within r around the places.
struct TriedRadius {
    double points = 0;              ///< found in a look-up, in the mean
    double bias_over_variance = 0;  ///< squared bias over variance, of means over the passes
};

/// Tries a radius on the points of several `passes` together; the result is that of one.
///
/// With points of powers w, the density S(r) = sum w / (pi r^2) has the variance sum w^2 / (pi r^2)^2, because points come
/// as a Poisson process. Its bias is 2 (S(r) - S(r / sqrt 2)). The square of the bias is the product of those of two
/// halves of the points, in whose expectation their noise is absent. With alpha = 2/3 the variance of a mean over N
/// passes is that of the first times N^(-2/3) / (2 - alpha), and on surfaces the squared bias is that of the first times
/// N^(-2/3) / alpha^2, so the ratio is the same for any number of passes. In media (`dimensions` = 3) balls stand for discs.
template <typename Point, typename Weigh>
TriedRadius try_radius(double r, const KdTree<Point>& points, double passes, const std::vector<WeighedPlace>& places,
                       int dimensions, const Weigh& weigh) {
    constexpr double alpha = 2.0 / 3;
    const double outside = 1, inside = 1 - std::pow(double{narrow_radius}, -dimensions);
    const double narrow2 = sqr(double{narrow_radius} * r);
    TriedRadius tried;
    double variance = 0, squared_bias = 0;
    for (const WeighedPlace& place : places) {
        std::array<double, 2> bias{};
        double squares = 0;
        points.within(place.p, static_cast<float>(r), [&](const Point& point, float distance2) {
            const double power = weigh(point);
            tried.points += power > 0 ? 1 : 0;
            squares += sqr(power);
            bias[random_half(point.p)] += double{bias_of_difference} * power * (distance2 < narrow2 ? inside : outside);
        });
        variance += place.weight * squares;
        squared_bias += place.weight * (2 * bias[0]) * (2 * bias[1]);
    }
    tried.points /= passes * static_cast<double>(places.size());
    // The sums grow with the passes: the variance of one pass is that of the sum over `passes`, its bias over `passes`^2.
    if (variance > 0) tried.bias_over_variance = squared_bias / (passes * variance) * (2 - alpha) / sqr(alpha);
    return tried;
}

/// The radius [scene units] of a first pass for which bias and variance of the look-ups at the places are in balance, or
/// that with which a look-up finds `most` points in the mean, if it is smaller: there more points cost more than
/// they bring. The squared error is least where the squared bias, which grows as r^4, is half of the variance, which falls
/// as r^-2. The search doubles the discs until it is 4 times the variance: half of that disc has the least error then.
/// Errors are relative: they count with 1 / (S^2 + the median's S^2), with S the density of the ten nearest points.
///
/// It begins with a radius within which the densest quarter of the places has 1/20 of a point or more. `points` are those of
/// `passes` passes together: with the few of a small image the bias would drown in noise (pilot_passes()). The footprint of a pixel would be too small in a dim scene. A fiftieth of the diagonal if there is no place with ten
/// points within a tenth of the diagonal. weigh(point) is the power of a point, or 0 if it does not count.
template <typename Point, typename Weigh>
double first_radius(const KdTree<Point>& points, double passes, const std::vector<Vec3>& places, double most,
                    int dimensions, float diagonal, const Weigh& weigh) {
    constexpr std::size_t nearest = 10;
    constexpr double points_at_start = 0.05, never = std::numeric_limits<double>::infinity();
    const double longest = 0.1 * double{diagonal};
    std::vector<WeighedPlace> weighed;
    std::vector<double> areas;  // r^2, or r^3 in media, of the ten nearest points
    std::vector<Neighbour> found;
    for (const Vec3& p : places) {
        points.nearest(
            p, nearest, static_cast<float>(longest), [&](const Point& point, float) { return weigh(point) > 0; },
            found);
        const bool full = found.size() == nearest && found.back().distance2 > 0.f;
        weighed.push_back({p, full ? std::pow(double{found.back().distance2}, 0.5 * dimensions) : never});
        if (full) areas.push_back(weighed.back().weight);
    }
    if (areas.empty()) return 0.02 * double{diagonal};
    std::sort(areas.begin(), areas.end());
    const double median = areas[areas.size() / 2], quarter = areas[areas.size() / 4];
    for (WeighedPlace& place : weighed)
        place.weight = 1 / (sqr(median / place.weight) + 1);

    const double step = std::pow(2.0, 1.0 / dimensions);
    double r = std::pow(quarter * points_at_start * passes / nearest, 1.0 / dimensions);
    for (; r * step < longest; r *= step) {
        const TriedRadius larger = try_radius(r * step, points, passes, weighed, dimensions, weigh);
        if (larger.points > most || larger.bias_over_variance > 4) break;
    }
    return r;
}

}  // namespace gib
