#include "methods/parts/density/radius_along_rays.h"

#include "methods/parts/transport/pixel_samples.h"

#include <algorithm>

namespace gib {

namespace {

constexpr std::size_t stretch_paths = 512;
constexpr std::uint64_t stretches_key = 0x73;  ///< keeps these paths apart from those of the passes
constexpr std::size_t nearest_lights = 10;
constexpr std::uint64_t fewest_pilot = 4096, most_pilot = 65536;

using NearLights = std::vector<LightAlongRays::NearLight>;

/// Collects the light near one eye path.
struct StretchVisitor {
    static constexpr bool wants_emission = false;
    static constexpr int splits = 0;
    const LightAlongRays& light;
    NearLights near = {};

    static bool crosses_media() { return true; }
    void emitted(const Color&) {}
    void scattered(const EyeVertex&, const Vec3&) {}
    void diffuse(const EyeVertex&, const SurfaceHit&, const VertexNumbers&) {}
    void crossed(const EyeVertex& vertex, const MediumStretch& stretch) {
        light.collect(stretch, {vertex.edges_left, vertex.walk.at.stratum}, vertex.throughput(), near);
    }
};

/// The light near one eye path, the nearest first, and the weight of its errors.
struct WeighedPath {
    NearLights near;
    double weight;
};

/// Paths that have any light nearby; none if there are too few.
std::vector<WeighedPath> weighed_paths(const Scene& scene, const WalkSettings& settings, const LightAlongRays& light,
                                       std::uint64_t seed, std::uint64_t& rays) {
    std::vector<WeighedPath> paths;
    RayQueries queries(scene);
    const Sensor& sensor = scene.sensor();
    const std::size_t pixels = static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height());
    const std::uint64_t key = combine_keys(seed, stretches_key);
    for (std::size_t i = 0; i < stretch_paths; ++i) {
        const std::size_t pixel = i * pixels / stretch_paths;
        for_each_pixel(queries, PointSet::independent, key, static_cast<std::uint32_t>(i), pixel, pixel + 1,
                       [&](std::size_t, const TracedRay& eye, const Sampler& sampler) {
                           StretchVisitor visitor{light};
                           follow_specular_path(queries, sampler, eye, scene.camera_medium(), settings, visitor);
                           if (visitor.near.size() >= nearest_lights) paths.push_back({std::move(visitor.near), 0});
                       });
    }
    rays += queries.count();
    return paths;
}

/// Sets the weights of the paths' errors, and returns the distance of the tenth light that a quarter of the paths falls below.
double weigh(std::vector<WeighedPath>& paths, const LightAlongRays& light) {
    std::vector<double> distances, radiances;
    for (WeighedPath& path : paths) {
        const auto tenth = path.near.begin() + nearest_lights - 1;
        std::nth_element(path.near.begin(), tenth, path.near.end(),
                         [](const auto& a, const auto& b) { return a.d2 < b.d2; });
        const double r = std::sqrt(tenth->d2);
        for (auto at = path.near.begin(); at != tenth && r > 0; ++at)
            path.weight += at->light * light.kernel(at->d2, r);
        distances.push_back(r);
        radiances.push_back(path.weight);
    }
    const auto quantile = [](std::vector<double>& values, std::size_t at) {
        std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
        return values[at];
    };
    const double median = quantile(radiances, radiances.size() / 2);
    for (WeighedPath& path : paths)
        path.weight = 1 / (sqr(path.weight) + sqr(median));
    return quantile(distances, distances.size() / 4);
}

/// The squared bias over the variance of the pilot's paths with the radius r.
double bias_over_variance(const std::vector<WeighedPath>& paths, const LightAlongRays& light, double r) {
    const double narrow_r = double{narrow_radius} * r;
    double variance = 0, squared_bias = 0;
    for (const WeighedPath& path : paths) {
        std::array<double, 2> bias{};
        double squares = 0;
        for (const auto& [power, d2] : path.near) {
            if (!(d2 < sqr(r))) continue;
            const double added = power * light.kernel(d2, r);
            const double narrow = d2 < sqr(narrow_r) ? power * light.kernel(d2, narrow_r) : 0;
            squares += sqr(added);
            bias[mix64(std::bit_cast<std::uint64_t>(d2)) & 1] += double{bias_of_difference} * (added - narrow);
        }
        variance += path.weight * squares;
        squared_bias += path.weight * (2 * bias[0]) * (2 * bias[1]);
    }
    return variance > 0 ? squared_bias / variance : 0;
}

}  // namespace

std::uint64_t pilot_paths(std::uint64_t paths) { return std::clamp(paths / 8, fewest_pilot, most_pilot); }

float longest_radius_along_rays(VolumeLookUp look_up, std::uint64_t pilot_paths, float diagonal) {
    const float density = static_cast<float>(pilot_paths) / static_cast<float>(fewest_pilot);
    return 0.05f * diagonal / (look_up == VolumeLookUp::beams ? density : std::sqrt(density));
}

double radius_along_rays(const Scene& scene, const WalkSettings& settings, const RadiusSearch& search,
                         std::uint64_t seed, std::uint64_t& rays) {
    std::vector<WeighedPath> paths = weighed_paths(scene, settings, search.light, seed, rays);
    const double longest{search.longest};
    if (paths.empty()) return 0.1 * longest;
    const double n = search.look_up == VolumeLookUp::beams ? 1 : 2;
    constexpr double lights_at_start = 0.05;
    double r =
        weigh(paths, search.light) * std::pow(lights_at_start / nearest_lights * search.pilot / search.paths, 1 / n);
    if (!(r > 0)) return 0.1 * longest;
    // A step of sqrt 2 multiplies the ratio by 2^((4 + n) / 2): the last radius below this bound is the best one.
    const double step = std::numbers::sqrt2, most = n / 4 * std::pow(2.0, (4 + n) / 2);
    const double scale = search.paths / search.pilot * (search.shrinks ? 3 : 1);
    while (r * step < longest && scale * bias_over_variance(paths, search.light, r * step) <= most)
        r *= step;
    return std::min(r, longest);
}

}  // namespace gib
