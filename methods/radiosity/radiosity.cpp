// Radiosity: diffuse light as an equation system between patches, solved once for every view.
//
// Computes: `emission` and `direct` of what the eye sees, by samples of the pixels; `indirect` from a solution of B =
// rho E between patches (Goral et al. 1984), hierarchical (Hanrahan et al. 1991) unless another solver is asked for.
// Where max_depth limits paths, the sum of so many reflections takes the place of every solver.
// The unknown is what patches reflect; direct light on them is sampled, so lights of every kind serve.
// Parameters: patch, solver, links, adapt, gather, memory, ply; spp and max_depth as for all methods.
// Leaves out: specular surfaces, seen or on the way of light, and media; of other materials it takes the diffuse
// part, as if it were ideal for indirect light. Reflectances that vary over a surface are taken as the mean of a
// patch in the exchange of light, and as they are where they are seen.
// Bias: light is constant over patches and groups of them in the exchange, and linear between their corners where it
// is seen. Where surfaces stand on patches or shadows cross them, the mean is sent out where only a part can be seen:
// indirect light is too low by a share that shrinks with the size of patches.
// A pass: one sweep of the solver, until what is missing is 1e-4 of the light that is reflected first, or as many
// reflections again as all passes before; a change of the solution starts the samples of indirect light again. Then one
// sample of every pixel. `facts` say how far the solver came, and how closed the system is. Cost: with S sides of
// charts S^2 / 2 pairs are looked at first, so meshes of many triangles take long; from there on it grows with the
// number of patches. Fails: with InputError and the number of bytes if the system would take more memory than the
// parameter allows, and where paths have no limit and light is shut in among surfaces that absorb none of it.
#include "methods/radiosity/view.h"

#include <algorithm>

namespace gib {

namespace {

constexpr std::string_view pass_solution = "patches and links";
constexpr std::string_view pass_final_gather = "final gather";

const MethodDescription& description() { return find_method("radiosity"); }

/// Components with paths that are left out here.
void add_unresolved(Plan& plan) {
    const auto add = [&](Component c) {
        if (std::find(plan.unresolved.begin(), plan.unresolved.end(), c) == plan.unresolved.end())
            plan.unresolved.push_back(c);
    };
    const bool mirrors = plan.missing.has(Effect::specular_reflection) || plan.missing.has(Effect::refraction);
    if (mirrors)
        for (const Component c : {Component::emission, Component::direct})
            add(c);
    if (mirrors || plan.missing.has(Effect::glossy_lobes) || plan.missing.has(Effect::bump_maps))
        add(Component::indirect);
}

class RadiosityRun final : public Run {
public:
    RadiosityRun(const Scene& scene, const RadiositySettings& settings, const Plan& plan, std::uint64_t seed,
                 StageTimes& stages)
        : model_(plan.runs(pass_solution) ? std::make_unique<RadiosityModel>(scene, settings, seed, stages) : nullptr),
          traces_(plan.runs(pass_eye_paths)),
          view_(scene, plan.called_for, model_.get(),
                {settings.max_edges, plan.runs(pass_light_sampling), settings.gather}, seed, stages) {}

    Progress advance(std::uint32_t pass) override {
        const bool changed = model_ && model_->advance();
        if (!traces_) return Progress::converged;
        view_.sample(pass, changed);
        return Progress::more;
    }

    ComponentImages image() const override { return view_.image(); }
    RunCounts counts() const override { return {0, view_.rays() + (model_ ? model_->rays() : 0), view_.non_finite()}; }
    std::vector<std::pair<std::string, std::string>> facts() const override {
        return model_ ? model_->facts() : std::vector<std::pair<std::string, std::string>>{};
    }

private:
    std::unique_ptr<RadiosityModel> model_;
    bool traces_;
    RadiosityView view_;
};

class Radiosity final : public Method {
public:
    explicit Radiosity(const RadiositySettings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, description());
        add_unresolved(plan);
        add_eye_paths(plan, scene, settings_.max_edges);
        add_light_sampling(plan, settings_.max_edges);
        const bool exchanged = plan.called_for.has(Effect::diffuse_interreflection);
        plan.add(std::string(pass_solution), exchanged && settings_.max_edges >= 3,
                 exchanged ? "its light has three edges or more, more than the longest path"
                           : "no light is passed between diffuse surfaces");
        plan.add(std::string(pass_final_gather), plan.runs(pass_solution) && settings_.gather > 0,
                 settings_.gather > 0 ? "there is no solution to gather from"
                                      : "gather=0: indirect light is interpolated between the corners of patches");
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        return std::make_unique<RadiosityRun>(scene, settings_, plan(scene), seed, stages);
    }

private:
    RadiositySettings settings_;
};

std::unique_ptr<Method> create_radiosity(const ParameterValues& values, const MethodDefaults& defaults) {
    RadiositySettings s{};
    s.patch = values.number("patch");
    s.solver = chosen<RadiositySolver>(radiosity_solver_names, values.choice("solver"));
    s.links = values.number("links");
    if (values.given("links") && s.solver != RadiositySolver::hierarchical)
        throw InputError("links says how far solver=hierarchical refines; the other solvers link every two patches");
    s.adapt = values.choice("adapt") == "on";
    s.gather = static_cast<int>(values.integer("gather"));
    s.memory = values.number("memory") * 0x1p30;
    s.ply = values.text("ply");
    s.max_edges = max_edges_of(values, defaults);
    return std::make_unique<Radiosity>(s);
}

}  // namespace

MethodDescription describe_radiosity() {
    return {
        "radiosity",
        "hierarchical radiosity: diffuse light between patches, solved once for all views; biased, smooth",
        {
            {"patch", Parameter::Kind::number, "0.04", "scene diagonals", 1e-5, 1, {}, "longest edge of a patch"},
            choice_parameter(
                "solver", strings(radiosity_solver_names),
                "hierarchical: links between groups of patches, by conjugate gradients; the others solve the "
                "full system, direct by Cholesky's factors; where max_depth limits paths, reflections are summed"),
            {"links",
             Parameter::Kind::number,
             "0.02",
             "mean irradiances",
             1e-6,
             10,
             {},
             "error that a link between groups may make where it arrives"},
            choice_parameter("adapt", {"on", "off"},
                             "halve patches further where surfaces stand on them, and for images where indirect light "
                             "changes over them"),
            {"gather",
             Parameter::Kind::integer,
             "0",
             "rays",
             0,
             1e6,
             {},
             "final gather rays a sample; 0: indirect light is interpolated between the corners of patches"},
            {"memory", Parameter::Kind::number, "4", "GiB", 1e-3, 1e6, {}, "refuse systems that take more"},
            {"ply",
             Parameter::Kind::text,
             "",
             "",
             0,
             0,
             {},
             "file for the patches with the radiosity of each corner (PLY), written after each sweep; default: none"},
        },
        {Effect::direct_light, Effect::diffuse_interreflection, Effect::textures, Effect::smooth_normals,
         Effect::depth_of_field, Effect::environment_light},
        {Component::emission, Component::direct, Component::indirect},
        false,
        create_radiosity,
    };
}

}  // namespace gib
