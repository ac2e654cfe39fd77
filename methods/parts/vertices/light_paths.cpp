#include "methods/parts/vertices/light_paths.h"

#include "common/scene/scene.h"
#include "methods/parts/transport/ray_queries.h"

#include <cmath>

namespace gib {

namespace {

LightEmission emission_of(const Scene& scene, const Plan& plan, StageTimes& stages, const LightPolicy* policy) {
    if (const LightEmission* start = policy ? policy->start(false) : nullptr) return *start;
    if (!plan.runs(step_light_aim)) return LightEmission(scene);
    const auto timer = stages.time(step_light_aim);
    return LightEmission(scene, LightEmission::towards_specular(scene));
}

}  // namespace

LightPaths::LightPaths(const Scene& scene, const Plan& plan, StageTimes& stages, std::shared_ptr<const LightPolicy> by)
    : count(static_cast<double>(scene.sensor().width()) * scene.sensor().height()),
      power(scene.emitted_power().maxCoeff()),
      camera_on_surface(RayQueries(scene).camera_lies_on_surface()),
      policy(std::move(by)),
      emission(emission_of(scene, plan, stages, policy.get())) {
    // A diffuse ball around the scene of radius r that gives off the power has the radiance power / (4 pi^2 r^2).
    const double radiance = power / (4 * std::numbers::pi * BoundingSphere(scene.bounds()).area());
    sum_unit = std::isfinite(radiance) && radiance > 0 ? std::exp2(10 + std::round(std::log2(radiance * count))) : 1;
    if (!(power > 0)) power = 1;
}

void add_light_paths(Plan& plan, const Scene& scene, int max_edges) {
    plan.add(step_light_paths, scene.has_light() && max_edges >= 2,
             scene.has_light() ? "a path from a light over a surface has two edges, more than max_depth allows"
                               : "nothing emits light");
    const bool follows = plan.runs(step_light_paths);
    plan.add(step_light_aim, follows && plan.called_for.has(Effect::caustics),
             follows ? "no light reaches a diffuse surface by way of a specular one" : "no light paths are followed");
}

}  // namespace gib
