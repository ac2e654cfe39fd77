#include "methods/parts/vertices/light_emission.h"

#include "common/scene/scene.h"

namespace gib {

namespace {

constexpr float aimed_share = 0.5f;  ///< share of the starts that are aimed
/// Made in 10 ms; 16 times as many bins take 110 to 170 ms. Shares kept, with these and with so many: glass-sphere 0.026 and
/// 0.025, prism 0.008 and 0.005, cornell-glass 0.29 and 0.17, metal-ring 0.33 and 0.32.
constexpr std::size_t most_bins = 1 << 12;
/// A map that keeps more than this share of the lights' power does not make up for the ordinary starts that it takes.
constexpr double most_kept = 0.35;

}  // namespace

LightEmission::LightEmission(const Scene& scene, bool aims) : scene_(scene) {
    if (!aims) return;
    auto map = std::make_shared<ProjectionMap>(scene, TargetSurfaces::specular, most_bins);
    if (!map->empty() && map->kept_power() <= most_kept) map_ = std::move(map);
}

std::optional<LightEmission::Start> LightEmission::sample(const Sampler& sampler) const {
    const auto u = sampler.at_start();
    Vec2 choice = u[dimension::emission_light];
    const Vec2 &position = u[dimension::emission_position], &direction = u[dimension::emission_direction];
    std::optional<Start> start(std::in_place);
    EmissionSample& sample = start->sample;
    if (!map_) {
        sample = scene_.sample_emission(choice.x(), position, direction);
    } else {
        const bool aimed = choice.x() < aimed_share;
        choice.x() = aimed ? choice.x() / aimed_share : (choice.x() - aimed_share) / (1.f - aimed_share);
        sample = aimed ? map_->sample_emission(scene_, map_->choose_bin(choice), position, direction)
                       : scene_.sample_emission(choice.x(), position, direction);
        if (map_->meets_target(sample.light, sample.ray.o, sample.ray.d) != aimed) return std::nullopt;
        sample.power /= double{aimed ? aimed_share : 1.f - aimed_share};
    }
    const bool has_surface = std::holds_alternative<AreaLight>(scene_.lights()[sample.light]);
    start->cos_light = has_surface ? sample.normal.dot(sample.ray.d) : 1.f;
    start->density = density(sample.light, sample.ray.o, sample.ray.d, start->cos_light);
    return start;
}

double LightEmission::density(std::uint32_t light, const Vec3& p, const Vec3& w, float cos_light) const {
    if (!map_) return scene_.emission_pdf(light, w, cos_light);
    if (!map_->meets_target(light, p, w)) return (1 - double{aimed_share}) * scene_.emission_pdf(light, w, cos_light);
    return double{aimed_share} * map_->density(light) * emission_pdf(scene_.lights()[light], w, cos_light);
}

}  // namespace gib
