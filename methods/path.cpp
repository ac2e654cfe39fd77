// Path tracing: the unbiased reference.
//
// Computes: every component of a scene without media, by random walks from the eye. Light is found in two ways, by sampling
// a point of a light and by following the bsdf's samples, combined by the power heuristic (Veach 1997, section 9.2).
// Parameters: sampler = sobol (default) | independent; spp and max_depth as for all methods.
// Bias: none, for paths that it can sample. It cannot sample a point, spot or directional light seen through specular
// surfaces, and finds small lights behind them rarely (heavy tails).
// A pass: one sample of every pixel.
// Fails: never; non-finite samples are counted and dropped.
#include "methods/path.h"

#include "common/parallel.h"
#include "methods/direct_light.h"
#include "methods/method.h"

#include <algorithm>
#include <atomic>

namespace gib {

namespace {

/// Russian roulette starts at this vertex. Earlier vertices carry most of the image, and ending a path there adds more
/// variance than it saves time.
constexpr int first_roulette_vertex = 3;

/// The probability that a path goes on: its throughput, so that survivors weigh alike. `beta` without the radiance
/// scaling of refractions, which is undone on the way out.
float survival_probability(const Color& beta, float eta_scale) { return std::min(beta.maxCoeff() * eta_scale, 0.95f); }

/// Radiance from beyond the scene, found by the bsdf's sample, with its weight against light sampling from `previous`.
Color escaped_radiance(const Scene& scene, const Vec3& previous, float pdf_w, const Vec3& w) {
    const float weight = std::isfinite(pdf_w) ? power_heuristic(pdf_w, scene.environment_pdf_w(previous, w)) : 1.f;
    return weight * scene.environment_radiance(w);
}

/// The weight of radiance that the bsdf's sample found on a light, against light sampling from `previous`.
float bsdf_sampling_weight(const Scene& scene, const Vec3& previous, float pdf_w, const SurfaceHit& hit) {
    if (!std::isfinite(pdf_w)) return 1.f;
    return power_heuristic(pdf_w, scene.light_pdf_w(previous, hit));
}

}  // namespace

PixelSample trace_path(RayQueries& rays, Ray ray, const Sampler& sampler, const PathLimits& limits) {
    PixelSample sample;
    Color beta = Color::Ones();  // throughput: f cos / pdf of all vertices so far
    float eta_scale = 1.f;       // product of eta^2 that beta was divided by at refractions
    float pdf_w = infinity;      // density of the last direction; infinite: nothing else could have sampled it
    Vec3 previous = ray.o;
    PathClass path;
    for (int vertex = 0; vertex < limits.max_edges; ++vertex) {
        const auto hit = rays.intersect(ray);
        if (!hit) {
            if (rays.scene().environment())
                sample[path.component()] += beta * escaped_radiance(rays.scene(), previous, pdf_w, ray.d);
            break;
        }
        const Vec3 wo = -ray.d;

        const Color Le = hit->Le(wo);
        if (!is_black(Le))
            sample[path.component()] += beta * Le * bsdf_sampling_weight(rays.scene(), previous, pdf_w, *hit);
        if (vertex + 1 >= limits.max_edges) break;

        const Vec3 wo_local = hit->shading.to_local(wo);
        const bool sees_lights = limits.light_sampling && hit->bsdf->samples_lights(wo_local.z());
        if (sees_lights)
            sample[path.after(LobeKind::diffuse).component()] +=
                beta *
                sample_direct_light(rays, *hit, wo_local, sampler, vertex, LightTechniques::light_and_bsdf_sampling);

        const float u_lobe =
            hit->bsdf->several_lobes() ? sampler.get_1d(dimension::at_vertex(vertex, dimension::bsdf_lobe)) : 0.f;
        const auto next = hit->bsdf->sample_local(
            wo_local, u_lobe, sampler.get_2d(dimension::at_vertex(vertex, dimension::bsdf_direction)),
            Transport::radiance);
        if (!next) break;
        beta *= next->f * (std::abs(next->wi.z()) / next->pdf_w);
        eta_scale *= sqr(next->eta);
        pdf_w = next->delta || !sees_lights ? infinity : next->pdf_w;
        path.scatter(next->lobe);

        if (vertex >= first_roulette_vertex) {
            if (!beta.isFinite().all()) {
                sample[path.component()] += beta;  // roulette would end the path in silence; the film counts it
                break;
            }
            const float survival = survival_probability(beta, eta_scale);
            if (!(sampler.get_1d(dimension::at_vertex(vertex, dimension::roulette)) < survival)) break;
            beta /= survival;
        }
        previous = hit->p;
        ray = hit->spawn_ray(hit->shading.to_world(next->wi));
    }
    return sample;
}

namespace {

bool has_delta_light(const Scene& scene) { return std::any_of(scene.lights().begin(), scene.lights().end(), is_delta); }

struct PathSettings {
    PointSet points;
    int max_edges;
};

class PathRun final : public Run {
public:
    PathRun(const Scene& scene, const PathSettings& settings, const MethodDescription& description, const Plan& plan,
            std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          settings_(settings),
          limits_{settings.max_edges, plan.runs(pass_light_sampling)},
          traces_(plan.runs(pass_eye_paths)),
          seed_(seed),
          stages_(stages),
          film_(film_for(scene, plan.called_for, description)) {}

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!traces_) return Progress::converged;
        const auto timer = stages_.time(pass_eye_paths);
        const Sensor& sensor = scene_.sensor();
        const auto width = static_cast<std::size_t>(sensor.width());
        parallel_blocks(width * static_cast<std::size_t>(sensor.height()), 256,
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                            RayQueries rays(scene_);
                            for (std::size_t pixel = begin; pixel < end; ++pixel) {
                                const Sampler sampler(settings_.points, seed_, pixel, pass);
                                const Ray ray = sensor.generate_ray(static_cast<int>(pixel % width),
                                                                    static_cast<int>(pixel / width),
                                                                    sampler.get_2d(dimension::film));
                                film_.add(pixel, pass, trace_path(rays, ray, sampler, limits_));
                            }
                            rays_ += rays.count();
                        });
        return Progress::more;
    }

    ComponentImages image() const override { return film_.mean(passes_); }
    RunCounts counts() const override { return {0, rays_, film_.non_finite()}; }

private:
    const Scene& scene_;
    PathSettings settings_;
    PathLimits limits_;
    bool traces_;
    std::uint64_t seed_;
    StageTimes& stages_;
    Film film_;
    std::uint32_t passes_ = 0;
    std::atomic<std::uint64_t> rays_ = 0;
};

class PathMethod final : public Method {
public:
    PathMethod(const PathSettings& settings, const MethodDescription& description)
        : settings_(settings), description_(description) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, description_);
        // A point, spot or directional light is found by connecting a diffuse vertex to it, never through a specular one: neither where S+ L ends a
        // caustic path, nor at the end of a longer one.
        if (has_delta_light(scene) && plan.called_for.has(Effect::caustics))
            plan.unresolved = {Component::caustic, Component::indirect};
        add_eye_paths(plan, scene, settings_.max_edges);
        add_light_sampling(plan, settings_.max_edges);
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        return std::make_unique<PathRun>(scene, settings_, description_, plan(scene), seed, stages);
    }

private:
    PathSettings settings_;
    const MethodDescription& description_;
};

std::unique_ptr<Method> create_path(const ParameterValues& values, const MethodDefaults& defaults) {
    const bool sobol = values.choice("sampler") == "sobol";
    return std::make_unique<PathMethod>(
        PathSettings{sobol ? PointSet::sobol : PointSet::independent, max_edges_of(values, defaults)},
        find_method("path"));
}

}  // namespace

MethodDescription describe_path() {
    return {
        "path",
        "path tracing with light and bsdf sampling combined: unbiased, high-frequency noise",
        {{"sampler",
          Parameter::Kind::choice,
          "sobol",
          "",
          0,
          0,
          {"sobol", "independent"},
          "points of a pixel: Owen-scrambled Sobol' or independent random numbers"}},
        Effects::all(),
        {Component::emission, Component::direct, Component::caustic, Component::indirect},
        true,
        create_path,
    };
}

}  // namespace gib
