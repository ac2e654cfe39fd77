// The photon map's k-nearest search beside nanoflann's on the same photons and queries.
#include "common/scene_file.h"
#include "methods/photon_map.h"
#include "methods/photon_walk.h"

#include <benchmark/benchmark.h>

#include <limits>
#include <map>
#include <nanoflann.hpp>
#include <string>

namespace gib {
namespace {

/// Photons of the Cornell box's global map as nanoflann wants them.
struct Cloud {
    std::vector<Vec3> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<Eigen::Index>(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};
using Yardstick =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

struct Workload {
    PhotonMap map;
    Cloud cloud;
    std::unique_ptr<Yardstick> yardstick;
    std::vector<Vec3> queries;  ///< at stored photons: where a renderer looks
};

const Workload& workload(std::size_t photons) {
    static std::map<std::size_t, Workload> cache;
    auto [it, is_new] = cache.try_emplace(photons);
    Workload& w = it->second;
    if (!is_new) return w;
    const auto scene = load_scene(std::string(GIB_SOURCE_DIR) + "/scenes/cornell-box.xml");
    auto walk = trace_photons(*scene.scene, PhotonMapKind::global, photons, std::numeric_limits<int>::max(), 1);
    if (walk.photons.size() > photons) walk.photons.resize(photons);
    for (const auto& p : walk.photons)
        w.cloud.points.push_back(p.p);
    for (std::size_t i = 0; i < 4096; ++i)
        w.queries.push_back(w.cloud.points[i * 2654435761u % w.cloud.points.size()]);
    w.map = PhotonMap(std::move(walk.photons));
    w.yardstick = std::make_unique<Yardstick>(3, w.cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    return w;
}

void BM_PhotonMapLookup(benchmark::State& state) {
    const Workload& w = workload(static_cast<std::size_t>(state.range(0)));
    const auto k = static_cast<std::size_t>(state.range(1));
    std::vector<PhotonMap::Neighbour> found;
    for (auto _ : state)
        for (const Vec3& q : w.queries) {
            w.map.nearest(
                q, k, std::numeric_limits<float>::max(), [](const Photon&, float) { return true; }, found);
            benchmark::DoNotOptimize(found.data());
        }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(w.queries.size()));
}

void BM_NanoflannLookup(benchmark::State& state) {
    const Workload& w = workload(static_cast<std::size_t>(state.range(0)));
    const auto k = static_cast<std::size_t>(state.range(1));
    std::vector<std::uint32_t> index(k);
    std::vector<float> distance2(k);
    for (auto _ : state)
        for (const Vec3& q : w.queries) {
            w.yardstick->knnSearch(q.data(), k, index.data(), distance2.data());
            benchmark::DoNotOptimize(index.data());
        }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(w.queries.size()));
}

}  // namespace

BENCHMARK(BM_PhotonMapLookup)->ArgsProduct({{1000000}, {50, 200}})->ArgNames({"photons", "k"});
BENCHMARK(BM_NanoflannLookup)->ArgsProduct({{1000000}, {50, 200}})->ArgNames({"photons", "k"});

}  // namespace gib
