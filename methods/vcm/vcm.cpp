// Vertex connection and merging: bidirectional path tracing that also merges vertices of the camera's walk with those of
// light paths nearby. Sources: Georgiev et al. 2012, "Light Transport Simulation with Vertex Connection and Merging";
// Hachisuka et al. 2012, "A Path Space Extension for Robust Light Transport Simulation".
//
// Computes: every component. The techniques of bidirectional, and one more for each vertex of a path that follows, seen
// from the light, on a surface that focuses, as mirrors and glass do: it takes this vertex from both walks. All have
// weights that sum to 1 (parts/vertices/technique_sums.h). Merging is the only way to make the light of point, spot and
// directional lights that is focused by specular surfaces and seen through others, and by far the best for small lamps.
// Elsewhere connections do as well without a bias, and nothing is merged.
// Parameters: techniques = all (default) | path_tracing | light_tracing | bidirectional | photon_mapping | remainder;
// sampler = sobol (default) | independent; alpha; first_pass; radius and volume_radius [of the first pass, fractions of the
// scene's diagonal, or auto, which is smaller on small bodies]; kernel; shared_paths as for bidirectional; spp and max_depth as for all methods.
// photon_mapping is light sampling, paths that find lights, and merging at every vertex; remainder is the part of the image
// that merging alone can make.
// Bias: of merging only; it falls with the passes, without a floor. The image carries an estimate of it, from the same
// vertices within a smaller radius (parts/density/density_estimate.h).
// A pass: as many light paths as pixels, but 1024 at least unless the radius is given, whose vertices are kept, and then one
// path from the camera and one from a light for every pixel.
// Fails: never; non-finite samples are counted and dropped.
#include "common/scene/scene.h"
#include "methods/parts/density/progressive_parameters.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/transport/point_set_parameter.h"
#include "methods/parts/vertices/joined_paths.h"

#include <fmt/format.h>

namespace gib {

namespace {

enum class Subset { all, path_tracing, light_tracing, bidirectional, photon_mapping, remainder };
constexpr std::array<std::string_view, 6> subset_names = {"all",           "path_tracing",   "light_tracing",
                                                          "bidirectional", "photon_mapping", "remainder"};

Techniques techniques_of(Subset subset) {
    const bool traces_paths = subset != Subset::light_tracing;
    const bool from_both_ends = subset == Subset::all || subset == Subset::bidirectional || subset == Subset::remainder;
    return {.hits = traces_paths,
            .light_sampling = traces_paths,
            .connections = from_both_ends,
            .camera = from_both_ends || subset == Subset::light_tracing,
            .merges = subset == Subset::all              ? Merges::behind_focus
                      : subset == Subset::photon_mapping ? Merges::everywhere
                      : subset == Subset::remainder      ? Merges::alone
                                                         : Merges::none};
}

class VertexConnectionAndMerging final : public Method {
public:
    VertexConnectionAndMerging(Subset subset, const JoinedPathsSettings& settings)
        : subset_(subset), settings_(settings) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, find_method("vcm"));
        if (!merges()) leave_out(plan, components_of_delta_paths(scene, plan.called_for));
        if (subset_ == Subset::path_tracing) leave_out_of_camera_paths(plan, scene);
        else if (subset_ != Subset::photon_mapping)
            leave_out(plan, components_of_mirrored_pencils(scene, plan.called_for));
        if (subset_ == Subset::remainder || (subset_ == Subset::light_tracing && has_delta_lobe(scene)))
            plan.unresolved = find_method("vcm").components;
        add_joined_paths(plan, scene, settings_);
        plan.add(std::string(step_merging), why_not_merged(scene, plan));
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        return start_joined_paths(scene, settings_, planned,
                                  shown_components(scene, planned.called_for, find_method("vcm")), seed, stages);
    }

private:
    bool merges() const { return settings_.used.merges != Merges::none; }

    std::string why_not_merged(const Scene& scene, const Plan& plan) const {
        if (!merges()) return "techniques leave merging out";
        if (settings_.max_edges < 2) return "a path over a surface has two edges, more than max_depth allows";
        if (!scene.has_light()) return "nothing emits light";
        if (subset_ != Subset::photon_mapping && !plan.called_for.has(Effect::caustics))
            return "no light reaches a diffuse surface by way of a specular one";
        if (subset_ == Subset::remainder && components_of_delta_paths(scene, plan.called_for).empty())
            return "other techniques make every path";
        return "";
    }

    Subset subset_;
    JoinedPathsSettings settings_;
};

std::unique_ptr<Method> create_vcm(const ParameterValues& values, const MethodDefaults& defaults) {
    const auto subset = chosen<Subset>(subset_names, values.choice("techniques"));
    if (techniques_of(subset).merges == Merges::none)
        values.refuse({"alpha", "first_pass", "radius", "volume_radius", "kernel"},
                      "techniques=" + values.choice("techniques"));
    if (!connects_paths(techniques_of(subset)))
        values.refuse({std::string(shared_paths_name)}, "techniques=" + values.choice("techniques"));
    return std::make_unique<VertexConnectionAndMerging>(
        subset,
        JoinedPathsSettings{
            .points = point_set_of(values),
            .max_edges = max_edges_of(values, defaults),
            .used = techniques_of(subset),
            .merging = MergingSettings{.alpha = values.number("alpha"),
                                       .kernel = chosen<Kernel>(kernel_names, values.choice("kernel")),
                                       .radius = first_radius_of(values, "radius"),
                                       .radius_in_media = first_radius_of(values, "volume_radius"),
                                       .first_pass = static_cast<std::uint64_t>(values.integer(first_pass_name))},
            .shared_paths = shared_paths_of(values)});
}

}  // namespace

MethodDescription describe_vcm() {
    const std::string most = fmt::format("{} vertices", most_merged);
    return {
        .name = "vcm",
        .sentence = "bidirectional path tracing that also merges nearby vertices: consistent, resolves all light paths",
        .parameters = {choice_parameter(
                           "techniques", strings(subset_names),
                           "the ways in which paths are made; remainder: the part that merging alone makes"),
                       point_set_parameter(), alpha_parameter(), first_pass_parameter(),
                       first_radius_parameter("radius", "on surfaces", most),
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
