// Bidirectional path tracing: every path from the camera is joined with a path from a light in all ways. Sources:
// Lafortune and Willems 1993, "Bi-directional path tracing"; Veach 1997, chapter 10; Georgiev 2012, "Implementing
// Vertex Connection and Merging", without merging; Popov et al. 2015, "Probabilistic Connections for Bidirectional Path
// Tracing".
//
// Computes: every component. A path of k edges can be made by up to k + 1 techniques, which take s of its vertices from
// a light's walk: s = 0, the camera's walk finds the light; s = 1, a point of a light is sampled; s = k, the light's
// walk is connected to the camera; the others connect two vertices. The power heuristic weighs them (technique_sums.h).
// Parameters: sampler = sobol (default) | independent; shared_paths = 16 (default) | 1 | 4 | 64 | 256 light paths that a path
// from the camera may be connected with where it first can be, 1: its own alone (parts/vertices/shared_vertices.h);
// techniques = off (default) | on, which keeps an image of each technique
// (technique_pyramid.h); spp and max_depth as for all methods.
// Bias: none, for paths that it can sample. It cannot sample the light of point, spot, projector and directional lights that
// reaches a diffuse surface through specular ones and is seen through specular ones, E S+ D S+ L.
// A pass: one path from the camera for every pixel, and as many light paths.
// Fails: never; non-finite samples are counted and dropped.
#include "common/scene/scene.h"
#include "methods/bidirectional/technique_pyramid.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/vertices/joined_paths.h"

namespace gib {

namespace {

class Bidirectional final : public Method {
public:
    Bidirectional(const PathRules& rules, bool shows_techniques) : rules_(rules), shows_techniques_(shows_techniques) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, find_method("bidirectional"));
        leave_out(plan, components_of_delta_paths(scene, plan.called_for));
        leave_out(plan, components_of_mirrored_pencils(scene, plan.called_for));
        add_joined_paths(plan, scene, rules_);
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        MakeTechniqueImages make_techniques;
        if (shows_techniques_)
            make_techniques = [&sensor = scene.sensor()](const LightPaths& paths) {
                return std::make_unique<TechniquePyramid>(sensor.width(), sensor.height(),
                                                          paths.sum_unit / paths.count);
            };
        return start_joined_paths(scene, rules_, make_techniques, planned,
                                  shown_components(scene, planned.called_for, find_method("bidirectional")), seed,
                                  stages);
    }

private:
    PathRules rules_;
    bool shows_techniques_;
};

}  // namespace

MethodDescription describe_bidirectional() {
    return {
        .name = "bidirectional",
        .sentence = "paths from the camera and from the lights, joined in all ways: unbiased, resolves caustics",
        .parameters = {point_set_parameter(),
                       choice_parameter(
                           "techniques", {"off", "on"},
                           "keep an image of each technique, weighted and alone, for paths of up to 5 edges"),
                       shared_paths_parameter()},
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = true,
        .create = [](const ParameterValues& values, const MethodDefaults& defaults) -> std::unique_ptr<Method> {
            return std::make_unique<Bidirectional>(PathRules{.max_edges = max_edges_of(values, defaults),
                                                             .points = point_set_of(values),
                                                             .shared_paths = shared_paths_of(values)},
                                                   values.choice("techniques") == "on");
        },
        .ray_cost = 1.6,
    };
}

}  // namespace gib
