#include "methods/parts/density/radius_along_rays.h"

#include "methods/parts/transport/pixel_samples.h"

#include <algorithm>

namespace gib {

namespace {

constexpr std::size_t stretch_paths = 512;
constexpr std::uint64_t stretches_key = 0x73;  ///< keeps these paths apart from those of the passes
constexpr std::size_t nearest_lights = 10;
/// The radius taken, as a share of the one with the least error: the time of a look-up grows as r^n and its variance as r^-n,
/// so that at equal time a smaller radius has the same noise and less bias. In fog.xml (48 x 48 pixels, 1e4 photons as
/// beams) the radii 0.003, 0.01 and 0.03 of the diagonal have squared errors of 1.2, 0.8 and 2.5e-3 and take 0.7, 1.1 and 2.9 s.
constexpr double share_of_best = 0.4;
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
        light.collect(stretch, {vertex.edges_left, vertex.walk.at.stratum}, vertex.throughput(), vertex.walk.rays,
                      near);
    }
};

/// The light near each eye path that has any.
std::vector<NearLights> near_eye_paths(const Scene& scene, const WalkSettings& settings, const LightAlongRays& light,
                                       std::uint64_t seed, std::uint64_t& rays) {
    std::vector<NearLights> paths;
    RayQueries queries(scene);
    for_paths_over_image(queries, combine_keys(seed, stretches_key), 0, stretch_paths, stretch_paths,
                         [&](const TracedRay& eye, const Sampler& sampler) {
                             StretchVisitor visitor{light};
                             follow_specular_path(queries, sampler, eye, scene.camera_medium(), settings, visitor);
                             if (visitor.near.size() >= nearest_lights) paths.push_back(std::move(visitor.near));
                         });
    rays += queries.count();
    return paths;
}

/// The value that the share `share` of the values falls below.
double quantile(std::vector<double> values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// The distance of the tenth light that a quarter of the paths falls below.
double distance_of_tenth(std::vector<NearLights>& paths) {
    std::vector<double> distances;
    for (NearLights& near : paths) {
        const auto tenth = near.begin() + nearest_lights - 1;
        std::nth_element(near.begin(), tenth, near.end(),
                         [](const auto& a, const auto& b) { return a.at.d2 < b.at.d2; });
        distances.push_back(std::sqrt(tenth->at.d2));
    }
    return quantile(std::move(distances), 0.25);
}

/// Sums over the light near one path, spread over the radius r.
struct Spread {
    double radiance = 0, squares = 0;
    std::array<double, 2> bias{};  ///< of the halves of the light
};

/// The squared bias over the variance of the pilot's paths with the radius r. Their weights bound what one beam along an eye
/// path, which alone outshines all others, adds to the variance.
double bias_over_variance(const std::vector<NearLights>& paths, const LightAlongRays& light, double r) {
    const double narrow_r = double{narrow_radius} * r;
    std::vector<Spread> spreads;
    std::vector<double> radiances;
    for (const NearLights& near : paths) {
        Spread spread;
        for (const auto& [power, at] : near) {
            if (!(at.d2 < sqr(r))) continue;
            const double added = power * light.weight(at, r);
            const double narrow = at.d2 < sqr(narrow_r) ? power * light.weight(at, narrow_r) : 0;
            spread.radiance += added;
            spread.squares += sqr(added);
            spread.bias[mix64(std::bit_cast<std::uint64_t>(at.d2)) & 1] +=
                double{bias_of_difference} * (added - narrow);
        }
        radiances.push_back(spread.radiance);
        spreads.push_back(spread);
    }
    const double median = quantile(std::move(radiances), 0.5);
    double variance = 0, squared_bias = 0;
    for (const Spread& spread : spreads) {
        const double weight = sqr(spread.radiance) + sqr(median);
        if (!(weight > 0)) continue;
        variance += spread.squares / weight;
        squared_bias += (2 * spread.bias[0]) * (2 * spread.bias[1]) / weight;
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
    std::vector<NearLights> paths = near_eye_paths(scene, settings, search.light, seed, rays);
    const double longest{search.longest};
    if (paths.empty()) return 0.1 * longest;
    const double n = search.look_up == VolumeLookUp::beams ? 1 : 2;
    constexpr double lights_at_least = 0.05;
    const double least =
        distance_of_tenth(paths) * std::pow(lights_at_least / nearest_lights * search.pilot / search.paths, 1 / n);
    const double scale = search.paths / search.pilot * (search.shrinks ? 3 : 1);
    // From above, as few photons within a small radius say little about its bias.
    double r = longest;
    while (r > least && scale * bias_over_variance(paths, search.light, r) > n / 4)
        r /= std::numbers::sqrt2;
    return share_of_best * r;
}

}  // namespace gib
