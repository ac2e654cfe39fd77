// Path tracing: the unbiased reference. Source: Kajiya 1986, "The Rendering Equation".
//
// Computes: every component, by random walks from the eye. Each vertex finds light in two ways, by sampling a point
// of a light and by following a sample of the bsdf or phase function; the power heuristic combines the two (Veach
// 1997, section 9.2). In a medium the probability of the free flights is a factor of both densities, so
// it cancels in the heuristic.
// Parameters: sampler = sobol (default) | independent; spp and max_depth as for all methods.
// Bias: none, for paths that it can sample. It cannot sample paths on which a point, spot or directional light is
// seen through specular surfaces, and it seldom samples paths to a small light behind them (heavy tails).
// A pass: one sample of every pixel.
// Fails: never; non-finite samples are counted and dropped.
#include "methods/path/path.h"

#include "methods/method.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/transport/eye_sample_run.h"
#include "methods/parts/transport/path_walk.h"
#include "methods/parts/transport/point_set_parameter.h"

#include <algorithm>

namespace gib {

namespace {

/// Russian roulette starts at the vertex of this number. Earlier vertices carry most of the image, and ending paths
/// there would add more variance than it saves time.
constexpr int first_roulette_vertex = 3;

/// Russian roulette. A throughput that is not finite goes into the sample, where the film counts it.
bool survives(PathWalk& walk, float most, const VertexNumbers& u, PixelSample& sample) {
    if (walk.at.vertex < first_roulette_vertex) return true;
    return walk.survives(most, u.roulette(), sample[walk.at.path_class.component()]);
}

constexpr auto both_techniques = LightTechniques::light_and_bsdf_sampling;

}  // namespace

PixelSample trace_path(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, const PathSettings& settings) {
    PixelSample sample;
    PathWalk walk(rays, sampler, eye, rays.scene().camera_medium());
    PathState& path = walk.at;
    const auto add = [&](const PathClass& path_class, const Color& radiance) {
        sample[path_class.component()] += path.beta * radiance;
    };
    while (path.vertex < settings.max_edges) {
        const bool is_last = path.vertex + 1 >= settings.max_edges;  // no vertex may follow at the end of this edge
        const Flight flight = walk.fly();
        if (flight.is_black) break;
        if (const auto& p = flight.scattering_at) {
            if (is_last) break;
            path.path_class.in_medium = true;
            const VertexNumbers u = sampler.at_vertex(path.vertex);
            if (settings.light_sampling)
                add(path.path_class, sample_direct_light(rays, *p, walk.wo(), u, walk.surroundings(), both_techniques));
            const Vec3 wi = walk.scatter_in_medium(u, settings.light_sampling);
            if (!survives(walk, most_survival(path.vertex), u, sample)) break;
            walk.go_on(*p, wi);
            continue;
        }
        auto hit = walk.surface_hit();
        sample[path.path_class.component()] += walk.emitted(hit);
        if (!hit) break;
        if (walk.passes_through(*hit)) continue;
        if (is_last) break;

        walk.disperse(*hit, dimension::stratum);
        const VertexNumbers u = sampler.at_vertex(path.vertex);
        const Vec3 wo_local = hit->shading.to_local(walk.wo());
        const LobeTraits& lobes = hit->bsdf->traits_at(wo_local.z());
        const bool sees_lights = settings.light_sampling && (lobes.diffuse || lobes.glossy);
        if (sees_lights) {
            const LobeValues direct =
                sample_direct_light(rays, *hit, wo_local, u, walk.surroundings(), both_techniques);
            if (lobes.diffuse) add(path.path_class.after(LobeKind::diffuse), direct.diffuse);
            if (lobes.glossy) add(path.path_class.after(LobeKind::specular), direct.specular);
        }
        const auto next = walk.scatter(*hit, wo_local, u, Transport::radiance, sees_lights);
        if (!next) break;
        if (!survives(walk, next->delta ? most_specular_survival(path.vertex) : most_survival(path.vertex), u, sample))
            break;
        walk.go_on(*hit, next->wi);
    }
    return sample;
}

namespace {

class PathMethod final : public Method {
public:
    PathMethod(PointSet points, int max_edges, const MethodDescription& description)
        : points_(points), max_edges_(max_edges), description_(description) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, description_);
        // A vertex is connected to a point, spot or directional light by a straight line, never through a mirror.
        plan.unresolved = components_of_delta_paths(scene, plan.called_for);
        const auto& lights = scene.lights();
        if (!plan.unresolved.empty() && plan.called_for.has(Effect::caustics) &&
            !plan.called_for.has(Effect::glossy_lobes) && std::all_of(lights.begin(), lights.end(), is_delta))
            plan.missing.add(Effect::caustics);
        add_eye_paths(plan, scene, max_edges_);
        add_light_sampling(plan, max_edges_);
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan passes = plan(scene);
        const PathSettings settings{max_edges_, passes.runs(pass_light_sampling)};
        return average_eye_samples(
            {.scene = scene, .points = points_, .seed = seed, .stages = stages, .runs = passes.runs(pass_eye_paths)},
            shown_components(scene, passes.called_for, description_),
            [settings](RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
                return trace_path(rays, eye, sampler, settings);
            });
    }

private:
    PointSet points_;
    int max_edges_;
    const MethodDescription& description_;
};

std::unique_ptr<Method> create_path(const ParameterValues& values, const MethodDefaults& defaults) {
    return std::make_unique<PathMethod>(point_set_of(values), max_edges_of(values, defaults), find_method("path"));
}

}  // namespace

MethodDescription describe_path() {
    return {
        .name = "path",
        .sentence = "path tracing that combines light and bsdf sampling: unbiased, high-frequency noise",
        .parameters = {point_set_parameter()},
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = true,
        .create = create_path,
    };
}

}  // namespace gib
