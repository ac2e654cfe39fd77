// Light tracing: paths start at the lights, and each of their vertices is connected to the camera. Source: Dutre,
// Lafortune and Willems 1993, "Monte Carlo light tracing with direct computation of pixel intensities"; Veach 1997,
// section 10.3 (the techniques with one vertex on the camera's side).
//
// Computes: every component, but no path that the camera sees through a mirror or a smooth interface. Lights that the
// camera sees straight are sampled from the camera.
// Parameters: sampler = sobol (default) | independent; guide = auto (default) | on | off; spp (light paths for each pixel) and
// max_depth.
// Bias: none, for paths that it can sample.
// A pass: as many light paths as the image has pixels.
// Fails: never; non-finite samples are counted and dropped.
#include "common/core/parallel.h"
#include "common/images/splat_film.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/vertices/connections.h"
#include "methods/parts/vertices/light_paths.h"
#include "methods/parts/vertices/no_merging.h"

#include <atomic>

namespace gib {

namespace {

class LightTracerRun final : public Run {
public:
    LightTracerRun(const Scene& scene, PointSet points, Guiding guiding, std::uint64_t seed, int max_edges,
                   const Plan& plan, const ShownComponents& shown, StageTimes& stages)
        : scene_(scene),
          points_(points),
          seed_(seed),
          rules_{.max_edges = max_edges, .weighs = false},
          lit_(scene.has_light()),
          follows_(plan.runs(step_light_paths)),
          paths_(scene, plan, stages, LightPolicy::find(scene, guiding, {max_edges, true}, plan, seed, stages, rays_)),
          film_(scene.sensor().width(), scene.sensor().height(), shown.accumulated, shown.black),
          splats_(scene.sensor().width(), scene.sensor().height(), shown.accumulated, paths_.sum_unit),
          stages_(stages) {}

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!lit_) return Progress::converged;
        const auto timer = stages_.time(step_light_paths);
        const auto count = static_cast<std::size_t>(paths_.count);
        std::atomic<std::uint64_t> traced = 0;
        StageProgress progress(stages_, step_light_paths, count);
        parallel_blocks(count, 1024, [&](std::size_t begin, std::size_t end, std::size_t) {
            RayQueries rays(scene_);
            for (std::size_t path = begin; path < end; ++path)
                trace(rays, Sampler(points_, seed_, path, pass), pass);
            traced += rays.count();
            progress.add(end - begin);
        });
        rays_ += traced;
        return Progress::more;
    }

    ComponentImages image() const override {
        ComponentImages images = film_.mean(1);
        splats_.add_mean(paths_.count * passes_, images);
        return images;
    }
    RunCounts counts() const override { return {.rays = rays_, .non_finite = splats_.non_finite()}; }
    std::vector<std::pair<std::string, std::string>> facts() const override {
        return {guide_fact(paths_.policy != nullptr)};
    }

private:
    void trace(RayQueries& rays, const Sampler& sampler, std::uint32_t pass) {
        const auto add = [&](const std::optional<Splat>& splat) {
            if (splat) splats_.add(splat->pixel, pass, splat->connection.light);
        };
        const Sampler camera_numbers = sampler.split(0, 1, from_camera);
        NumberStream flights(camera_numbers);
        add(sample_light_from_camera(rays, paths_, splats_, false, camera_numbers.at_vertex(0), flights));
        const auto start = follows_ ? paths_.emission.sample(sampler) : std::nullopt;
        if (!start) return;
        LightWalk(rays, sampler, paths_, rules_, NoMerging(), *start,
                  [&](const PathVertex& vertex, const VertexNumbers& u, NumberStream& flights_of_path) {
                      add(connect_to_camera(rays, vertex, paths_, rules_, splats_,
                                            {u.light_position(), u.light_choice()}, flights_of_path));
                  })
            .follow();
    }

    static constexpr std::uint64_t from_camera = 1;  ///< tag of the numbers for lights sampled from the camera

    const Scene& scene_;
    PointSet points_;
    std::uint64_t seed_;
    PathRules rules_;
    bool lit_, follows_;
    std::uint64_t rays_ = 0;
    LightPaths paths_;
    Film film_;
    SplatFilm splats_;
    StageTimes& stages_;
    std::uint32_t passes_ = 0;
};

class LightTracer final : public Method {
public:
    LightTracer(PointSet points, Guiding guiding, int max_edges)
        : points_(points), guiding_(guiding), max_edges_(max_edges) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, find_method("light_tracer"));
        if (has_delta_lobe(scene)) plan.unresolved = find_method("light_tracer").components;
        else if (scene.environment() && scene.sensor().is_orthographic() && !scene.sensor().hides_emitters())
            plan.unresolved = {Component::emission};
        add_light_paths(plan, scene, max_edges_);
        add_importons(plan, guiding_, plan.runs(step_light_paths) ? "" : "no light paths are followed");
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        return std::make_unique<LightTracerRun>(
            scene, points_, guiding_, seed, max_edges_, planned,
            shown_components(scene, planned.called_for, find_method("light_tracer")), stages);
    }

private:
    PointSet points_;
    Guiding guiding_;
    int max_edges_;
};

}  // namespace

MethodDescription describe_light_tracer() {
    return {
        .name = "light_tracer",
        .sentence = "paths from the lights whose vertices are connected to the camera: unbiased, resolves caustics",
        .parameters = {point_set_parameter(), guide_parameter()},
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = true,
        .create = [](const ParameterValues& values, const MethodDefaults& defaults) -> std::unique_ptr<Method> {
            return std::make_unique<LightTracer>(point_set_of(values), guiding_of(values),
                                                 max_edges_of(values, defaults));
        },
        .ray_cost = 1.7,
    };
}

}  // namespace gib
