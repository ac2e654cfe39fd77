// Photon mapping: caustics and indirect light from the density of photons; direct light is sampled
// and specular paths are traced.
// Source: Jensen 1996, "Global Illumination using Photon Maps"; Jensen 2001, chapters 5 to 11.
//
// Computes: every component. At the first diffuse surface seen from the eye:
//  - direct: light sampling;
//  - caustic: the caustic map, L S+ D;
//  - indirect: the global map, L (S* D)+ S* D; or final gathering (gather > 0), with
//    cache=on through an irradiance cache;
//  - volume: those photons of the maps that a medium has scattered on the way.
// Where a free flight through a medium ends, light straight from its source comes from light sampling and all other
// light from the volume map. With volume=ray or beams no flight is sampled: all light that a medium scatters into the eye's
// ray comes from the photons or the photon beams around it (methods/parts/density/light_along_rays.h), and what lies behind
// the medium is weighted by its transmittance. Light found at the end of a specular path counts only before that surface or event
// (emission), so that every path is counted once.
// Parameters: photons, caustic_photons, volume_photons [emitted], k, radius, caustic_radius and volume_radius
// [fractions of the scene's diagonal], volume, kernel, area, projection, direct_samples; gather [rays], source, cache,
// accuracy; shadow_photons (methods/parts/shadow_photons/light_visibility.h); spp and max_depth as for all methods. The declarations at the end of
// this file state the defaults.
// Bias: the estimates blur light over the look-up radius. This bias falls with more photons at fixed k, and together
// with the noise at k=auto. More samples a pixel lower neither the bias nor the noise of the maps. Gathered light is
// blurred where gather rays end, to the nearest place with precomputed irradiance, and between the cache's records:
// near small objects a record may be used up to 1.5 pixels away although it has missed an object that a neighbouring
// record sees. Where the length of paths is limited, stored light is rescaled for longer ways from the eye
// (PhotonLengths). In scenes with media or dispersion nothing is gathered.
// A pass: one sample of every pixel; with direct_samples > 1, emission and direct light are the mean over so many eye paths
// of their own. The maps and the cache are filled at the start. Photons are aimed: a light emits
// only where its rays can reach geometry (global map) or specular geometry (caustic map), see projection_map.h. The
// number of photons is the same as without aiming; together they carry the power of the emission that is kept.
// Fails: never; a map without photons near a point gives 0 there. Direct light of a pencil, as of a laser, is hardly ever
// found, and the plan says so (parts/transport/delta_paths.h).
#include "methods/photon_mapper/photon_mapper.h"

#include "methods/parts/photon_mapping/eye_pass.h"
#include "methods/parts/shadow_photons/light_visibility.h"
#include "methods/parts/stored_light/stored_light.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/transport/pixel_samples.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace gib {

namespace {

constexpr std::string_view step_gather = "final gathering";
constexpr std::string_view step_irradiance = "precomputed irradiance";
constexpr std::string_view step_cache = "irradiance cache";

/// Adds the steps of final gathering, precomputed irradiance and the irradiance cache.
void add_gathering(Plan& plan, const Scene& scene, const PhotonMapperSettings& settings) {
    std::string reason;
    if (!plan.called_for.has(Effect::diffuse_interreflection)) reason = "no light passes between diffuse surfaces";
    else if (settings.gather == 0) reason = "gather=0: indirect light comes from the global map";
    else if (scene.has_media()) reason = "a medium lies between surfaces: indirect light comes from the global map";
    else if (scene.has_dispersion()) reason = "light is split by wavelength: indirect light comes from the global map";
    else if (settings.source != GatherSource::paths && settings.photons == 0) reason = "no photons are asked for";
    else if (settings.max_edges < 3) reason = "its paths have at least three edges, more than max_depth allows";
    plan.add(step_gather, reason);
    const bool gathers = plan.runs(step_gather);
    if (gathers) leave_out(plan, components_of_pencils(scene, plan.called_for, {Component::indirect}));
    const std::string no_rays = "nothing is gathered";
    plan.add(step_irradiance,
             !gathers ? no_rays
             : settings.source != GatherSource::irradiance
                 ? fmt::format("source={}", gather_source_names[static_cast<std::size_t>(settings.source)])
                 : "");
    plan.add(step_cache, !gathers ? no_rays : !settings.cache ? "cache=off" : "");
}

Plan plan_for(const Scene& scene, const Effects& effects, const PhotonMapperSettings& settings) {
    Plan plan = described_plan(scene, find_method("photon_mapper"));
    plan.called_for = effects;
    leave_out_pencils(plan, scene, settings);
    add_eye_paths(plan, scene, settings.max_edges);
    add_light_sampling(plan, settings.max_edges);
    add_specular_paths(plan);
    add_caustic_map(plan, settings);
    add_gathering(plan, scene, settings);
    const bool follows_paths = plan.runs(step_gather) && settings.source == GatherSource::paths;
    add_global_map(plan, settings, follows_paths ? "gather rays are followed by path tracing" : "");
    add_volume_map(plan, scene, settings);
    add_aims(plan, scene, settings);
    add_shadow_map(plan, scene, settings.shadow_photons);
    return plan;
}

/// Indirect light by final gathering, from the irradiance cache where it has records and else by rays; direct light by shadow
/// photons. What is not made is empty.
struct GatheredLightAndShadows final : DiffuseLight {
    std::optional<FinalGather> gather;
    std::optional<CachedGather> cache;
    std::optional<LightVisibility> visibility;

    std::optional<Color> indirect(const EyeVertex& vertex, const SurfaceHit& hit, std::size_t pixel) override {
        if (!gather) return std::nullopt;
        const auto cached = cache ? cache->reflected_radiance(vertex, hit, pixel) : std::nullopt;
        return cached ? cached : gather->reflected_radiance(vertex, hit);
    }
    std::optional<Color> direct(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo,
                                const VertexNumbers& u) override {
        const LobeTraits& lobes = hit.bsdf->traits_at(hit.shading.to_local(wo).z());
        if (!visibility || lobes.rough || hit.bsdf->traits().transmission) return std::nullopt;
        return visibility->sample_direct_light(rays, hit, wo, u);
    }
};

class PhotonMapperRun final : public Run {
public:
    PhotonMapperRun(const Scene& scene, const PhotonMapperSettings& settings, const Plan& plan,
                    const ShownComponents& shown, std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          settings_(settings),
          seed_(seed),
          stages_(stages),
          film_(scene.sensor().width(), scene.sensor().height(), shown.accumulated, shown.black),
          traces_(plan.runs(step_eye_paths)),
          walk_{settings.max_edges, plan.runs(step_light_sampling), plan.runs(step_specular)},
          tracing_(scene, settings.max_edges, stages) {
        const Aims aims = build_aims(plan, scene, settings, stages);
        if (plan.runs(step_caustic))
            maps_.caustic =
                tracing_.traced_map(PhotonMapKind::caustic, settings.caustic_photons, aims.caustic.get(), seed);
        if (settings.area == DiscArea::surface && (plan.runs(step_caustic) || plan.runs(step_global)))
            flat_regions_.emplace(scene,
                                  FlatRegions::resolution_for(std::max(settings.photons, settings.caustic_photons)));
        const auto estimator = [&](std::size_t k, double radius) {
            return DensityEstimator{.kernel = settings.kernel,
                                    .k = k,
                                    .max_radius = length(radius),
                                    .area = settings.area,
                                    .flat = flat_regions_ ? &*flat_regions_ : nullptr};
        };
        maps_.global_estimator = estimator(settings.k, settings.radius);
        maps_.caustic_estimator = estimator(settings.caustic_k, settings.caustic_radius);
        maps_.volume_estimator = {.kernel = settings.kernel,
                                  .k = settings.volume_k,
                                  .max_radius = length(settings.volume_radius),
                                  .area = settings.area};
        if (plan.runs(step_gather)) prepare_gathering(plan, aims.global.get());
        else if (plan.runs(step_global))
            maps_.global = tracing_.traced_map(PhotonMapKind::global, settings.photons, aims.global.get(), seed);
        // A ray that reaches no surface reaches no bounded medium either, so the bins of the global map serve the
        // volume map too.
        if (plan.runs(step_volume)) fill_volume_map(aims.global.get());
        if (plan.runs(step_shadow_map)) fill_shadow_map();
        if (other_.gather || other_.visibility) maps_.at_diffuse = &other_;
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!traces_) return Progress::converged;
        rays_ += sample_pixels(scene_, film_, PointSet::sobol, seed_, pass, stages_, "gather", [this] {
            return [this, block = EyePass(maps_, walk_)](RayQueries& rays, const TracedRay& eye, const Sampler& sampler,
                                                         std::size_t pixel) mutable -> const PixelSample& {
                return block.sample_split(rays, eye, sampler, pixel, settings_.direct_samples);
            };
        });
        if (other_.cache) other_.cache->end_pass();
        return Progress::more;
    }

    ComponentImages image() const override { return film_.mean(passes_); }
    RunCounts counts() const override {
        return {photons_ + tracing_.photons(), rays_ + tracing_.rays(), film_.non_finite()};
    }

    /// The maps and the cache are filled at the start; the few records that passes add are not waited for.
    StoredLight stored_light() const override {
        StoredLight stored;
        store(stored, "global", other_.gather ? light_.map : maps_.global, settings_.photons);
        store(stored, "caustic", maps_.caustic, settings_.caustic_photons);
        store(stored, "volume", maps_.volume, settings_.volume_photons);
        if (maps_.along_rays) store(stored, maps_.along_rays->walk());
        if (other_.cache)
            for (const IrradianceRecord& record : other_.cache->cache().records())
                stored.records.push_back({record.p, record.n, settings_.accuracy * record.distance, record.irradiance});
        return stored;
    }

private:
    float length(double fraction) const {
        return static_cast<float>(fraction * static_cast<double>(scene_.diagonal()));
    }

    void fill_volume_map(const AimedEmission* aim) {
        if (settings_.volume_look_up == VolumeLookUp::points) {
            maps_.volume = tracing_.traced_map(PhotonMapKind::volume, settings_.volume_photons, aim, seed_);
            return;
        }
        const auto radius = static_cast<float>(tracing_.radius_along_rays(settings_, walk_, false, aim, seed_));
        maps_.along_rays = tracing_.light_along_rays(settings_, {radius, radius}, false, aim, seed_);
    }

    void fill_shadow_map() {
        constexpr std::string_view tracing = "shadow photon tracing";
        ShadowPhotonResult shadow;
        {
            const auto timer = stages_.time(tracing);
            StageProgress progress(stages_, tracing, settings_.shadow_photons);
            shadow = trace_shadow_photons(scene_, settings_.shadow_photons, seed_, &progress);
        }
        rays_ += shadow.rays;
        photons_ += shadow.emitted;
        const auto timer = stages_.time(step_shadow_map);
        other_.visibility.emplace(scene_, shadow.photons);
    }

    /// Makes what gather rays need: photons, precomputed irradiance (Christensen 1999) and the irradiance cache.
    /// `overture` is Radiance's name for filling a cache ahead of rendering.
    void prepare_gathering(const Plan& plan, const AimedEmission* aim) {
        light_ = {.source = settings_.source,
                  .max_edges = settings_.max_edges,
                  .samples_lights = walk_.samples_lights,
                  .follows_specular = walk_.follows_specular,
                  .estimator = maps_.global_estimator};
        if (plan.runs(step_global)) {
            PhotonWalkResult walk = tracing_.trace(PhotonMapKind::full, settings_.photons, aim, seed_);
            light_.lengths = PhotonLengths(walk.photons);
            std::vector<Photon> places;
            if (plan.runs(step_irradiance))
                places = take_places(walk.photons, photons_per_place(settings_.k, walk.photons.size()));
            light_.map = tracing_.map_of(walk);
            walk.photons = {};
            if (plan.runs(step_irradiance)) {
                const auto timer = stages_.time(step_irradiance);
                StageProgress progress(stages_, step_irradiance, places.size());
                light_.irradiance =
                    PrecomputedIrradiance(scene_, places, light_.map, light_.estimator, light_.longest_photon_path(),
                                          combine_keys(seed_, places_key), rays_, &progress);
            }
        }
        other_.gather.emplace(light_, settings_.gather);
        if (!plan.runs(step_cache) || !traces_) return;
        other_.cache.emplace(scene_, *other_.gather, settings_.accuracy);
        const auto timer = stages_.time(step_cache);
        StageProgress progress(stages_, step_cache,
                               static_cast<std::uint64_t>(scene_.sensor().width() * scene_.sensor().height()));
        rays_ += other_.cache->overture(walk_, seed_, &progress);
    }

    /// Keeps the random numbers of discs around places of precomputed irradiance apart from those of photons.
    static constexpr std::uint64_t places_key = 0x504c;

    const Scene& scene_;
    PhotonMapperSettings settings_;
    std::uint64_t seed_;
    StageTimes& stages_;
    Film film_;
    bool traces_;
    WalkSettings walk_;
    PhotonTracing tracing_;
    std::optional<FlatRegions> flat_regions_;
    PhotonMaps maps_;
    GatheredLight light_;
    GatheredLightAndShadows other_;
    std::uint64_t photons_ = 0, rays_ = 0;  ///< beside those of the maps
    std::uint32_t passes_ = 0;
};

class PhotonMapper final : public Method {
public:
    explicit PhotonMapper(const PhotonMapperSettings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override { return plan_for(scene, effects_of(scene), settings_); }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        return start_photon_mapper(scene, settings_, effects_of(scene), seed, stages);
    }

private:
    PhotonMapperSettings settings_;
};

/// Refuses parameters that other parameters leave without effect. Parameters that max_depth or the scene leaves without
/// effect are no mistakes; the plan says why a pass is skipped.
void refuse_without_effect(const ParameterValues& values, const PhotonMapperSettings& s) {
    if (s.photons == 0) values.refuse({"radius"}, "photons=0");
    if (s.caustic_photons == 0) values.refuse({"caustic_radius"}, "caustic_photons=0");
    if (s.volume_photons == 0) values.refuse({"volume", "volume_radius"}, "volume_photons=0");
    if (s.photons == 0 && s.caustic_photons == 0) {
        values.refuse({"area", "projection"}, "no photons on surfaces");
        if (s.volume_photons == 0) values.refuse({"k", "kernel"}, "no photons");
    }
    if (s.gather == 0) values.refuse({"source", "cache"}, "gather=0");
    if (s.photons == 0 && s.source != GatherSource::paths) values.refuse({"gather"}, "photons=0, unless source=paths");
    if (!s.cache) values.refuse({"accuracy"}, "cache=off");
}

std::unique_ptr<Method> create_photon_mapper(const ParameterValues& values, const MethodDefaults& defaults) {
    const auto count = [&](const char* name) { return static_cast<std::uint64_t>(values.integer(name)); };
    PhotonMapperSettings s{};
    s.photons = count("photons");
    s.caustic_photons = values.given("caustic_photons") ? count("caustic_photons") : s.photons;
    s.volume_look_up = chosen<VolumeLookUp>(volume_look_up_names, values.choice("volume"));
    const bool along_rays = s.volume_look_up != VolumeLookUp::points;
    s.volume_photons =
        values.given("volume_photons") ? count("volume_photons") : default_volume_photons(s.photons, s.volume_look_up);
    const auto k = values.number_unless_word("k");
    const bool all = values.choice("k") == "all";
    s.k = k ? static_cast<std::size_t>(*k) : all ? all_photons : automatic_k(s.photons);
    s.caustic_k = k || all ? s.k : automatic_k(s.caustic_photons);
    s.volume_k = k || all ? s.k : automatic_k(s.volume_photons);
    s.radius = values.number("radius");
    s.caustic_radius = values.number("caustic_radius");
    s.volume_radius = along_rays && !values.given("volume_radius") ? 0 : values.number("volume_radius");
    s.kernel = chosen<Kernel>(kernel_names, values.choice("kernel"));
    s.area = chosen<DiscArea>(disc_area_names, values.choice("area"));
    s.max_edges = max_edges_of(values, defaults);
    s.projection = values.choice("projection") == "on";
    s.direct_samples = static_cast<int>(values.integer("direct_samples"));
    s.gather = static_cast<int>(values.integer("gather"));
    s.source = chosen<GatherSource>(gather_source_names, values.choice("source"));
    s.cache = values.choice("cache") == "on";
    s.accuracy = static_cast<float>(values.number("accuracy"));
    s.shadow_photons = count("shadow_photons");
    refuse_without_effect(values, s);
    return std::make_unique<PhotonMapper>(s);
}

}  // namespace

std::size_t automatic_k(std::uint64_t photons) {
    const double k = 50.0 * std::pow(static_cast<double>(photons) / 1e5, 2.0 / 3.0);
    return static_cast<std::size_t>(std::max(4.0, std::round(k)));
}

std::unique_ptr<Run> start_photon_mapper(const Scene& scene, const PhotonMapperSettings& settings,
                                         const Effects& effects, std::uint64_t seed, StageTimes& stages) {
    return std::make_unique<PhotonMapperRun>(scene, settings, plan_for(scene, effects, settings),
                                             shown_components(scene, effects, find_method("photon_mapper")), seed,
                                             stages);
}

namespace {

std::vector<Parameter> photon_mapper_parameters() {
    const std::string diagonals = "scene diagonals";
    const TuningSpan two_words = {0, 1, false}, three_words = {0, 2, false};
    return {
        tuned(count_parameter("photons", "1000000", "photons", "emitted for the global map"), {1e4, 1e6}),
        count_parameter("caustic_photons", "", "photons", "emitted for the caustic map; default: the value of photons"),
        count_parameter("volume_photons", "", "photons",
                        "emitted for the volume map; default: the value of photons, with volume=beams a tenth of it"),
        tuned(integer_parameter("k", "50", "photons", 2, 1e6,
                                "photons in an estimate; auto: 50 at 1e5 photons, growing as photons^(2/3); all: all "
                                "within the radius",
                                {"auto", "all"}),
              {20, 500, true}),
        number_parameter("radius", "0.1", diagonals, 0, 1, "largest radius of a look-up in the global map"),
        number_parameter("caustic_radius", "0.025", diagonals, 0, 1,
                         "largest radius of a look-up in the caustic map, whose light has sharp edges"),
        number_parameter(
            "volume_radius", "0.05", diagonals, 0, 1,
            "largest radius of a look-up in the volume map, but at most the mean free path; with volume=ray "
            "or beams the radius of all look-ups, by default that which balances bias and variance"),
        volume_parameter(),
        choice_parameter("kernel", strings(kernel_names), "weight of a photon as a function of its distance"),
        tuned(disc_area_parameter(), three_words),
        projection_parameter(),
        tuned(integer_parameter("direct_samples", "1", "paths", 1, 65536,
                                "eye paths for emission and direct light, of each pixel in each pass, beside the one "
                                "that looks up photons; 1: one path for all light"),
              {1, 16}),
        tuned(integer_parameter("gather", "0", "rays", 0, 1e6,
                                "final gather rays for each diffuse surface that the eye sees, or for each record of "
                                "the cache; 0: indirect light comes from the global map"),
              {16, 512}),
        choice_parameter(
            "source", strings(gather_source_names),
            "light that gather rays find: irradiance precomputed at photons, photon density, or path tracing"),
        tuned(choice_parameter("cache", {"off", "on"},
                               "on ideal diffuse surfaces, gather at a few places and interpolate irradiance"),
              two_words),
        accuracy_parameter(),
        shadow_photons_parameter(),
    };
}

}  // namespace

MethodDescription describe_photon_mapper() {
    return {
        .name = "photon_mapper",
        .sentence = "photon mapping with a global and a caustic map: biased, low-frequency noise, good at caustics",
        .parameters = photon_mapper_parameters(),
        .simulates = Effects::all(),
        .components = {Component::emission, Component::direct, Component::caustic, Component::indirect,
                       Component::volume},
        .unbiased = false,
        .create = create_photon_mapper,
        .stores_light = true,
    };
}

}  // namespace gib
