#include "methods/path/lit_spots.h"

#include "common/sampling/sampler.h"
#include "common/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>

namespace gib {

namespace {

constexpr std::uint32_t directions = 4096;
constexpr double small_area = 1e-6;  ///< [squared scene diagonals / sr]
constexpr double noted_share = 0.02;

std::string_view kind_of(const Light& light) {
    return std::holds_alternative<PointLight>(light)  ? "point light"
           : std::holds_alternative<SpotLight>(light) ? "spot light"
           : std::holds_alternative<AreaLight>(light) ? "lamp"
                                                      : "projector";
}

/// The area that the light leaves from [squared scene units]: 0 at a point, infinite for light from infinitely far away.
double extent_of(const Light& light) {
    if (const auto* lamp = std::get_if<AreaLight>(&light)) return double{lamp->surface.area()};
    return is_point(light) ? 0 : double{infinity};
}

}  // namespace

std::optional<LitSpots> lit_spots(const Scene& scene) {
    const auto& lights = scene.lights();
    const double small = small_area * sqr(double{scene.diagonal()});  // a steradian
    const auto is_small = [&](const Light& light) { return extent_of(light) < small; };
    if (std::none_of(lights.begin(), lights.end(), is_small)) return std::nullopt;
    std::vector<double> on_spots(lights.size());
    std::vector<float> nearest(lights.size(), infinity);
    double all = 0;
    for (std::uint32_t i = 0; i < directions; ++i) {
        const Sampler u(PointSet::sobol, 0, 0, i);
        const EmissionSample start = scene.sample_emission(u.get_1d(0), u.get_2d(1), u.get_2d(2));
        const double power = start.power.sum();
        all += power;
        if (!(power > 0) || !is_small(lights[start.light])) continue;
        const auto hit = scene.intersect(start.ray);
        if (!hit) continue;
        const LobeTraits& lobes = hit->bsdf->traits_at(hit->shading.to_local(-start.ray.d).z());
        const float distance = (hit->p - start.ray.o).norm();
        const double area = double{sqr(distance)} / double{std::abs(hit->ng.dot(start.ray.d))};
        if (!(area < small) || !(lobes.diffuse || lobes.glossy)) continue;
        on_spots[start.light] += power;
        nearest[start.light] = std::min(nearest[start.light], distance);
    }
    double sum = 0;
    for (const double power : on_spots)
        sum += power;
    if (!(sum > 0)) return std::nullopt;
    const auto light = static_cast<std::size_t>(std::max_element(on_spots.begin(), on_spots.end()) - on_spots.begin());
    return LitSpots{light, sum / all, nearest[light]};
}

std::string seldom_found_light(const Scene& scene, const MethodLabel& label) {
    if (label.name != "path") return "";
    const auto spots = lit_spots(scene);
    if (!spots || spots->share < noted_share) return "";
    return fmt::format(
        "'{}' hardly ever finds {:.0f} % of the light, and its error does not show it: a {} (light {} of {}) lies "
        "{:.2g} "
        "scene diagonals from a surface, and this light leaves from a spot too small for paths from the camera; "
        "bidirectional, vcm, light_tracer and photon_mapper find it",
        label.text(), 100 * spots->share, kind_of(scene.lights()[spots->light]), spots->light + 1,
        scene.lights().size(), spots->distance / scene.diagonal());
}

}  // namespace gib
