// Path tracing with specular manifold sampling. Sources: Zeltner, Georgiev and Jakob 2020, "Specular Manifold Sampling
// for Rendering High-Frequency Caustics and Glints"; Hanika, Droske and Manzi 2015, "Manifold Next Event Estimation".
//
// Computes: every component, by the paths of `path`. At each surface that is no pure delta, light that comes through a
// chain of 1 to `chain` smooth vertices (dielectrics, conductors, plastics) is sampled by Newton's method from the
// surface to the light, where that is the better way, and otherwise found by hitting the lamp. A pilot decides which of
// the two makes the chains of a lamp; those of point, spot, projector and directional lights are made by nothing else.
// Parameters: chain = 6 vertices at most between a surface and a light; sampler, spp and max_depth as for all methods.
// Bias: none, for paths that it makes. The exception is the edge of a caustic: two chains count as one if their
// directions differ by less than rounding in single precision (1e-5 and more), and a chain whose direction is not known
// to 1e-3 is not found. It leaves out light of delta lights through more than `chain` vertices, through reflections of
// thin sheets, through bumped, coated or blended surfaces, and through chains that start in a medium.
// A pass: one sample of every pixel.
// Fails: never; non-finite samples are counted and dropped. A chain that a million seeds did not find again is one of
// them (the fact `lost`).
#include "methods/manifold_path/chain_directions.h"
#include "methods/manifold_path/chain_pilot.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/transport/pixel_samples.h"
#include "methods/parts/transport/trace_path.h"

#include <fmt/format.h>

namespace gib {

namespace {

constexpr std::string_view step_chains = "specular chains", step_longer_chains = "longer chains";

struct Settings {
    PointSet points;
    int chain, max_edges;
};

class ManifoldPathRun final : public Run {
public:
    ManifoldPathRun(const Scene& scene, const Settings& settings, const Plan& plan, const ShownComponents& shown,
                    std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          settings_(settings),
          light_sampling_(plan.runs(step_light_sampling)),
          seed_(seed),
          stages_(stages),
          runs_(plan.runs(step_eye_paths)),
          film_(scene.sensor().width(), scene.sensor().height(), shown.accumulated, shown.black) {
        if (!plan.runs(step_chains)) return;
        const auto timer = stages.time(step_chains);
        chains_.emplace(scene, settings.chain);
        rays_ = learn_kinds(scene, *chains_, settings.max_edges);
        if (chains_->empty()) chains_.reset();
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!runs_) return Progress::converged;
        rays_ += sample_pixels(scene_, film_, settings_.points, seed_, pass, stages_, step_eye_paths, [this] {
            return [this](RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
                if (!chains_) return trace_path(rays, eye, sampler, {settings_.max_edges, light_sampling_});
                ChainDirections directions(*chains_, counts_, [](const auto&...) {});
                return trace_path_in(directions, rays, eye, sampler, settings_.max_edges, light_sampling_);
            };
        });
        return Progress::more;
    }

    ComponentImages image() const override { return film_.mean(passes_); }
    RunCounts counts() const override { return {0, rays_, film_.non_finite()}; }
    std::vector<std::pair<std::string, std::string>> facts() const override {
        return {{"samples", chains_ ? fmt::format("{:.2g}", chains_->samples()) : "0"},
                {"chains", std::to_string(counts_.chains)},
                {"trials", std::to_string(counts_.trials)},
                {"lost", std::to_string(counts_.lost)}};
    }

private:
    const Scene& scene_;
    Settings settings_;
    bool light_sampling_;
    std::uint64_t seed_;
    StageTimes& stages_;
    bool runs_;
    Film film_;
    std::optional<ChainSampler> chains_;
    ChainCounts counts_;
    std::uint64_t rays_ = 0;
    std::uint32_t passes_ = 0;
};

/// Why no chains are sampled; empty if they are.
std::string without_chains(const Scene& scene, const Plan& plan, const Settings& settings) {
    if (!plan.runs(step_light_sampling)) return "no light can be sampled from any surface";
    if (!plan.called_for.has(Effect::caustics)) return "no light reaches a diffuse surface through specular ones";
    if (settings.max_edges < 3) return "paths of three edges are longer than max_depth allows";
    const ChainSampler chains(scene, settings.chain);
    if (chains.empty()) return "no lamp and smooth surface make chains, or too many do";
    return "";
}

/// Whether chains reach all delta lobes that delta lights may be seen through.
bool makes_all_materials(const Scene& scene) {
    return std::all_of(scene.materials().begin(), scene.materials().end(),
                       [](const Material& material) { return !material.traits().delta || makes_chains(material); });
}

/// Whether light may be reflected again and again without loss: by two mirrors, or by one that is neither flat nor a
/// sphere.
bool has_facing_mirrors(const Scene& scene) {
    int mirrors = scene.instances().empty() ? 0 : 1;
    for (std::size_t i = 0; i < scene.shapes().size(); ++i) {
        const LobeTraits& lobes = scene.material_of_shape(i).traits();
        if (!lobes.delta || lobes.transmission || lobes.diffuse) continue;
        const auto* mesh = std::get_if<Mesh>(&scene.shapes()[i]);
        const auto* sphere = std::get_if<Sphere>(&scene.shapes()[i]);
        const bool may_face_itself = (mesh && mesh->triangles.size() > 2) || (sphere && sphere->flip_normals) ||
                                     std::holds_alternative<Cylinder>(scene.shapes()[i]);
        mirrors += may_face_itself ? 2 : 1;
    }
    return mirrors > 1;
}

class ManifoldPath final : public Method {
public:
    explicit ManifoldPath(const Settings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, find_method("manifold_path"));
        add_eye_paths(plan, scene, settings_.max_edges);
        add_light_sampling(plan, settings_.max_edges);
        plan.add(step_chains, without_chains(scene, plan, settings_));
        const bool runs = plan.runs(step_chains);
        if (!runs) plan.same_as = "path";
        const auto& lights = scene.lights();
        const bool has_longer = settings_.max_edges - 2 > settings_.chain;
        if (runs && has_longer && std::any_of(lights.begin(), lights.end(), is_delta))
            plan.add(step_longer_chains,
                     fmt::format("light of points and directions through more than {} smooth surfaces is left out",
                                 settings_.chain));
        if (!runs || !makes_all_materials(scene) || (has_longer && has_facing_mirrors(scene))) {
            leave_out_of_camera_paths(plan, scene);
            return plan;
        }
        // Chains do not begin in media, and few paths end where a pencil of light does.
        for (const Component c : components_of_delta_paths(scene, plan.called_for))
            if (c == Component::volume) leave_out(plan, {c});
        leave_out(plan, components_of_pencils(
                            scene, plan.called_for,
                            {Component::direct, Component::caustic, Component::indirect, Component::volume}));
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        return std::make_unique<ManifoldPathRun>(
            scene, settings_, planned, shown_components(scene, planned.called_for, find_method("manifold_path")), seed,
            stages);
    }

private:
    Settings settings_;
};

}  // namespace

MethodDescription describe_manifold_path() {
    return {
        .name = "manifold_path",
        .sentence = "path tracing that finds lights through glass and mirrors by Newton's method: unbiased",
        .parameters = {integer_parameter("chain", "6", "vertices", 1, ChainSampler::longest_possible,
                                         "smooth vertices between a surface and a light, at most"),
                       point_set_parameter()},
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = true,
        .create = [](const ParameterValues& values, const MethodDefaults& defaults) -> std::unique_ptr<Method> {
            return std::make_unique<ManifoldPath>(Settings{
                point_set_of(values), static_cast<int>(values.integer("chain")), max_edges_of(values, defaults)});
        },
        .ray_cost = 2,
    };
}

}  // namespace gib
