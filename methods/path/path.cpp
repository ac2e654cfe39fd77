// Path tracing: the unbiased reference. Source: Kajiya 1986, "The Rendering Equation".
//
// Computes: every component, by random walks from the eye. Each vertex finds light in two ways, by sampling a point
// of a light and by following a sample of the bsdf or phase function; the power heuristic combines the two (Veach
// 1997, section 9.2). In a medium the probability of the free flights is a factor of both densities, so
// it cancels in the heuristic.
// Parameters: sampler = sobol (default) | independent; spp and max_depth as for all methods.
// Bias: none, for paths that it can sample. It cannot sample paths on which a point, spot or directional light is
// seen through specular surfaces, and it seldom samples paths to a small light behind them (heavy tails) or to the place that
// a pencil of light meets.
// A pass: one sample of every pixel.
// Fails: never; non-finite samples are counted and dropped.
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/transport/eye_sample_run.h"
#include "methods/parts/transport/trace_path.h"

namespace gib {

namespace {

class PathMethod final : public Method {
public:
    PathMethod(PointSet points, int max_edges, const MethodDescription& description)
        : points_(points), max_edges_(max_edges), description_(description) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, description_);
        leave_out_of_camera_paths(plan, scene);
        add_eye_paths(plan, scene, max_edges_);
        add_light_sampling(plan, max_edges_);
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        const PathSettings settings{max_edges_, planned.runs(step_light_sampling)};
        return average_eye_samples(
            {.scene = scene, .points = points_, .seed = seed, .stages = stages, .runs = planned.runs(step_eye_paths)},
            shown_components(scene, planned.called_for, description_),
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
        .samples_pixels_alone = true,
    };
}

}  // namespace gib
