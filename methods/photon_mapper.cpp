// Photon mapping: caustics and indirect light from the density of photons, direct light sampled, specular paths traced.
// Source: Jensen 1996, "Global Illumination using Photon Maps"; Jensen 2001, chapters 5 to 9.
//
// Computes: every component of a scene without media. At the first diffuse surface seen from the eye: direct by light
// sampling, caustic from the caustic map (L S+ D), indirect from the global map (L (S* D)+ S* D). Light found at the end of
// specular paths counts only before that surface (emission), so that every path is counted once.
// Parameters: photons, caustic_photons [emitted], k, radius and caustic_radius [fractions of the scene's diagonal], kernel,
// area, compensation; spp and max_depth as for all methods. Defaults stand with the declarations at the end of this file.
// Bias: the estimates blur light over the look-up radius. It falls with more photons at fixed k, and falls together with the
// noise at k=auto; more samples a pixel do not lower it, nor the noise of the maps.
// A pass: one gather sample of every pixel. The maps are filled at the start.
// Fails: never; a map without photons near a point gives 0 there.
#include "methods/photon_mapper.h"

#include "methods/direct_light.h"
#include "methods/photon_walk.h"
#include "methods/pixel_samples.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

constexpr std::string_view pass_specular = "specular paths";
constexpr std::string_view pass_caustic = "caustic map";
constexpr std::string_view pass_global = "global map";

/// Eye paths among specular surfaces end by roulette from this vertex on; the path tracer's earlier, since its paths go on
/// after diffuse surfaces, where a throughput near 1 is rare.
constexpr int first_roulette_vertex = 8;

/// Where the disc of a look-up is probed: past all dimensions of a path of 2^16 vertices.
constexpr std::uint32_t caustic_disc = dimension::at_vertex(1 << 16, 0);
constexpr std::uint32_t global_disc = caustic_disc + 1;

const MethodDescription& description() { return find_method("photon_mapper"); }

/// A map runs if its light is called for, its photons are not set to 0, and a path of three edges (light, surface, surface, eye)
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
        samples_lights_ = plan.runs(pass_light_sampling);
        follows_specular_ = plan.runs(pass_specular);
        if (plan.runs(pass_caustic)) caustic_map_ = fill(PhotonMapKind::caustic, settings.caustic_photons);
        if (plan.runs(pass_global)) global_map_ = fill(PhotonMapKind::global, settings.photons);
        const auto length = [&](double fraction) {
            return static_cast<float>(fraction * static_cast<double>(scene.diagonal()));
        };
        global_estimator_ = {settings.kernel, settings.k, length(settings.radius), settings.area,
                             settings.compensation};
        caustic_estimator_ = {settings.kernel, settings.caustic_k, length(settings.caustic_radius), settings.area,
                              settings.compensation};
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!traces_) return Progress::converged;
        const auto timer = stages_.time("gather");
        rays_ += sample_pixels(scene_, film_, PointSet::sobol, seed_, pass, [this] {
            return [this, found = std::vector<PhotonMap::Neighbour>()](RayQueries& rays, const TracedRay& eye,
                                                                       const Sampler& sampler) mutable {
                return gather(rays, eye, sampler, found);
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
            walk = trace_photons(scene_, kind, count, settings_.max_edges, seed_);
        }
        rays_ += walk.rays;
        photons_ += walk.emitted;
        const auto timer = stages_.time("tree build");
        return PhotonMap(std::move(walk.photons));
    }

    /// One sample of a pixel: a path of specular vertices, with what each of them shows of its diffuse lobes.
    PixelSample gather(RayQueries& rays, TracedRay traced, const Sampler& sampler,
                       std::vector<PhotonMap::Neighbour>& found) const {
        PixelSample sample;
        Color beta = Color::Ones();
        float eta_scale = 1.f;   // product of eta^2 that beta was divided by at refractions
        float pdf_w = infinity;  // density of the last direction; infinite: nothing else could have sampled it
        Vec3 previous = traced.ray.o;
        std::uint32_t holes = 0;
        for (int vertex = 0; vertex < settings_.max_edges;) {
            const auto hit = rays.surface_hit(traced);
            if (!hit) {
                sample[Component::emission] += beta * escaped_radiance(scene_, previous, pdf_w, traced.ray.d);
                break;
            }
            const Vec3 wo = -traced.ray.d;
            const Color Le = hit->Le(wo);
            if (!is_black(Le))
                sample[Component::emission] += beta * Le * bsdf_sampling_weight(scene_, previous, pdf_w, *hit);
            const float pass_through = hit->bsdf->pass_through();
            if (pass_through > 0.f && sampler.get_1d(dimension::first_hole + holes++) < pass_through) {
                traced.ray = hit->spawn_ray(traced.ray.d);
                rays.trace(traced);
                continue;
            }
            if (vertex + 1 >= settings_.max_edges) break;

            const VertexNumbers u = sampler.at_vertex(vertex);
            const Vec3 wo_local = hit->shading.to_local(wo);
            const LobeTraits& lobes = hit->bsdf->traits_at(wo_local.z());
            if (lobes.diffuse) add_diffuse(rays, *hit, wo, vertex, u, sampler, beta, found, sample);
            if (!follows_specular_ || !lobes.specular()) break;
            const bool sees_lights = samples_lights_ && lobes.glossy;
            if (sees_lights)
                sample[Component::emission] +=
                    beta * sample_direct_light(rays, *hit, wo_local, u, LightTechniques::light_and_bsdf_sampling,
                                               Lobes::specular)
                               .specular;
            const auto next = hit->bsdf->sample_local(wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::radiance,
                                                      Lobes::specular);
            if (!next) break;
            beta *= next->f * (std::abs(next->wi.z()) / next->pdf_w);
            eta_scale *= sqr(next->eta);
            pdf_w = next->delta || !sees_lights ? infinity : next->pdf_w;
            if (vertex >= first_roulette_vertex) {
                if (!beta.isFinite().all()) {
                    sample[Component::emission] += beta;  // roulette would end the path in silence; the film counts it
                    break;
                }
                const float survival = std::min(beta.maxCoeff() * eta_scale, 0.95f);
                if (!(u.roulette() < survival)) break;
                beta /= survival;
            }
            previous = hit->p;
            traced.ray = hit->spawn_ray(hit->shading.to_world(next->wi));
            rays.trace(traced);
            ++vertex;
        }
        return sample;
    }

    /// The three ways in which light reaches the first diffuse surface.
    void add_diffuse(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo, int vertex, const VertexNumbers& u,
                     const Sampler& sampler, const Color& beta, std::vector<PhotonMap::Neighbour>& found,
                     PixelSample& sample) const {
        if (samples_lights_) {
            const Vec3 wo_local = hit.shading.to_local(wo);
            // A lobe with a preferred direction is better followed than hit by chance.
            const bool follows = hit.bsdf->traits_at(wo_local.z()).rough;
            sample[Component::direct] += beta * sample_direct_light(rays, hit, wo_local, u,
                                                                    follows ? LightTechniques::light_and_bsdf_sampling
                                                                            : LightTechniques::light_sampling_only,
                                                                    Lobes::diffuse)
                                                    .diffuse;
            if (follows)
                sample[Component::direct] += beta * follow_to_light(rays, hit, wo_local, u, Lobes::diffuse).diffuse;
        }
        const int max_photon_edges = settings_.max_edges - (vertex + 1);
        if (caustic_map_.size() > 0)
            sample[Component::caustic] +=
                beta * caustic_estimator_.reflected_radiance(caustic_map_, rays, hit, wo, max_photon_edges, sampler,
                                                             caustic_disc, found);
        if (global_map_.size() > 0)
            sample[Component::indirect] +=
                beta * global_estimator_.reflected_radiance(global_map_, rays, hit, wo, max_photon_edges, sampler,
                                                            global_disc, found);
    }

    const Scene& scene_;
    PhotonMapperSettings settings_;
    std::uint64_t seed_;
    StageTimes& stages_;
    Film film_;
    bool traces_, samples_lights_, follows_specular_;
    PhotonMap caustic_map_, global_map_;
    DensityEstimator caustic_estimator_, global_estimator_;
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
    const auto k = values.number_unless_word("k");
    const bool all = values.choice("k") == "all";
    s.k = k ? static_cast<std::size_t>(*k) : all ? all_photons : automatic_k(s.photons);
    s.caustic_k = k || all ? s.k : automatic_k(s.caustic_photons);
    s.radius = values.number("radius");
    s.caustic_radius = values.number("caustic_radius");
    const auto kernel = std::find(kernel_names.begin(), kernel_names.end(), values.choice("kernel"));
    s.kernel = static_cast<Kernel>(kernel - kernel_names.begin());
    const auto area = std::find(disc_area_names.begin(), disc_area_names.end(), values.choice("area"));
    s.area = static_cast<DiscArea>(area - disc_area_names.begin());
    s.compensation = values.choice("compensation") == "on";
    if (s.compensation && all)
        throw InputError("compensation=on chooses among at most k photons; k=all keeps the radius");
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
            {"k",
             Kind::integer,
             "50",
             "photons",
             2,
             1e6,
             {"auto", "all"},
             "photons in an estimate; auto: 50 at 1e5 photons, growing as photons^(2/3); all: those within the radius"},
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
            {"kernel", Kind::choice, "uniform", "", 0, 0, strings(kernel_names), "weight of a photon by its distance"},
            {"area", Kind::choice, "surface", "", 0, 0, strings(disc_area_names),
             "what a look-up divides: the photons on the surface by the part of the disc on it; or by the whole disc "
             "(rejected); or every photon near by the whole disc (plain)"},
            {"compensation",
             Kind::choice,
             "off",
             "",
             0,
             0,
             {"off", "on"},
             "use fewer than k photons where more would blur: as many as agree within their noise"},
        },
        Effects::all() - Effects{Effect::participating_media, Effect::dispersion},
        {Component::emission, Component::direct, Component::caustic, Component::indirect},
        false,
        create_photon_mapper,
    };
}

}  // namespace gib
