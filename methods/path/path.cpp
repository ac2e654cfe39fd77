// Path tracing: the unbiased reference. Source: Kajiya 1986, "The Rendering Equation".
//
// Computes: every component, by random walks from the eye. Each vertex finds light in two ways, by sampling a point
// of a light and by following a sample of the bsdf or phase function; the power heuristic combines the two (Veach
// 1997, section 9.2). In a medium the probability of the free flights is a factor of both densities, so
// it cancels in the heuristic.
// Parameters: sampler = sobol (default) | independent; spp and max_depth as for all methods.
// Bias: none, for paths that it can sample. It cannot sample paths on which a point, spot or directional light is
// seen through specular surfaces, and it seldom samples paths to a small light behind them (heavy tails).
// A pass: one sample of every pixel.
// Fails: never; non-finite samples are counted and dropped.
#include "methods/path/path.h"

#include "methods/method.h"
#include "methods/parts/transport/direct_light.h"
#include "methods/parts/transport/dispersed_path.h"
#include "methods/parts/transport/eye_sample_run.h"
#include "methods/parts/transport/roulette.h"
#include "methods/parts/transport/scattered_ray.h"

#include <algorithm>

namespace gib {

namespace {

/// Russian roulette starts at the vertex of this number. Earlier vertices carry most of the image, and ending paths
/// there would add more variance than it saves time.
constexpr int first_roulette_vertex = 3;

/// Survival probability: the throughput, so that all survivors have equal weight, but at most `most`. `eta_scale`
/// takes the factors 1 / eta^2 of refractions out of beta, because a path that leaves the glass again regains them.
float survival_probability(const Color& beta, float eta_scale, float most) {
    return std::min(beta.maxCoeff() * eta_scale, most);
}

/// Russian roulette: divides beta by the survival probability, or returns false if the path ends. A throughput that
/// is not finite would be dropped without notice, so it is added to `lost`, where the film counts it.
inline bool survives(Color& beta, float eta_scale, float most, float u, Color& lost) {
    if (!beta.isFinite().all()) {
        lost += beta;
        return false;
    }
    const float survival = survival_probability(beta, eta_scale, most);
    if (!(u < survival)) return false;
    if (!injected(Fault::roulette_rescaling)) beta /= survival;
    return true;
}

template <PathFeatures features>
PixelSample trace(RayQueries& rays, TracedRay traced, const Sampler& sampler, const PathSettings& settings) {
    PixelSample sample;
    Color beta = Color::Ones();  // throughput: product of f cos / pdf over the vertices so far
    float eta_scale = 1.f;       // the product of eta^2 by which refractions have divided beta
    float pdf_w = infinity;      // density [1/sr] of the last direction; infinite if light sampling could not find it
    Vec3 previous = traced.ray.o;
    PathClass path;
    std::uint32_t holes = 0;
    [[maybe_unused]] NumberStream flights(sampler);
    [[maybe_unused]] const Medium* medium = features.media_or_dispersion ? rays.scene().camera_medium() : nullptr;
    [[maybe_unused]] std::optional<int> stratum;  // wavelengths, once the path has met dispersion
    for (int vertex = 0; vertex < settings.max_edges;) {
        auto hit = rays.surface_hit(traced);
        const Vec3 wo = -traced.ray.d;
        if constexpr (features.media_or_dispersion) {
            if (medium) {
                const Ray& ray = traced.ray;  // d is a unit vector; t_min and t_max clip a camera's rays
                const Vec3 from = ray.o + ray.t_min * ray.d;
                const float length = (hit ? traced.found->t : ray.t_max) - ray.t_min;
                const auto flight = medium->sample_flight(from, ray.d, length, flights, beta);
                if (is_black(beta)) break;
                if (flight) {
                    if (vertex + 1 >= settings.max_edges) break;
                    path.in_medium = true;
                    previous = from + *flight * ray.d;
                    const VertexNumbers u = sampler.at_vertex(vertex);
                    if (settings.light_sampling)
                        sample[path.component()] +=
                            beta * sample_direct_light(rays, previous, wo, u, Surroundings{medium, flights},
                                                       LightTechniques::light_and_bsdf_sampling);
                    const Vec3 wi = medium->phase().sample(wo, u.bsdf_direction());
                    pdf_w = settings.light_sampling ? medium->phase().value(wo, wi) : infinity;
                    if (vertex >= first_roulette_vertex &&
                        !survives(beta, eta_scale, most_survival(vertex), u.roulette(), sample[path.component()]))
                        break;
                    traced.ray = {previous, wi};
                    rays.trace(traced);
                    ++vertex;
                    continue;
                }
            }
        }
        if (!hit) {
            if (rays.scene().environment())
                sample[path.component()] += beta * escaped_radiance(rays.scene(), previous, pdf_w, traced.ray.d);
            break;
        }
        const Color Le = hit->Le(wo);
        if (!is_black(Le))
            sample[path.component()] += beta * Le * bsdf_sampling_weight(rays.scene(), previous, pdf_w, *hit);
        if constexpr (features.holes) {
            const float pass_through = hit->bsdf->pass_through();
            if (pass_through > 0.f && sampler.get_1d(dimension::first_hole + holes++) < pass_through) {
                if constexpr (features.media_or_dispersion)
                    medium = rays.scene().medium_beyond(*hit, traced.ray.d, medium);
                traced.ray = hit->spawn_ray(traced.ray.d);
                rays.trace(traced);
                continue;
            }
        }
        if (vertex + 1 >= settings.max_edges) break;

        if constexpr (features.media_or_dispersion)
            disperse(rays.scene(), sampler.get_1d(dimension::stratum), *hit, stratum, beta);
        const VertexNumbers u = sampler.at_vertex(vertex);
        const Vec3 wo_local = hit->shading.to_local(wo);
        const LobeTraits& lobes = hit->bsdf->traits_at(wo_local.z());
        const bool sees_lights = settings.light_sampling && (lobes.diffuse || (features.glossy && lobes.glossy));
        if (sees_lights) {
            constexpr auto both = LightTechniques::light_and_bsdf_sampling;
            const LobeValues direct =
                features.media_or_dispersion && rays.scene().has_media()
                    ? sample_direct_light(rays, *hit, wo_local, u, Surroundings{medium, flights}, both)
                    : sample_direct_light(rays, *hit, wo_local, u, both);
            sample[path.after(LobeKind::diffuse).component()] += beta * direct.diffuse;
            if constexpr (features.glossy) sample[path.after(LobeKind::specular).component()] += beta * direct.specular;
        }

        const auto next = sample_scattering(*hit, wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::radiance);
        if (!next) break;
        beta *= next->weight;
        eta_scale *= sqr(next->eta);
        pdf_w = next->delta || !sees_lights ? infinity : next->pdf_w;
        path.scatter(next->lobe);

        const float most = next->delta ? most_specular_survival(vertex) : most_survival(vertex);
        if (vertex >= first_roulette_vertex && !survives(beta, eta_scale, most, u.roulette(), sample[path.component()]))
            break;
        previous = hit->p;
        if constexpr (features.media_or_dispersion) medium = rays.scene().medium_beyond(*hit, next->wi, medium);
        traced.ray = hit->spawn_ray(next->wi);
        rays.trace(traced);
        ++vertex;
    }
    return sample;
}

}  // namespace

PathFeatures features_of(const Scene& scene) {
    PathFeatures features{scene.has_holes(), false, scene.has_media() || scene.has_dispersion()};
    for (const Material& material : scene.materials())
        features.glossy |= material.traits().glossy;
    return features;
}

PixelSample trace_path(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, const PathSettings& settings) {
    const auto [holes, glossy, media_or_dispersion] = settings.features;
    if (media_or_dispersion) return trace<PathFeatures{true, true, true}>(rays, eye, sampler, settings);
    if (holes)
        return glossy ? trace<PathFeatures{true, true, false}>(rays, eye, sampler, settings)
                      : trace<PathFeatures{true, false, false}>(rays, eye, sampler, settings);
    return glossy ? trace<PathFeatures{false, true, false}>(rays, eye, sampler, settings)
                  : trace<PathFeatures{false, false, false}>(rays, eye, sampler, settings);
}

namespace {

bool has_delta_light(const Scene& scene) { return std::any_of(scene.lights().begin(), scene.lights().end(), is_delta); }

bool has_delta_lobe(const Scene& scene) {
    return std::any_of(scene.materials().begin(), scene.materials().end(),
                       [](const Material& material) { return material.traits().delta; });
}

class PathMethod final : public Method {
public:
    PathMethod(PointSet points, int max_edges, const MethodDescription& description)
        : points_(points), max_edges_(max_edges), description_(description) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, description_);
        // A vertex is connected to a point, spot or directional light by a straight line, never through a mirror:
        // paths that end in D S+ L are missing, whether they are caustics or the ends of longer paths.
        if (has_delta_light(scene) && has_delta_lobe(scene)) {
            if (plan.called_for.has(Effect::caustics)) plan.unresolved = {Component::caustic, Component::indirect};
            if (plan.called_for.has(Effect::participating_media)) plan.unresolved.push_back(Component::volume);
        }
        add_eye_paths(plan, scene, max_edges_);
        add_light_sampling(plan, max_edges_);
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan passes = plan(scene);
        const PathSettings settings{max_edges_, passes.runs(pass_light_sampling), features_of(scene)};
        return average_eye_samples(
            {.scene = scene, .points = points_, .seed = seed, .stages = stages, .runs = passes.runs(pass_eye_paths)},
            shown_components(scene, passes.called_for, description_),
            [settings](RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
                return trace_path(rays, eye, sampler, settings);
            });
    }

private:
    PointSet points_;
    int max_edges_;
    const MethodDescription& description_;
};

std::unique_ptr<Method> create_path(const ParameterValues& values, const MethodDefaults& defaults) {
    const bool sobol = values.choice("sampler") == "sobol";
    return std::make_unique<PathMethod>(sobol ? PointSet::sobol : PointSet::independent, max_edges_of(values, defaults),
                                        find_method("path"));
}

}  // namespace

MethodDescription describe_path() {
    return {
        .name = "path",
        .sentence = "path tracing that combines light and bsdf sampling: unbiased, high-frequency noise",
        .parameters = {choice_parameter(
            "sampler", {"sobol", "independent"},
            "random numbers of a pixel's samples: Owen-scrambled Sobol' points, or independent ones")},
        .simulates = Effects::all(),
        .components = {Component::emission, Component::direct, Component::caustic, Component::indirect,
                       Component::volume},
        .unbiased = true,
        .create = create_path,
    };
}

}  // namespace gib
