// Benchmarks the steps of a walk one by one over the vertices of recorded paths: where the time between two rays goes.
// `ns` is the time of a step for one vertex. In a walk the processor overlaps steps, so that their sum exceeds its time.
#include "common/images/film.h"
#include "common/reader/scene_file.h"
#include "methods/parts/transport/path_walk.h"
#include "methods/parts/transport/pixel_samples.h"
#include "tests/bench/paired_ratio.h"

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

namespace gib::vertex_steps {
namespace {

constexpr int side = 64;  ///< width and height of the image [pixels]

/// A vertex of a path from the camera and what its steps read.
struct Vertex {
    TracedRay ray;
    Sampler sampler;
    int number;
    SurfaceHit hit;
    Vec3 wo_local;
    VertexNumbers u;
    LightSample light;
    Vec3 wi_local;  ///< direction of the light
};

struct Recording {
    LoadedScene scene;
    std::vector<Vertex> vertices;
};

std::optional<LightSample> light_at(const Scene& scene, const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) {
    return scene.sample_light(hit.lit_for(wo), u.light_choice(), u.light_position());
}

/// Appends the vertices of a path that see a light's front.
void record(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, std::vector<Vertex>& vertices) {
    PathWalk walk(rays, sampler, eye, nullptr);
    while (const auto hit = walk.surface_hit()) {
        const VertexNumbers u = sampler.at_vertex(walk.at.vertex);
        const Vec3 wo_local = hit->shading.to_local(walk.wo());
        if (const auto light = light_at(rays.scene(), *hit, walk.wo(), u))
            vertices.push_back(
                {walk.ray, sampler, walk.at.vertex, *hit, wo_local, u, *light, hit->shading.to_local(light->wi)});
        const auto next = walk.scatter(*hit, wo_local, u, Transport::radiance, true);
        Color lost = Color::Zero();
        if (!next || !walk.survives(1.f, u.roulette(), lost)) return;
        walk.go_on(*hit, next->wi);
    }
}

const Recording& recording(const std::string& file) {
    static std::map<std::string, Recording> cache;
    auto [it, is_new] = cache.try_emplace(file);
    Recording& r = it->second;
    if (!is_new) return r;
    r.scene = load_scene(path_of(file), {.parameters = {}, .resolution = std::pair(side, side)});
    RayQueries rays(*r.scene.scene);
    for_each_pixel(rays, PointSet::sobol, 1, 0, 0, side * side,
                   [&](std::size_t, const TracedRay& eye, const Sampler& u) { record(rays, eye, u, r.vertices); });
    return r;
}

/// Registers the step f(Vertex, RayQueries) for two scenes.
template <typename F>
void add(const std::string& name, F f) {
    for (const char* scene : {"cornell-box", "cornell-glass"})
        benchmark::RegisterBenchmark(("BM_VertexStep/" + name + "/" + scene).c_str(), [=](benchmark::State& state) {
            const Recording& r = recording(std::string(scene) + ".xml");
            RayQueries rays(*r.scene.scene);
            for (auto _ : state)
                for (const Vertex& v : r.vertices)
                    benchmark::DoNotOptimize(f(v, rays));
            using Counter = benchmark::Counter;
            state.counters["ns"] = Counter(1e-9 * static_cast<double>(r.vertices.size()),
                                           Counter::kIsIterationInvariantRate | Counter::kInvert);
        });
}

[[maybe_unused]] const bool registered = [] {
    add("ray", [](const Vertex& v, RayQueries& rays) { return rays.scene().accelerator().intersect(v.ray.ray); });
    add("shadow_ray", [](const Vertex& v, RayQueries& rays) { return rays.visibility(v.hit, v.light)[0]; });
    add("surface_record", [](const Vertex& v, RayQueries& rays) { return rays.surface_hit(v.ray); });
    add("random_numbers", [](const Vertex& v, RayQueries&) { return v.sampler.at_vertex(v.number); });
    add("light_sample",
        [](const Vertex& v, RayQueries& rays) { return light_at(rays.scene(), v.hit, -v.ray.ray.d, v.u); });
    add("bsdf_value", [](const Vertex& v, RayQueries&) { return v.hit.bsdf->f_local(v.wo_local, v.wi_local); });
    add("bsdf_pdf", [](const Vertex& v, RayQueries&) { return v.hit.bsdf->pdf_w_local(v.wo_local, v.wi_local); });
    add("bsdf_sample", [](const Vertex& v, RayQueries&) {
        return sample_scattering(v.hit, v.wo_local, v.u.bsdf_lobe(), v.u.bsdf_direction(), Transport::radiance);
    });
    add("albedo", [](const Vertex& v, RayQueries&) { return v.hit.bsdf->coefficients_local(v.wo_local); });
    add("emission", [](const Vertex& v, RayQueries& rays) {
        return rays.scene().sample_emission(v.u.light_choice(), v.u.light_position(), v.u.bsdf_direction());
    });
    add("film", [film = std::make_shared<Film>(side, side, std::vector{Component::direct, Component::indirect},
                                               std::vector<Component>())](const Vertex& v, RayQueries&) {
        PixelSample sample;
        sample[Component::direct] = v.light.Le;
        film->add(static_cast<std::size_t>(v.number), 0, sample);
        return 0;
    });
    return true;
}();

}  // namespace
}  // namespace gib::vertex_steps
