// Progressive photon mapping: every pass has photon maps of its own and looks them up within a smaller radius than the
// pass before, so that the mean over the passes converges to the truth. Sources: Hachisuka and Jensen 2009, "Stochastic
// Progressive Photon Mapping"; Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach".
//
// Computes: every component, as photon_mapper does: direct light is sampled, specular paths are traced, caustics, indirect
// light and light in media come from the density of photons. All photons within the radius of the pass count, and the
// radius shrinks by the law of parts/density/radius.h.
// Parameters: photons, caustic_photons, volume_photons [emitted in a pass], alpha, radius, caustic_radius,
// volume_radius [of the first pass, fractions of the scene's diagonal, or auto, which is smaller on small bodies],
// volume, kernel, area, projection, guide; spp and max_depth as for all methods.
// Bias: falls with the passes towards 0. The image carries an estimate of it, from the same photons within a
// smaller radius (parts/density/density_estimate.h).
// A pass: photon maps, and one sample of every pixel. Memory holds the maps of one pass only.
// Fails: never; a map without photons near a point gives 0 there. Direct light of a pencil, as of a laser, is hardly ever
// found, and the plan says so (parts/transport/delta_paths.h).
#include "methods/parts/density/biased_film.h"
#include "methods/parts/density/radius.h"
#include "methods/parts/photon_mapping/eye_pass.h"
#include "methods/parts/photon_mapping/photon_maps.h"
#include "methods/parts/stored_light/stored_light.h"
#include "methods/parts/transport/light_policy.h"
#include "methods/parts/transport/pixel_samples.h"

#include <algorithm>

namespace gib {

namespace {

constexpr std::uint64_t pilot_key = 0x71;  ///< keeps the photons of the pilot apart from those of the passes
/// Limit on photons in the mean look-up of the first pass, if its radius is found. Guided photons differ in power, so
/// more are needed.
constexpr double most_photons = 50, most_guided_photons = 200;

struct ProgressiveSettings {
    PhotonMapSettings maps;  ///< radii of 0 are found from the first pass's photons; so are numbers of photons of 0
    double alpha;
    std::uint64_t first_pass;
    Guiding guiding;
};

class ProgressivePhotonMapperRun final : public Run {
public:
    ProgressivePhotonMapperRun(const Scene& scene, const ProgressiveSettings& settings, const Plan& plan,
                               const ShownComponents& shown, std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          settings_(settings),
          plan_(plan),
          seed_(seed),
          stages_(stages),
          film_(scene.sensor().width(), scene.sensor().height(), shown.accumulated, shown.black, blurred(shown)),
          walk_{settings.maps.max_edges, plan.runs(step_light_sampling), plan.runs(step_specular)},
          shrinking_(settings.alpha),
          aims_(build_aims(plan, scene, settings.maps, stages)),
          tracing_(scene, settings.maps.max_edges, stages) {}

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!plan_.runs(step_eye_paths)) return Progress::converged;
        if (pass == 0) {
            tracing_.follow(LightPolicy::find(scene_, settings_.guiding, {settings_.maps.max_edges, false}, plan_,
                                              seed_, stages_, rays_));
            find_first_radii();
            flat_regions_.emplace(scene_, FlatRegions::resolution_for(settings_.maps.photons));
        }
        trace_maps(combine_keys(seed_, pass), settings_.first_pass + pass);
        set_radii(settings_.first_pass + pass);
        rays_ += sample_pixels(scene_, film_, PointSet::sobol, seed_, pass, stages_, "gather", [this] {
            return [block = EyePass(maps_, walk_)](RayQueries& rays, const TracedRay& eye,
                                                   const Sampler& sampler) mutable -> const BiasedSample& {
                return block.sample(rays, eye, sampler);
            };
        });
        return Progress::more;
    }

    ComponentImages image() const override { return film_.mean(passes_); }
    RunCounts counts() const override { return {tracing_.photons(), rays_ + tracing_.rays(), film_.non_finite()}; }
    /// The radii of the first pass [scene diagonals].
    std::vector<std::pair<std::string, std::string>> facts() const override {
        return {radius_fact("radius", first_.global, scene_), radius_fact("caustic_radius", first_.caustic, scene_),
                radius_fact("volume_radius", first_.volume, scene_), guide_fact(tracing_.has_policy())};
    }

    StoredLight stored_light() const override {
        StoredLight stored{.changes_with_passes = plan_.runs(step_eye_paths), .is_of_one_pass = true};
        store(stored, "global", maps_.global, settings_.maps.photons);
        store(stored, "caustic", maps_.caustic, settings_.maps.caustic_photons);
        store(stored, "volume", maps_.volume, settings_.maps.volume_photons);
        if (maps_.along_rays) store(stored, maps_.along_rays->walk());
        return stored;
    }

private:
    static std::vector<Component> blurred(const ShownComponents& shown) {
        std::vector<Component> components;
        for (Component c : shown.accumulated)
            if (c != Component::emission && c != Component::direct) components.push_back(c);
        return components;
    }

    /// The maps of the pass that `passes` others precede.
    void trace_maps(std::uint64_t seed, std::uint64_t passes) {
        const PhotonMapSettings& s = settings_.maps;
        maps_.caustic = maps_.global = maps_.volume = PhotonMap();  // gives their memory back
        if (plan_.runs(step_caustic))
            maps_.caustic = tracing_.traced_map(PhotonMapKind::caustic, s.caustic_photons, aims_.caustic.get(), seed);
        if (plan_.runs(step_global))
            maps_.global = tracing_.traced_map(PhotonMapKind::global, s.photons, aims_.global.get(), seed);
        if (!plan_.runs(step_volume)) return;
        if (s.volume_look_up == VolumeLookUp::points) {
            maps_.volume = tracing_.traced_map(PhotonMapKind::volume, s.volume_photons, aims_.global.get(), seed);
            return;
        }
        const BlurRadii radii{.disc = static_cast<float>(first_.volume * shrinking_.on_surfaces(passes)),
                              .ribbon = static_cast<float>(first_.volume * shrinking_.along_beams(passes))};
        maps_.along_rays.reset();
        maps_.along_rays = tracing_.light_along_rays(s, radii, true, aims_.global.get(), seed);
    }

    /// The first radius for a kind of map [scene units], unless it is given [scene diagonals].
    double first_radius_for(PhotonMapKind kind, double given, std::uint64_t count, const AimedEmission* aim,
                            const std::vector<Vec3>& places) {
        if (given > 0) return given * double{scene_.diagonal()};
        const std::uint64_t passes = pilot_passes(static_cast<double>(count));
        std::vector<Photon> pilot;
        for (std::uint64_t pass = 0; pass < passes; ++pass) {
            const std::uint64_t key = combine_keys(combine_keys(seed_, pilot_key), pass);
            const PhotonWalkResult walk = tracing_.trace(kind, count, aim, key);
            pilot.insert(pilot.end(), walk.photons.begin(), walk.photons.end());
        }
        return first_radius(pilot, static_cast<double>(passes), places,
                            tracing_.has_policy() ? most_guided_photons : most_photons,
                            kind == PhotonMapKind::volume ? 3 : 2, scene_.diagonal());
    }

    void find_first_radii() {
        const PhotonMapSettings& s = settings_.maps;
        const bool along_rays = s.volume_look_up != VolumeLookUp::points;
        const bool all_given = s.radius > 0 && s.caustic_radius > 0 && (s.volume_radius > 0 || along_rays);
        const SeenPlaces seen = all_given ? SeenPlaces() : seen_places(scene_, walk_, seed_, rays_);
        const auto radius = [&](std::string_view step, PhotonMapKind kind, double given, std::uint64_t count,
                                const AimedEmission* aim) {
            if (!plan_.runs(step)) return 0.0;
            if (kind == PhotonMapKind::volume && along_rays)
                return tracing_.radius_along_rays(s, walk_, true, aim, combine_keys(seed_, pilot_key));
            return first_radius_for(kind, given, count, aim,
                                    kind == PhotonMapKind::volume ? seen.in_media : seen.on_surfaces);
        };
        first_ = {
            radius(step_caustic, PhotonMapKind::caustic, s.caustic_radius, s.caustic_photons, aims_.caustic.get()),
            radius(step_global, PhotonMapKind::global, s.radius, s.photons, aims_.global.get()),
            radius(step_volume, PhotonMapKind::volume, s.volume_radius, s.volume_photons, aims_.global.get())};
    }

    /// Sets the estimators of the present pass.
    void set_radii(std::uint64_t passes_before) {
        const PhotonMapSettings& s = settings_.maps;
        const auto on_surfaces = [&](double given, double first) {
            return DensityEstimator{.kernel = s.kernel,
                                    .k = all_photons,
                                    .max_radius = static_cast<float>(first * shrinking_.on_surfaces(passes_before)),
                                    .area = s.area,
                                    .estimates_bias = true,
                                    .largest_by_place = given > 0 ? 0.f : static_cast<float>(first),
                                    .flat = &*flat_regions_};
        };
        maps_.caustic_estimator = on_surfaces(s.caustic_radius, first_.caustic);
        maps_.global_estimator = on_surfaces(s.radius, first_.global);
        maps_.volume_estimator = {.kernel = s.kernel,
                                  .k = all_photons,
                                  .max_radius = static_cast<float>(first_.volume * shrinking_.in_media(passes_before)),
                                  .area = s.area,
                                  .estimates_bias = true};
    }

    const Scene& scene_;
    ProgressiveSettings settings_;
    Plan plan_;
    std::uint64_t seed_;
    StageTimes& stages_;
    BiasedFilm film_;
    WalkSettings walk_;
    ShrinkingRadius shrinking_;
    Aims aims_;
    PhotonTracing tracing_;
    std::optional<FlatRegions> flat_regions_;
    PhotonMaps maps_;
    struct {
        double caustic, global, volume;
    } first_{};               ///< radii of the first pass [scene units]
    std::uint64_t rays_ = 0;  ///< beside those of the maps
    std::uint32_t passes_ = 0;
};

class ProgressivePhotonMapper final : public Method {
public:
    explicit ProgressivePhotonMapper(const ProgressiveSettings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override {
        const PhotonMapSettings maps = settings_for(scene).maps;
        Plan plan = described_plan(scene, find_method("progressive_photon_mapper"));
        leave_out_pencils(plan, scene, maps);
        add_eye_paths(plan, scene, maps.max_edges);
        add_light_sampling(plan, maps.max_edges);
        add_specular_paths(plan);
        add_caustic_map(plan, maps);
        add_global_map(plan, maps);
        add_volume_map(plan, scene, maps);
        add_aims(plan, scene, maps);
        const bool has_maps = plan.runs(step_caustic) || plan.runs(step_global) || plan.runs(step_volume);
        add_importons(plan, settings_.guiding, has_maps ? "" : "no map is run");
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        return std::make_unique<ProgressivePhotonMapperRun>(
            scene, settings_for(scene), planned,
            shown_components(scene, planned.called_for, find_method("progressive_photon_mapper")), seed, stages);
    }

private:
    /// The numbers of photons that were not given follow the image's size. Of four scenes (lamp-in-glass, metal-ring,
    /// glass-sphere, cornell-glass, 256 x 256, 12 to 17 s) three need 1.3 to 1.5 times as long for an error with four
    /// photons a pixel, the last as long.
    ProgressiveSettings settings_for(const Scene& scene) const {
        ProgressiveSettings s = settings_;
        const auto pixels =
            static_cast<std::uint64_t>(scene.sensor().width()) * static_cast<std::uint64_t>(scene.sensor().height());
        constexpr std::uint64_t fewest = 10000, most = 250000;
        const std::uint64_t photons = std::clamp(pixels, fewest, most);
        for (std::uint64_t* count : {&s.maps.photons, &s.maps.caustic_photons})
            if (*count == 0) *count = photons;
        if (s.maps.volume_photons == 0) s.maps.volume_photons = default_volume_photons(photons, s.maps.volume_look_up);
        return s;
    }

    ProgressiveSettings settings_;
};

std::unique_ptr<Method> create_progressive_photon_mapper(const ParameterValues& values,
                                                         const MethodDefaults& defaults) {
    const auto count = [&](const char* name) {
        return static_cast<std::uint64_t>(values.given(name) ? values.integer(name) : 0);
    };
    ProgressiveSettings s{};
    s.maps.photons = count("photons");
    s.maps.caustic_photons = values.given("caustic_photons") ? count("caustic_photons") : s.maps.photons;
    s.maps.volume_look_up = chosen<VolumeLookUp>(volume_look_up_names, values.choice("volume"));
    s.maps.volume_photons = values.given("volume_photons")
                                ? count("volume_photons")
                                : default_volume_photons(s.maps.photons, s.maps.volume_look_up);
    s.maps.k = s.maps.caustic_k = s.maps.volume_k = all_photons;
    s.maps.radius = first_radius_of(values, "radius");
    s.maps.caustic_radius = first_radius_of(values, "caustic_radius");
    s.maps.volume_radius = first_radius_of(values, "volume_radius");
    s.maps.kernel = chosen<Kernel>(kernel_names, values.choice("kernel"));
    s.maps.area = chosen<DiscArea>(disc_area_names, values.choice("area"));
    s.maps.max_edges = max_edges_of(values, defaults);
    s.maps.projection = values.choice("projection") == "on";
    s.guiding = guiding_of(values);
    s.alpha = values.number("alpha");
    s.first_pass = defaults.first_pass;
    return std::make_unique<ProgressivePhotonMapper>(s);
}

std::vector<Parameter> progressive_parameters() {
    const auto photons = [](std::string name, std::string meaning) {
        return integer_parameter(std::move(name), "", "photons", 1, 4e9, std::move(meaning));
    };
    return {
        tuned(
            photons("photons", "emitted for the global map of a pass; default: one for each pixel, from 1e4 to 2.5e5"),
            {1e4, 1e6}),
        photons("caustic_photons", "emitted for the caustic map of a pass; default: the value of photons"),
        photons("volume_photons",
                "emitted for the volume map of a pass; default: the value of photons, with volume=beams a tenth of it"),
        alpha_parameter(),
        first_radius_parameter("radius", "in the global map", "50 photons"),
        first_radius_parameter("caustic_radius", "in the caustic map", "50 photons"),
        first_radius_parameter("volume_radius", "in the volume map", "50 photons"),
        volume_parameter(),
        choice_parameter("kernel", strings(kernel_names), "weight of a photon as a function of its distance"),
        disc_area_parameter(),
        projection_parameter(),
        guide_parameter(),
    };
}

}  // namespace

MethodDescription describe_progressive_photon_mapper() {
    return {
        .name = "progressive_photon_mapper",
        .sentence = "photon maps of ever smaller radius: consistent, good at caustics seen through glass",
        .parameters = progressive_parameters(),
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = false,
        .create = create_progressive_photon_mapper,
        .stores_light = true,
    };
}

}  // namespace gib
