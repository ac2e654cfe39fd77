// Benchmarks the rays per second of a method's estimator beside those of bare Embree on the same rays. The difference
// is the cost of everything but ray queries.
#include "common/core/parallel.h"
#include "common/reader/scene_file.h"
#include "common/sampling/warp.h"
#include "methods/parts/photons/photon_walk.h"
#include "methods/parts/transport/pixel_samples.h"
#include "methods/parts/transport/trace_path.h"
#include "tests/bench/paired_ratio.h"

#include <benchmark/benchmark.h>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <thread>

namespace gib::ray_rate {
namespace {

/// Queries are recorded and replayed in chunks of this many pixels, each by one thread, as the path tracer does.
constexpr std::size_t pixels_per_chunk = 256;
constexpr std::uint32_t passes = 8;

struct Workload {
    LoadedScene scene;
    std::vector<RayLog> chunks;  ///< the rays of `passes` passes over the image, in the path tracer's order
    std::size_t rays = 0;
};

PathSettings settings_of(const LoadedScene& scene) { return {scene.max_edges, true}; }

std::size_t chunks_per_pass(const Scene& scene) {
    const auto pixels =
        static_cast<std::size_t>(scene.sensor().width()) * static_cast<std::size_t>(scene.sensor().height());
    return (pixels + pixels_per_chunk - 1) / pixels_per_chunk;
}

/// Runs the path tracer over chunk number `chunk` and returns the number of rays; `log` may be null.
std::uint64_t trace_chunk(const LoadedScene& scene, const PathSettings& settings, std::size_t chunk, RayLog* log) {
    const std::size_t per_pass = chunks_per_pass(*scene.scene);
    const auto pixels = static_cast<std::size_t>(scene.scene->sensor().width()) *
                        static_cast<std::size_t>(scene.scene->sensor().height());
    const std::size_t begin = chunk % per_pass * pixels_per_chunk;
    RayQueries rays(*scene.scene, log);
    for_each_pixel(rays, PointSet::sobol, 1, static_cast<std::uint32_t>(chunk / per_pass), begin,
                   std::min(pixels, begin + pixels_per_chunk),
                   [&](std::size_t, const TracedRay& eye, const Sampler& sampler) {
                       benchmark::DoNotOptimize(trace_path(rays, eye, sampler, settings));
                   });
    return rays.count();
}

const Workload& workload(const std::string& file) {
    static std::map<std::string, Workload> cache;
    auto [it, is_new] = cache.try_emplace(file);
    Workload& w = it->second;
    if (!is_new) return w;
    w.scene = load_scene(path_of(file));
    w.chunks.resize(chunks_per_pass(*w.scene.scene) * passes);
    for (std::size_t c = 0; c < w.chunks.size(); ++c) {
        trace_chunk(w.scene, settings_of(w.scene), c, &w.chunks[c]);
        w.rays += w.chunks[c].entries.size();
    }
    return w;
}

RTCRayHit query_of(const Ray& ray) {
    RTCRayHit q;
    q.ray = {ray.o.x(), ray.o.y(), ray.o.z(), ray.t_min, ray.d.x(), ray.d.y(), ray.d.z(), 0.f, ray.t_max, ~0u, 0, 0};
    q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return q;
}

void replay(RTCScene scene, const RayLog& log) {
    for (const auto& entry : log.entries) {
        RTCRayHit q = query_of(entry.ray);
#if RTC_VERSION_MAJOR >= 4
        if (entry.shadow) rtcOccluded1(scene, &q.ray);
        else rtcIntersect1(scene, &q);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        if (entry.shadow) rtcOccluded1(scene, &context, &q.ray);
        else rtcIntersect1(scene, &context, &q);
#endif
        benchmark::DoNotOptimize(q);
    }
}

int threads() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

void report(benchmark::State& state, std::size_t rays) {
    state.counters["rays/s"] =
        benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsIterationInvariantRate);
    state.counters["threads"] = threads();
}

void BM_PathTracer(benchmark::State& state, const std::string& file) {
    const Workload& w = workload(file);
    const PathSettings settings = settings_of(w.scene);
    with_threads(0, [&] {
        for (auto _ : state)
            parallel_blocks(w.chunks.size(), 1, [&](std::size_t begin, std::size_t, std::size_t) {
                trace_chunk(w.scene, settings, begin, nullptr);
            });
    });
    report(state, w.rays);
}

/// Traces the path tracer's rays in the same order and on the same threads, with nothing but Embree's calls.
void BM_BareEmbree(benchmark::State& state, const std::string& file) {
    const Workload& w = workload(file);
    const auto scene = static_cast<RTCScene>(w.scene.scene->accelerator().native_handle());
    with_threads(0, [&] {
        for (auto _ : state)
            parallel_blocks(w.chunks.size(), 1,
                            [&](std::size_t begin, std::size_t, std::size_t) { replay(scene, w.chunks[begin]); });
    });
    report(state, w.rays);
}

/// Reports the time of `other` over that of `measured`; each is called with every chunk.
void report_ratio(benchmark::State& state, std::size_t chunks, const std::function<void(std::size_t)>& measured,
                  const std::function<void(std::size_t)>& other) {
    const auto seconds_of = [&](const std::function<void(std::size_t)>& chunk) {
        return seconds(
            [&] { parallel_blocks(chunks, 1, [&](std::size_t begin, std::size_t, std::size_t) { chunk(begin); }); });
    };
    std::vector<double> ratios;
    with_threads(0, [&] {
        for (auto _ : state) {
            const double time = seconds_of(measured);
            ratios.push_back(seconds_of(other) / time);
        }
    });
    report_median(state, std::move(ratios));
}

void BM_PathTracerOverBareEmbree(benchmark::State& state, const std::string& file) {
    const Workload& w = workload(file);
    const PathSettings settings = settings_of(w.scene);
    const auto scene = static_cast<RTCScene>(w.scene.scene->accelerator().native_handle());
    report_ratio(
        state, w.chunks.size(), [&](std::size_t c) { trace_chunk(w.scene, settings, c, nullptr); },
        [&](std::size_t c) { replay(scene, w.chunks[c]); });
}

/// BM_PathTracerOverBareEmbree for a scene that needs the mesh file `mesh`, which may be missing.
void BM_PathTracerOverBareEmbreeOnMesh(benchmark::State& state, const std::string& file, const std::string& mesh) {
    if (is_there(state, mesh)) BM_PathTracerOverBareEmbree(state, file);
}

/// The photon walk for the global map beside the rays of its photons, each on one thread.
void BM_PhotonWalkOverBareEmbree(benchmark::State& state, const std::string& file) {
    constexpr std::uint64_t photons = 200000;
    const LoadedScene scene = load_scene(path_of(file));
    const auto trace = [&](RayLog* log) {
        benchmark::DoNotOptimize(
            trace_photons(*scene.scene, PhotonMapKind::global, photons, scene.max_edges, 1, nullptr, nullptr, log));
    };
    RayLog log;
    with_threads(1, [&] { trace(&log); });
    const auto bare = static_cast<RTCScene>(scene.scene->accelerator().native_handle());
    std::vector<double> ratios;
    for (auto _ : state) {
        const double time = seconds([&] { with_threads(1, [&] { trace(nullptr); }); });
        ratios.push_back(seconds([&] { replay(bare, log); }) / time);
    }
    report_median(state, std::move(ratios));
}

/// Traces closest-hit rays from random points in the box of the scene into random directions. Figures that were
/// measured on other machines are scaled by this rate.
void BM_BareEmbreeIncoherent(benchmark::State& state) {
    const Workload& w = workload("cornell-box.xml");
    const auto scene = static_cast<RTCScene>(w.scene.scene->accelerator().native_handle());
    constexpr std::size_t chunks = 256, rays_per_chunk = 4096;
    static std::vector<RayLog> logs;
    if (logs.empty()) {
        logs.resize(chunks);
        const Bounds& b = w.scene.scene->bounds();
        for (std::size_t i = 0; i < chunks * rays_per_chunk; ++i) {
            const Sampler u(PointSet::independent, 1, i, 0);
            const Vec3 at = Vec3(u.get_1d(0), u.get_1d(1), u.get_1d(2));
            logs[i / rays_per_chunk].entries.push_back(
                {Ray{b.lower + at.cwiseProduct(b.upper - b.lower), square_to_sphere(u.get_2d(3))}, false});
        }
    }
    with_threads(0, [&] {
        for (auto _ : state)
            parallel_blocks(chunks, 1,
                            [&](std::size_t begin, std::size_t, std::size_t) { replay(scene, logs[begin]); });
    });
    report(state, chunks * rays_per_chunk);
}

}  // namespace

BENCHMARK_CAPTURE(BM_PathTracer, cornell_box, "cornell-box.xml")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_BareEmbree, cornell_box, "cornell-box.xml")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_PathTracer, cornell_glass, "cornell-glass.xml")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_BareEmbree, cornell_glass, "cornell-glass.xml")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_PathTracerOverBareEmbree, cornell_box, "cornell-box.xml")->UseRealTime()->Iterations(15);
BENCHMARK_CAPTURE(BM_PathTracerOverBareEmbree, cornell_glass, "cornell-glass.xml")->UseRealTime()->Iterations(15);
BENCHMARK_CAPTURE(BM_PathTracerOverBareEmbreeOnMesh, ten_million, "ten-million.xml", "meshes/generated/ten-million.ply")
    ->UseRealTime()
    ->Iterations(15);
BENCHMARK_CAPTURE(BM_PhotonWalkOverBareEmbree, cornell_box, "cornell-box.xml")->UseRealTime()->Iterations(15);
BENCHMARK_CAPTURE(BM_PhotonWalkOverBareEmbree, cornell_glass, "cornell-glass.xml")->UseRealTime()->Iterations(15);
BENCHMARK(BM_BareEmbreeIncoherent)->Name("BM_BareEmbree/incoherent")->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace gib::ray_rate
