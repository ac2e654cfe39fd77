// Benchmarks the photon map beside nanoflann on the same photons and queries: the rates of their k-nearest searches
// on one thread, and of building them (nanoflann's on one thread, because the version here has no other; ours on
// two). `ratio` is our rate over nanoflann's.
#include "common/core/parallel.h"
#include "common/reader/scene_file.h"
#include "methods/parts/kd_tree/nearest.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/bench/paired_ratio.h"
#include "tests/support/nanoflann_tree.h"

#include <limits>
#include <map>
#include <memory>
#include <stdexcept>

namespace gib::photon_map_lookup {
namespace {

constexpr int build_threads = 2;

struct Workload {
    test::NanoflannCloud cloud;
    PhotonMap map;
    std::unique_ptr<test::NanoflannTree> yardstick;
    std::vector<Vec3> queries;  ///< at stored photons, where a renderer looks up
};

/// Exactly `count` photons of the Cornell box's global map.
std::vector<Photon> stored_photons(std::size_t count) {
    const auto scene = load_scene(path_of("cornell-box.xml"));
    // A little more than one photon is stored for each emitted one.
    auto walk = trace_photons(*scene.scene, PhotonMapKind::global, count, std::numeric_limits<int>::max(), 1);
    if (walk.photons.size() < count) throw std::runtime_error("too few photons were stored");
    walk.photons.resize(count);
    return std::move(walk.photons);
}

std::unique_ptr<test::NanoflannTree> build_yardstick(const test::NanoflannCloud& cloud) {
    return std::make_unique<test::NanoflannTree>(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
}

const Workload& workload(std::size_t photons) {
    static std::map<std::size_t, Workload> cache;
    auto [it, is_new] = cache.try_emplace(photons);
    Workload& w = it->second;
    if (!is_new) return w;
    auto stored = stored_photons(photons);
    w.cloud.points.reserve(photons);
    for (const auto& p : stored)
        w.cloud.points.push_back(p.p);
    for (std::size_t i = 0; i < 4096; ++i)
        w.queries.push_back(w.cloud.points[i * 2654435761u % w.cloud.points.size()]);
    w.map = PhotonMap(std::move(stored), 1);
    w.yardstick = build_yardstick(w.cloud);
    return w;
}

void look_up_all(const Workload& w, std::size_t k) {
    static std::vector<Neighbour> found;
    for (const Vec3& q : w.queries) {
        find_nearest(
            w.map, q, k, std::numeric_limits<float>::max(), [](const Photon&, float) { return true; }, found);
        benchmark::DoNotOptimize(found.data());
    }
}

void look_up_all_with_nanoflann(const Workload& w, std::size_t k) {
    std::vector<std::uint32_t> index(k);
    std::vector<float> distance2(k);
    for (const Vec3& q : w.queries) {
        w.yardstick->knnSearch(q.data(), k, index.data(), distance2.data());
        benchmark::DoNotOptimize(index.data());
    }
}

/// Reports our median rate (`items` over seconds) beside the median ratio.
void report_rates(benchmark::State& state, std::vector<double> ours, std::vector<double> ratios, std::size_t items) {
    const auto middle = ours.begin() + static_cast<std::ptrdiff_t>(ours.size() / 2);
    std::nth_element(ours.begin(), middle, ours.end());
    state.counters["per_second"] = static_cast<double>(items) / *middle;
    report_median(state, std::move(ratios));
}

void BM_PhotonMapLookupOverNanoflann(benchmark::State& state) {
    const Workload& w = workload(static_cast<std::size_t>(state.range(0)));
    const auto k = static_cast<std::size_t>(state.range(1));
    std::vector<double> ours, ratios;
    for (auto _ : state) {
        ours.push_back(seconds([&] { look_up_all(w, k); }));
        ratios.push_back(seconds([&] { look_up_all_with_nanoflann(w, k); }) / ours.back());
    }
    report_rates(state, std::move(ours), std::move(ratios), w.queries.size());
}

void BM_PhotonMapBuildOverNanoflann(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const Workload& w = workload(count);
    std::vector<double> ours, ratios;
    for (auto _ : state) {
        std::vector<Photon> photons(count);
        for (std::size_t i = 0; i < count; ++i)
            photons[i].p = w.cloud.points[i];  // in the order of emission
        PhotonMap map;
        with_threads(build_threads, [&] { ours.push_back(seconds([&] { map = PhotonMap(std::move(photons), 1); })); });
        state.counters["bytes_per_photon"] = static_cast<double>(map.memory()) / static_cast<double>(count);
        map = PhotonMap();
        std::unique_ptr<test::NanoflannTree> yardstick;
        ratios.push_back(seconds([&] { yardstick = build_yardstick(w.cloud); }) / ours.back());
    }
    report_rates(state, std::move(ours), std::move(ratios), count);
}

}  // namespace

BENCHMARK(BM_PhotonMapLookupOverNanoflann)
    ->ArgsProduct({{1000000, 10000000}, {50, 200, 2500}})
    ->ArgNames({"photons", "k"})
    ->UseRealTime()
    ->Iterations(15);
BENCHMARK(BM_PhotonMapBuildOverNanoflann)
    ->Arg(10000000)
    ->ArgName("photons")
    ->UseRealTime()
    ->Iterations(5)
    ->Unit(benchmark::kSecond);

}  // namespace gib::photon_map_lookup
