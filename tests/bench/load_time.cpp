// Benchmarks the time to load a scene of one large mesh, beside the least that loading must do: read the mesh's file
// once, and let Embree build its tree.
#include "common/core/files.h"
#include "common/reader/scene_file.h"
#include "common/scene/scene.h"
#include "tests/bench/paired_ratio.h"

#include <benchmark/benchmark.h>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <string>
#include <vector>

namespace gib::load_time {
namespace {

/// Builds Embree's scene of the mesh with Embree's default settings.
void build_bare(const Mesh& mesh) {
    const RTCDevice device = rtcNewDevice(nullptr);
    const RTCScene scene = rtcNewScene(device);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 0,
                               sizeof(mesh.vertices[0]), mesh.vertices.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(mesh.triangles[0]), mesh.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
}

const Mesh& largest_mesh(const Scene& scene) {
    const Mesh* largest = nullptr;
    for (const Shape& shape : scene.shapes()) {
        const auto* mesh = std::get_if<Mesh>(&shape);
        if (mesh && (!largest || mesh->triangles.size() > largest->triangles.size())) largest = mesh;
    }
    return *largest;
}

void BM_LoadOverReadAndBuild(benchmark::State& state, const std::string& file, const std::string& mesh_file) {
    if (!is_there(state, mesh_file)) return;
    std::vector<double> ratios;
    for (auto _ : state) {
        LoadedScene loaded;
        const double load = seconds([&] { loaded = load_scene(path_of(file)); });
        const Mesh& mesh = largest_mesh(*loaded.scene);
        const double bare = seconds([&] {
            benchmark::DoNotOptimize(read_file(path_of(mesh_file)));
            build_bare(mesh);
        });
        ratios.push_back(load / bare);
    }
    report_median(state, std::move(ratios));
}

}  // namespace

BENCHMARK_CAPTURE(BM_LoadOverReadAndBuild, ten_million, "ten-million.xml", "meshes/generated/ten-million.ply")
    ->UseRealTime()
    ->Iterations(5)
    ->Unit(benchmark::kSecond);

}  // namespace gib::load_time
