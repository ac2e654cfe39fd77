// Ambient occlusion, the smallest method, which methods/README.md explains. Computes: no radiance, but how open each
// visible point is to its surroundings, in the component `emission`,
//     A(p) = (1 / pi) integral over the hemisphere of V(p, w) cos(theta) dw
// where V is 0 if a surface lies in direction w within `distance`, and 1 otherwise (Zhukov et al. 1998). A direction
// with density cos(theta) / pi makes V itself the estimate.
// Parameters: distance [fraction of the scene's diagonal]; spp as for all methods (max_depth is refused).
// Bias: none. A pass: one sample of every pixel. Fails: never; where no surface is seen the image is black.
#include "common/sampling/warp.h"
#include "methods/method.h"
#include "methods/parts/transport/eye_sample_run.h"

namespace gib {
namespace {
class AmbientOcclusion final : public Method {
public:
    explicit AmbientOcclusion(double distance) : distance_(distance) {}

    Plan plan(const Scene& scene) const override {
        Plan plan{.called_for = effects_of(scene), .unresolved = {all_components.begin(), all_components.end()}};
        plan.add(step_eye_paths, "");
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const float reach = static_cast<float>(distance_) * scene.diagonal();  // [scene units]
        const auto estimate = [reach](RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
            PixelSample sample;
            const auto hit = rays.surface_hit(eye);
            if (!hit) return sample;
            const Frame frame(normal_towards(*hit, -eye.ray.d));
            const Vec3 w_local = square_to_cosine_hemisphere(sampler.at_vertex(0).bsdf_direction());
            TracedRay around{hit->spawn_ray(frame.to_world(w_local))};
            around.ray.t_max = reach;
            rays.trace(around);
            if (!around.found) sample[Component::emission] = Color::Ones();
            return sample;
        };
        return average_eye_samples({.scene = scene, .points = PointSet::sobol, .seed = seed, .stages = stages},
                                   {{Component::emission}, {}}, estimate);
    }

private:
    double distance_;  ///< fraction of the scene's diagonal
};
}  // namespace

MethodDescription describe_ambient_occlusion() {
    return {.name = "ambient_occlusion",
            .sentence = "how open each visible point is to its surroundings: no image of the scene's radiance",
            .parameters = {number_parameter("distance", "0.1", "scene diagonals", 0, 10, "how far it looks")},
            .simulates = Effects::all(),
            .components = {},
            .unbiased = true,
            .create = [](const ParameterValues& values, const MethodDefaults&) -> std::unique_ptr<Method> {
                values.refuse({"max_depth"}, "this method, which follows no paths");
                return std::make_unique<AmbientOcclusion>(values.number("distance"));
            },
            .estimates_radiance = false};
}

}  // namespace gib
