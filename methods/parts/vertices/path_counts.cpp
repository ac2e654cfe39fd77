#include "methods/parts/vertices/path_counts.h"

#include "common/scene/scene.h"

#include <algorithm>
#include <cmath>

namespace gib {

LightPaths::LightPaths(const Scene& scene)
    : count(static_cast<double>(scene.sensor().width()) * scene.sensor().height()),
      power(scene.emitted_power().maxCoeff()),
      camera{count, RayQueries(scene).camera_lies_on_surface()} {
    // A diffuse ball around the scene of radius r that gives off the power has the radiance power / (4 pi^2 r^2).
    const double radiance = power / (4 * std::numbers::pi * BoundingSphere(scene.bounds()).area());
    mean_light = std::isfinite(radiance) && radiance > 0 ? std::exp2(std::round(std::log2(radiance * count))) : 1;
    if (!(power > 0)) power = 1;
}

bool has_delta_light(const Scene& scene) { return std::any_of(scene.lights().begin(), scene.lights().end(), is_delta); }

bool has_delta_lobe(const Scene& scene) {
    return std::any_of(scene.materials().begin(), scene.materials().end(),
                       [](const Material& material) { return material.traits().delta; });
}

void add_light_paths(Plan& plan, const Scene& scene, int max_edges) {
    plan.add(std::string(pass_light_paths), scene.has_light() && max_edges >= 2,
             scene.has_light() ? "a path from a light over a surface has two edges, more than max_depth allows"
                               : "nothing emits light");
}

}  // namespace gib
