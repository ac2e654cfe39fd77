#include "methods/parts/vertices/light_emission.h"

#include "common/scene/scene.h"

namespace gib {

namespace {

constexpr float aimed_share = 0.5f;  ///< of the starts
constexpr std::size_t most_bins = 1 << 12;
/// A map that keeps more than this share of the lights' power does not make up for the ordinary starts that it takes.
constexpr double most_kept = 0.35;

double kept_power(const Scene& scene, const ProjectionMap& map) {
    double kept = 0, all = 0;
    for (std::size_t i = 0; i < scene.lights().size(); ++i) {
        const double power = power_of(scene.lights()[i]).mean();
        kept += map.kept(i) * power;
        all += power;
    }
    return kept / all;
}

bool is_at_infinity(const Light& light) {
    return is_environment(light) || std::holds_alternative<DirectionalLight>(light);
}

}  // namespace

LightEmission::LightEmission(const Scene& scene, bool aims) : scene_(scene) {
    if (!aims) return;
    ProjectionMap map(scene, TargetSurfaces::specular, most_bins);
    if (map.empty() || kept_power(scene, map) > most_kept) return;
    std::vector<std::uint32_t> own_shape;
    for (const Light& light : scene.lights())
        own_shape.push_back(own_shape_of(light, scene.shapes()));
    aim_ = std::make_shared<Aim>(
        Aim{std::move(map), ProjectionTargets(scene, TargetSurfaces::specular), std::move(own_shape)});
}

std::optional<LightEmission::Start> LightEmission::sample(const Sampler& sampler) const {
    Vec2 choice = sampler.get_2d(dimension::emission_light);
    const Vec2 position = sampler.get_2d(dimension::emission_position);
    const Vec2 direction = sampler.get_2d(dimension::emission_direction);
    EmissionSample sample;
    if (!aim_) {
        sample = scene_.sample_emission(choice.x(), position, direction);
    } else {
        const bool aimed = choice.x() < aimed_share;
        choice.x() = aimed ? choice.x() / aimed_share : (choice.x() - aimed_share) / (1.f - aimed_share);
        sample = aimed ? aim_->map.sample_emission(scene_, aim_->map.choose_bin(choice), position, direction)
                       : scene_.sample_emission(choice.x(), position, direction);
        if (is_aimed(sample.light, sample.ray.o, sample.ray.d) != aimed) return std::nullopt;
        sample.power /= double{aimed ? aimed_share : 1.f - aimed_share};
    }
    const bool has_surface = std::holds_alternative<AreaLight>(scene_.lights()[sample.light]);
    const float cos_light = has_surface ? sample.normal.dot(sample.ray.d) : 1.f;
    return Start{sample, cos_light, density(sample.light, sample.ray.o, sample.ray.d, cos_light)};
}

double LightEmission::density(std::uint32_t light, const Vec3& p, const Vec3& w, float cos_light) const {
    if (!aim_) return scene_.emission_pdf(light, w, cos_light);
    if (!is_aimed(light, p, w)) return (1 - double{aimed_share}) * scene_.emission_pdf(light, w, cos_light);
    return double{aimed_share} * aim_->map.density(light) * emission_pdf(scene_.lights()[light], w, cos_light);
}

bool LightEmission::is_aimed(std::uint32_t light, const Vec3& p, const Vec3& w) const {
    if (!(aim_->map.kept(light) > 0)) return false;
    const RayBundle ray{p.cast<double>(), 0, {w.cast<double>(), 0}, is_at_infinity(scene_.lights()[light])};
    std::uint32_t hint = 0;
    return aim_->targets.reach(ray, aim_->own_shape[light], hint) != ProjectionTargets::Reach::none;
}

}  // namespace gib
