// Vertex connection and merging: bidirectional path tracing that also merges vertices of the camera's walk with those of
// light paths nearby. Sources: Georgiev et al. 2012, "Light Transport Simulation with Vertex Connection and Merging";
// Hachisuka et al. 2012, "A Path Space Extension for Robust Light Transport Simulation".
//
// Computes: every component. The techniques of bidirectional, and one more for each vertex of a path that follows, seen
// from the light, on a surface that focuses, as mirrors and glass do: it takes this vertex from both walks. All have
// weights that sum to 1 (parts/vertices/technique_sums.h). No connection makes the light of point, spot and
// directional lights that is focused by specular surfaces and seen through others; merging does.
// Elsewhere connections do as well without a bias, and nothing is merged.
// Parameters: techniques = all (default) | photon_mapping | remainder;
// sampler = sobol (default) | independent; alpha; radius and volume_radius [of the first pass, fractions of the
// scene's diagonal, or auto, which is smaller on small bodies]; kernel; shared_paths as for bidirectional; spp and max_depth as for all methods.
// photon_mapping is light sampling, paths that find lights, and merging at every vertex; remainder is the part of the image
// that merging alone can make.
// Bias: of merging only; it falls with the passes towards 0. The image carries an estimate of it, from the same
// vertices within a smaller radius (BiasRule in light_vertex_map.cpp; in media kernel.h).
// A pass: as many light paths as pixels, but 1024 at least unless the radius is given, whose vertices are kept, and then one
// path from the camera and one from a light for every pixel.
// Fails: never; non-finite samples are counted and dropped.
#include "common/scene/scene.h"
#include "methods/parts/density/radius.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/vertices/joined_paths.h"
#include "methods/vcm/merged_vertices.h"

#include <fmt/format.h>

namespace gib {

namespace {

enum class Subset { all, photon_mapping, remainder };
constexpr std::array<std::string_view, 3> subset_names = {"all", "photon_mapping", "remainder"};

Merges merges_of(Subset subset) {
    return subset == Subset::all              ? Merges::behind_focus
           : subset == Subset::photon_mapping ? Merges::everywhere
                                              : Merges::alone;
}

class VertexConnectionAndMerging final : public Method {
public:
    VertexConnectionAndMerging(Subset subset, const PathRules& rules, const MergingSettings& merging)
        : subset_(subset), rules_(rules), merging_(merging) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, find_method("vcm"));
        if (subset_ != Subset::photon_mapping) leave_out(plan, components_of_mirrored_pencils(scene, plan.called_for));
        if (subset_ == Subset::remainder) plan.unresolved = find_method("vcm").components;
        add_joined_paths(plan, scene, rules_);
        plan.add(std::string(step_merging), why_not_merged(scene, plan));
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        Plan planned = plan(scene);
        const ShownComponents shown = shown_components(scene, planned.called_for, find_method("vcm"));
        if (!planned.runs(step_merging)) {
            // Without merging the remainder is black.
            for (Plan::Step& step : planned.steps)
                if (step.name == step_eye_paths && subset_ == Subset::remainder) step.runs = false;
            return start_joined_paths(scene, rules_, {}, planned, shown, seed, stages);
        }
        const bool is_specular =
            planned.called_for.has(Effect::specular_reflection) || planned.called_for.has(Effect::refraction);
        return std::make_unique<JoinedPathsRun<MergedVertices>>(
            scene, rules_, nullptr, planned, shown, seed, stages, [&](const LightPaths& paths) {
                PathRules rules = rules_;
                rules.light_sampling &= planned.runs(step_light_sampling);
                return MergedVertices(scene, paths, rules, merging_, is_specular, seed);
            });
    }

private:
    std::string why_not_merged(const Scene& scene, const Plan& plan) const {
        if (rules_.max_edges < 2) return "a path over a surface has two edges, more than max_depth allows";
        if (!scene.has_light()) return "nothing emits light";
        if (subset_ != Subset::photon_mapping && !plan.called_for.has(Effect::caustics))
            return "no light reaches a diffuse surface by way of a specular one";
        if (subset_ == Subset::remainder && components_of_delta_paths(scene, plan.called_for).empty())
            return "other techniques make every path";
        return "";
    }

    Subset subset_;
    PathRules rules_;
    MergingSettings merging_;
};

std::unique_ptr<Method> create_vcm(const ParameterValues& values, const MethodDefaults& defaults) {
    const auto subset = chosen<Subset>(subset_names, values.choice("techniques"));
    if (subset != Subset::all)
        values.refuse({std::string(shared_paths_name)}, "techniques=" + values.choice("techniques"));
    return std::make_unique<VertexConnectionAndMerging>(
        subset,
        PathRules{.max_edges = max_edges_of(values, defaults),
                  .points = point_set_of(values),
                  .connects = subset != Subset::photon_mapping,
                  .shared_paths = subset == Subset::all ? shared_paths_of(values) : 1},
        MergingSettings{.merges = merges_of(subset),
                        .alpha = values.number("alpha"),
                        .kernel = chosen<Kernel>(kernel_names, values.choice("kernel")),
                        .radius = first_radius_of(values, "radius"),
                        .radius_in_media = first_radius_of(values, "volume_radius"),
                        .first_pass = defaults.first_pass});
}

}  // namespace

MethodDescription describe_vcm() {
    const std::string most = fmt::format("{} vertices", most_merged);
    return {
        .name = "vcm",
        .sentence = "bidirectional path tracing that also merges nearby vertices: consistent, resolves all light paths",
        .parameters = {choice_parameter("techniques", strings(subset_names),
                                        "the ways in which paths are made; remainder: light that only merging finds"),
                       point_set_parameter(), alpha_parameter(), first_radius_parameter("radius", "on surfaces", most),
                       first_radius_parameter("volume_radius", "in media", most),
                       choice_parameter("kernel", strings(kernel_names), "weight of a vertex by its distance"),
                       shared_paths_parameter()},
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = false,
        .create = create_vcm,
        .remainder = {"techniques=remainder", "bidirectional"},
        .ray_cost = 1.7,
    };
}

}  // namespace gib
