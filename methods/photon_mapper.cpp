// Photon mapping: caustics and indirect light from the density of photons, direct light sampled, specular paths traced.
// Source: Jensen 1996, "Global Illumination using Photon Maps"; Jensen 2001, chapters 5 to 10.
//
// Computes: every component. At the first diffuse surface seen from the eye: direct by light sampling, caustic from the caustic
// map (L S+ D), indirect from the global map (L (S* D)+ S* D, and as `volume` what a medium scattered on the way). Where a free
// flight through a medium ends: light that comes straight from its source by light sampling, all other from the volume map.
// Light found at the end of specular paths counts only before that surface or event (emission), so that every path is counted once.
// Parameters: photons, caustic_photons, volume_photons [emitted], k, radius, caustic_radius and volume_radius [fractions of the
// scene's diagonal], kernel, area; spp and max_depth as for all methods. Defaults stand with the declarations at the end of this file.
// Bias: the estimates blur light over the look-up radius. It falls with more photons at fixed k, and falls together with the
// noise at k=auto; more samples a pixel do not lower it, nor the noise of the maps.
// A pass: one gather sample of every pixel. The maps are filled at the start.
// Fails: never; a map without photons near a point gives 0 there.
#include "methods/photon_mapper.h"

#include "methods/photon_gather.h"
#include "methods/photon_walk.h"
#include "methods/pixel_samples.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

constexpr std::string_view pass_specular = "specular paths";
constexpr std::string_view pass_caustic = "caustic map";
constexpr std::string_view pass_global = "global map";
constexpr std::string_view pass_volume = "volume map";

const MethodDescription& description() { return find_method("photon_mapper"); }

/// A map runs if its light is called for, its photons are not set to 0, and a path of three edges (light, event, event, eye)
/// is allowed.
void add_map(Plan& plan, std::string_view pass, bool called_for, std::uint64_t photons, int max_edges,
             const std::string& why_not_called_for) {
    std::string reason;
    if (!called_for) reason = why_not_called_for;
    else if (photons == 0) reason = "no photons are asked for";
    else if (max_edges < 3) reason = "its light has three edges or more, more than the longest path";
    plan.add(std::string(pass), reason.empty(), reason);
}

Plan photon_mapper_plan(const Scene& scene, const Effects& effects, const PhotonMapperSettings& settings) {
    Plan plan = described_plan(scene, description());
    plan.called_for = effects;
    add_eye_paths(plan, scene, settings.max_edges);
    add_light_sampling(plan, settings.max_edges);
    plan.add(std::string(pass_specular), effects.has(Effect::specular_reflection) || effects.has(Effect::refraction),
             "no surface is specular");
    add_map(plan, pass_caustic, effects.has(Effect::caustics), settings.caustic_photons, settings.max_edges,
            "no light reaches a diffuse surface by way of a specular one");
    add_map(plan, pass_global, effects.has(Effect::diffuse_interreflection), settings.photons, settings.max_edges,
            "no light is passed between diffuse surfaces");
    add_map(plan, pass_volume, scene.has_light() && scene.has_scattering_media(), settings.volume_photons,
            settings.max_edges, scene.has_light() ? "no medium scatters light" : "nothing emits light");
    return plan;
}

class PhotonMapperRun final : public Run {
public:
    PhotonMapperRun(const Scene& scene, const PhotonMapperSettings& settings, const Effects& effects,
                    std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          settings_(settings),
          seed_(seed),
          stages_(stages),
          film_(film_for(scene, effects, description())) {
        const Plan plan = photon_mapper_plan(scene, effects, settings);
        traces_ = plan.runs(pass_eye_paths);
        gather_ = {settings.max_edges, plan.runs(pass_light_sampling), plan.runs(pass_specular)};
        if (plan.runs(pass_caustic)) maps_.caustic = fill(PhotonMapKind::caustic, settings.caustic_photons);
        if (plan.runs(pass_global)) maps_.global = fill(PhotonMapKind::global, settings.photons);
        if (plan.runs(pass_volume)) maps_.volume = fill(PhotonMapKind::volume, settings.volume_photons);
        const auto length = [&](double fraction) {
            return static_cast<float>(fraction * static_cast<double>(scene.diagonal()));
        };
        maps_.global_estimator = {settings.kernel, settings.k, length(settings.radius), settings.area};
        maps_.caustic_estimator = {settings.kernel, settings.caustic_k, length(settings.caustic_radius), settings.area};
        maps_.volume_estimator = {settings.kernel, settings.volume_k, length(settings.volume_radius), settings.area};
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!traces_) return Progress::converged;
        rays_ += sample_pixels(scene_, film_, PointSet::sobol, seed_, pass, stages_, "gather", [this] {
            return [gather = PhotonGather(maps_, gather_)](RayQueries& rays, const TracedRay& eye,
                                                           const Sampler& sampler) mutable {
                return gather.sample(rays, eye, sampler);
            };
        });
        return Progress::more;
    }

    ComponentImages image() const override { return film_.mean(passes_); }
    RunCounts counts() const override { return {photons_, rays_, film_.non_finite()}; }

private:
    PhotonMap fill(PhotonMapKind kind, std::uint64_t count) {
        PhotonWalkResult walk;
        {
            const auto timer = stages_.time("photon tracing");
            StageProgress progress(stages_, "photon tracing", count);
            walk = trace_photons(scene_, kind, count, settings_.max_edges, seed_, &progress);
        }
        rays_ += walk.rays;
        photons_ += walk.emitted;
        const auto timer = stages_.time("tree build");
        return PhotonMap(std::move(walk.photons));
    }

    const Scene& scene_;
    PhotonMapperSettings settings_;
    std::uint64_t seed_;
    StageTimes& stages_;
    Film film_;
    bool traces_;
    PhotonMaps maps_;
    GatherSettings gather_;
    std::uint64_t photons_ = 0;
    std::uint32_t passes_ = 0;
    std::uint64_t rays_ = 0;
};

class PhotonMapper final : public Method {
public:
    explicit PhotonMapper(const PhotonMapperSettings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override { return photon_mapper_plan(scene, effects_of(scene), settings_); }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        return start_photon_mapper(scene, settings_, effects_of(scene), seed, stages);
    }

private:
    PhotonMapperSettings settings_;
};

template <std::size_t n>
std::vector<std::string> strings(const std::array<std::string_view, n>& names) {
    return {names.begin(), names.end()};
}

std::unique_ptr<Method> create_photon_mapper(const ParameterValues& values, const MethodDefaults& defaults) {
    PhotonMapperSettings s{};
    s.photons = static_cast<std::uint64_t>(values.integer("photons"));
    s.caustic_photons =
        values.given("caustic_photons") ? static_cast<std::uint64_t>(values.integer("caustic_photons")) : s.photons;
    s.volume_photons =
        values.given("volume_photons") ? static_cast<std::uint64_t>(values.integer("volume_photons")) : s.photons;
    const auto k = values.number_unless_word("k");
    s.k = k ? static_cast<std::size_t>(*k) : automatic_k(s.photons);
    s.caustic_k = k ? s.k : automatic_k(s.caustic_photons);
    s.volume_k = k ? s.k : automatic_k(s.volume_photons);
    s.radius = values.number("radius");
    s.caustic_radius = values.number("caustic_radius");
    s.volume_radius = values.number("volume_radius");
    const auto kernel = std::find(kernel_names.begin(), kernel_names.end(), values.choice("kernel"));
    s.kernel = static_cast<Kernel>(kernel - kernel_names.begin());
    s.area = values.choice("area") == "plain" ? DiscArea::plain : DiscArea::surface;
    s.max_edges = max_edges_of(values, defaults);
    return std::make_unique<PhotonMapper>(s);
}

}  // namespace

std::size_t automatic_k(std::uint64_t photons) {
    const double k = 50.0 * std::pow(static_cast<double>(photons) / 1e5, 2.0 / 3.0);
    return static_cast<std::size_t>(std::max(4.0, std::round(k)));
}

std::unique_ptr<Run> start_photon_mapper(const Scene& scene, const PhotonMapperSettings& settings,
                                         const Effects& effects, std::uint64_t seed, StageTimes& stages) {
    return std::make_unique<PhotonMapperRun>(scene, settings, effects, seed, stages);
}

MethodDescription describe_photon_mapper() {
    using Kind = Parameter::Kind;
    return {
        "photon_mapper",
        "photon mapping with a global and a caustic map: biased, low-frequency noise, good at caustics",
        {
            {"photons", Kind::integer, "1000000", "photons", 0, 4e9, {}, "emitted for the global map"},
            {"caustic_photons",
             Kind::integer,
             "",
             "photons",
             0,
             4e9,
             {},
             "emitted for the caustic map; default: as many as photons"},
            {"volume_photons",
             Kind::integer,
             "",
             "photons",
             0,
             4e9,
             {},
             "emitted for the volume map; default: as many as photons"},
            {"k",
             Kind::integer,
             "50",
             "photons",
             2,
             1e6,
             {"auto"},
             "photons in an estimate; auto: 50 at 1e5 photons, growing as photons^(2/3)"},
            {"radius",
             Kind::number,
             "0.1",
             "scene diagonals",
             0,
             1,
             {},
             "largest radius of a look-up in the global map"},
            {"caustic_radius",
             Kind::number,
             "0.025",
             "scene diagonals",
             0,
             1,
             {},
             "the same in the caustic map, whose light has sharp edges"},
            {"volume_radius",
             Kind::number,
             "0.05",
             "scene diagonals",
             0,
             1,
             {},
             "the same in the volume map"},
            {"kernel", Kind::choice, "uniform", "", 0, 0, strings(kernel_names), "weight of a photon by its distance"},
            {"area",
             Kind::choice,
             "surface",
             "",
             0,
             0,
             {"surface", "plain"},
             "area of a look-up's disc: the part on the surface, or all of it everywhere"},
        },
        Effects::all(),
        {Component::emission, Component::direct, Component::caustic, Component::indirect, Component::volume},
        false,
        create_photon_mapper,
    };
}

}  // namespace gib
