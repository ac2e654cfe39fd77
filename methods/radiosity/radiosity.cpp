// Radiosity: diffuse light between patches as a system of linear equations, solved once for all views.
//
// Computes: `emission` and `direct` at the surfaces that the eye sees, by samples of the pixels; `indirect` from a
// solution of B_i = E_i + rho_i sum of F_ij B_j between patches: by default hierarchical (Hanrahan, Salzman and Aupperle
// 1991), else by the matrix of all pairs of patches (Goral et al. 1984). Where max_depth limits paths, the reflections
// that it allows are summed. Direct light on patches is sampled, so lights of every kind are allowed.
// Parameters: patch, solver, links, gather; spp and max_depth as for all methods.
// Leaves out: specular surfaces, whether the eye sees them or light meets them on its way, and media. Of other
// materials it computes the diffuse part, which counts as ideal diffuse for indirect light. A reflectance that
// varies over a surface enters the exchange of light as its mean over a patch; at the surfaces that the eye sees
// it is exact. A coloured thin sheet dims the exchange by the mean of its channels.
// Bias: light is constant over patches and groups of patches, and in the view linear between corners. Indirect light is
// too low by a share that shrinks with `links` and `patch` (0.1 % in cornell-box.xml). Within a patch of an edge where walls
// meet it is too high, by some percent at the edge itself (README.md).
// A pass: one sweep of the solver, until the residual is 1e-4 of the light of the first reflection (eight steps of
// conjugate gradients, or the direct solution; with max_depth, as many reflections again as in all passes before, but at
// least 8); then one sample of every pixel. A change of the solution starts the samples again. `facts` say how far the
// solver has come, and how closed the system is.
// Cost: links between groups of patches and clusters of surfaces let it grow with the number of patches; the matrix
// grows with its square.
// Fails: with InputError that names the number of bytes if there is not enough memory; with InputError if paths have
// no limit and light is shut in among surfaces that absorb none of it.
#include "methods/parts/stored_light/stored_light.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/transport/pixel_samples.h"
#include "methods/radiosity/view.h"

namespace gib {

namespace {

constexpr std::string_view pass_solution = "patches and links";
constexpr std::string_view pass_final_gather = "final gather";

const MethodDescription& description() { return find_method("radiosity"); }

/// Adds the components that have paths which this method leaves out.
void add_unresolved(Plan& plan, const Scene& scene) {
    leave_out(plan, components_of_pencils(scene, plan.called_for, {Component::direct, Component::indirect}));
    const bool mirrors = plan.missing.has(Effect::specular_reflection) || plan.missing.has(Effect::refraction);
    if (mirrors) leave_out(plan, {Component::emission, Component::direct});
    if (mirrors || plan.missing.has(Effect::glossy_lobes) || plan.missing.has(Effect::bump_maps))
        leave_out(plan, {Component::indirect});
}

class RadiosityRun final : public Run {
public:
    RadiosityRun(const Scene& scene, const RadiositySettings& settings, const Plan& plan, std::uint64_t seed,
                 StageTimes& stages)
        : scene_(scene),
          model_(plan.runs(pass_solution) ? std::make_unique<RadiosityModel>(scene, settings, seed, stages) : nullptr),
          traces_(plan.runs(step_eye_paths)),
          view_{settings.max_edges, plan.runs(step_light_sampling), settings.gather},
          seed_(seed),
          stages_(stages),
          components_(shown_components(scene, plan.called_for, description())) {
        start_film();
    }

    Progress advance(std::uint32_t pass) override {
        if (model_ && model_->advance()) start_film();  // images show the latest solution only
        if (!traces_) return Progress::converged;
        ++passes_;
        rays_ += sample_pixels(scene_, *film_, PointSet::sobol, seed_, pass, stages_, "view", [this] {
            return [this](RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
                return sample_radiosity(rays, eye, sampler, model_.get(), view_);
            };
        });
        return Progress::more;
    }

    ComponentImages image() const override { return film_->mean(passes_); }
    RunCounts counts() const override { return {0, rays_ + (model_ ? model_->rays() : 0), film_->non_finite()}; }
    std::vector<std::pair<std::string, std::string>> facts() const override {
        return model_ ? model_->facts() : std::vector<std::pair<std::string, std::string>>{};
    }

    StoredLight stored_light() const override {
        StoredLight stored{.changes_with_passes = model_ && !model_->has_converged()};
        if (model_) stored.patches = model_->stored_patches();
        return stored;
    }

private:
    void start_film() {
        film_.emplace(scene_.sensor().width(), scene_.sensor().height(), components_.accumulated, components_.black);
        passes_ = 0;
    }

    const Scene& scene_;
    std::unique_ptr<RadiosityModel> model_;
    bool traces_;
    RadiosityViewSettings view_;
    std::uint64_t seed_;
    StageTimes& stages_;
    ShownComponents components_;
    std::optional<Film> film_;
    std::uint32_t passes_ = 0;  ///< samples of each pixel on the film
    std::uint64_t rays_ = 0;
};

class Radiosity final : public Method {
public:
    explicit Radiosity(const RadiositySettings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, description());
        add_unresolved(plan, scene);
        add_eye_paths(plan, scene, settings_.max_edges);
        add_light_sampling(plan, settings_.max_edges);
        const bool exchanged = plan.called_for.has(Effect::diffuse_interreflection);
        plan.add(std::string(pass_solution), exchanged && settings_.max_edges >= 3,
                 exchanged ? "indirect light takes paths of three edges or more, which max_depth leaves out"
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
    if (s.solver == RadiositySolver::direct) values.refuse({"links"}, "solver=direct");
    s.gather = static_cast<int>(values.integer("gather"));
    s.max_edges = max_edges_of(values, defaults);
    if (values.text("filter") != "none")
        throw InputError(
            "a filter takes two halves of the passes: an image of radiosity is no mean over passes and has no halves");
    return std::make_unique<Radiosity>(s);
}

}  // namespace

MethodDescription describe_radiosity() {
    return {
        .name = "radiosity",
        .sentence = "hierarchical radiosity: diffuse light between patches, solved once for all views; biased, smooth",
        .parameters =
            {
                tuned(number_parameter("patch", "0.06", "scene diagonals", 1e-5, 1, "longest edge of a patch"),
                      {0.004, 0.2}),
                choice_parameter(
                    "solver", strings(radiosity_solver_names),
                    "hierarchical: links between groups of patches, solved by iteration; direct: the matrix of all "
                    "pairs of patches, factorised; with max_depth, reflections are summed instead"),
                number_parameter("links", "0.002", "mean irradiances", 1e-6, 10,
                                 "error of irradiance that a link between groups of patches may make"),
                integer_parameter(
                    "gather", "0", "rays", 0, 1e6,
                    "final gather rays per sample; 0: indirect light is interpolated between the corners of patches"),
            },
        .simulates = {Effect::direct_light, Effect::diffuse_interreflection, Effect::textures, Effect::smooth_normals,
                      Effect::depth_of_field, Effect::environment_light},
        .components = {Component::emission, Component::direct, Component::indirect},
        .unbiased = false,
        .create = create_radiosity,
        .stores_light = true,
    };
}

}  // namespace gib
