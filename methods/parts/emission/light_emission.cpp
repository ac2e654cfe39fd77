#include "methods/parts/emission/light_emission.h"

#include "common/scene/scene.h"

namespace gib {

namespace {

/// Made in 10 ms; 16 times as many bins take 110 to 170 ms. Shares kept, with these and with so many: glass-sphere 0.026 and
/// 0.025, prism 0.008 and 0.005, cornell-glass 0.29 and 0.17, metal-ring 0.33 and 0.32.
constexpr std::size_t most_bins = 1 << 12;
/// A map that keeps more than this share of the lights' power does not make up for the ordinary starts that it takes.
constexpr double most_kept = 0.35;

}  // namespace

LightEmission::Maps LightEmission::towards_specular(const Scene& scene) {
    std::shared_ptr<const AimedEmission> map = AimedEmission::at_surfaces(scene, TargetSurfaces::specular, most_bins);
    const bool pays = !map->empty() && map->kept_power() <= most_kept;
    return pays ? Maps{std::move(map)} : Maps();
}

std::size_t LightEmission::kind_of(std::uint32_t light, const Vec3& p, const Vec3& w) const {
    std::size_t kind = 0;
    while (kind < maps_.size() && !maps_[kind]->meets_target(*scene_, light, p, w))
        ++kind;
    return kind;
}

std::optional<LightEmission::Start> LightEmission::sample(const Sampler& sampler) const {
    const auto u = sampler.at_start();
    Vec2 choice = u[dimension::emission_light];
    const Vec2 &position = u[dimension::emission_position], &direction = u[dimension::emission_direction];
    std::optional<Start> start(std::in_place);
    EmissionSample& sample = start->sample;
    std::size_t kind = 0;
    if (maps_.empty()) {
        sample = scene_->sample_emission(choice.x(), position, direction);
    } else {
        const auto kinds = static_cast<float>(maps_.size() + 1);
        const float scaled = choice.x() * kinds;
        kind = std::min(static_cast<std::size_t>(scaled), maps_.size());
        choice.x() = std::min(scaled - static_cast<float>(kind), 1.f - unit_roundoff);
        sample = kind < maps_.size()
                     ? maps_[kind]->sample_emission(*scene_, maps_[kind]->choose_bin(choice), position, direction)
                     : scene_->sample_emission(choice.x(), position, direction);
        if (kind_of(sample.light, sample.ray.o, sample.ray.d) != kind) return std::nullopt;
        sample.power *= double{kinds};
    }
    const bool has_surface = std::holds_alternative<AreaLight>(scene_->lights()[sample.light]);
    start->cos_light = has_surface ? sample.normal.dot(sample.ray.d) : 1.f;
    start->density = density_of(kind, sample.light, sample.ray.d, start->cos_light);
    return start;
}

double LightEmission::density_of(std::size_t kind, std::uint32_t light, const Vec3& w, float cos_light) const {
    const double of_kind = kind < maps_.size() ? maps_[kind]->density(*scene_, light, w, cos_light)
                                               : scene_->emission_pdf(light, w, cos_light);
    return of_kind / static_cast<double>(maps_.size() + 1);
}

}  // namespace gib
