#include "methods/radiosity/light.h"

#include "common/core/parallel.h"
#include "methods/parts/transport/direct_light.h"
#include "methods/parts/transport/white_surface.h"

#include <algorithm>
#include <atomic>

namespace gib {

namespace {

constexpr std::size_t leaves_per_block = 64;
/// Random dimension that places a sample on a patch, past the dimensions of the path's first vertex.
constexpr std::uint32_t on_patch = dimension::at_vertex(1, 0);

Colord irradiance_at(RayQueries& rays, SurfaceHit hit, const Sampler& sampler) {
    hit.bsdf = &white_bsdf();
    hit.shading = Frame(hit.ns);
    const VertexNumbers u = sampler.at_vertex(0);
    NumberStream flights(sampler);
    const LobeValues light =
        sample_direct_light(rays, hit, Vec3::UnitZ(), u, {nullptr, flights}, LightTechniques::light_and_bsdf_sampling);
    const LobeValues found = follow_to_light(rays, hit, Vec3::UnitZ(), u);
    return (pi * (light.sum() + found.sum())).cast<double>();
}

Colord reflectance_at(const SurfaceHit& hit, const Vec3& normal) {
    const float there = 1.f - hit.bsdf->pass_through();
    const Vec3 upright = hit.shading.to_local(normal);
    const float side = upright.z() < 0.f ? -1.f : 1.f;
    if (const auto ideal = hit.bsdf->ideal_diffuse_reflectance(side)) return (there * *ideal).cast<double>();
    // The reflectance for evenly distributed light: the mean over sin^2 of the angle of incidence.
    constexpr int angles = 8;
    Colord sum = Colord::Zero();
    for (int i = 0; i < angles; ++i) {
        const float sine2 = (static_cast<float>(i) + 0.5f) / angles;
        const Vec3 w(std::sqrt(sine2), 0.f, side * std::sqrt(1.f - sine2));
        sum += hit.bsdf->coefficients_local(w).diffuse.cast<double>() / angles;
    }
    return static_cast<double>(there) * sum;
}

/// Estimates the radiosity that the exchange of light will lead to: light that is reflected more than once is spread
/// evenly over all patches. Source: the ambient term of Cohen, Chen, Wallace and Greenberg 1988.
void expect(const PatchMesh& mesh, PatchLight& light) {
    const auto& nodes = mesh.nodes();
    Colord area = Colord::Zero(), absorbed = Colord::Zero(), received = Colord::Zero(), reflected = Colord::Zero();
    for (const std::uint32_t i : mesh.leaves()) {
        area += nodes[i].area;
        absorbed += nodes[i].area * (1 - light.reflectance[i]);
        received += nodes[i].area * light.irradiance[i];
        reflected += nodes[i].area * light.irradiance[i] * light.reflectance[i];
    }
    light.expected.assign(nodes.size(), 0.0);
    light.spread.assign(nodes.size(), 0.0);
    if (mesh.leaves().empty()) return;
    const Colord ambient = reflected / absorbed.max(1e-3 * area);
    light.mean_irradiance = (received / area + ambient).mean();
    for (const std::uint32_t i : mesh.leaves())
        light.expected[i] = (light.reflectance[i] * (light.irradiance[i] + ambient)).mean();
    for (std::size_t i = nodes.size(); i-- > 0;) {
        if (nodes[i].is_leaf()) continue;
        const std::uint32_t a = nodes[i].child, b = a + 1;
        const double share = nodes[a].area / (nodes[a].area + nodes[b].area);
        light.expected[i] = std::lerp(light.expected[b], light.expected[a], share);
        light.spread[i] = std::sqrt(std::lerp(sqr(light.spread[b]), sqr(light.spread[a]), share) +
                                    share * (1 - share) * sqr(light.expected[a] - light.expected[b]));
    }
}

}  // namespace

Color diffuse_reflectance(const SurfaceHit& hit, const Vec3& wo) {
    const Vec3 wo_local = hit.shading.to_local(wo);
    if (const auto ideal = hit.bsdf->ideal_diffuse_reflectance(wo_local.z())) return *ideal;
    return hit.bsdf->coefficients_local(wo_local).diffuse;
}

const SurfacePoint& PatchLight::point_of(const PatchMesh& mesh, std::uint32_t node, double u) const {
    const auto& nodes = mesh.nodes();
    // The number that chooses a half by its area is used again in that half.
    while (!nodes[node].is_leaf()) {
        const std::uint32_t child = nodes[node].child;
        const double share = nodes[child].area / (nodes[child].area + nodes[child + 1].area);
        const bool first = u < share;
        u = first ? u / share : (u - share) / (1 - share);
        node = first ? child : child + 1;
    }
    return points[first_point[node] + std::min(static_cast<std::uint32_t>(u * samples), samples - 1)];
}

PatchLight patch_light(const PatchMesh& mesh, std::uint32_t samples, std::uint64_t seed, std::uint64_t& rays,
                       const StageTimes* stages) {
    const auto& leaves = mesh.leaves();
    PatchLight light;
    light.irradiance.assign(mesh.nodes().size(), Colord::Zero());
    light.reflectance.assign(mesh.nodes().size(), Colord::Zero());
    light.samples = samples;
    light.points.resize(samples * leaves.size());
    light.first_point.assign(mesh.nodes().size(), 0);
    std::atomic<std::uint64_t> traced = 0;
    std::optional<StageProgress> progress;
    if (stages) progress.emplace(*stages, "direct light", leaves.size());
    parallel_blocks(leaves.size(), leaves_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries queries(mesh.charts().scene());
        for (std::size_t n = begin; n < end; ++n) {
            const std::uint32_t i = leaves[n];
            const PatchNode& leaf = mesh.nodes()[i];
            const bool textured = !queries.scene().material_of_shape(mesh.chart_of(leaf).shape).constant();
            light.first_point[i] = static_cast<std::uint32_t>(n) * samples;
            for (std::uint32_t k = 0; k < samples; ++k) {
                const Sampler sampler(PointSet::sobol, seed, i, k);
                const SurfaceHit hit = mesh.point_on(leaf, sampler.get_2d(on_patch).cast<double>());
                light.points[light.first_point[i] + k] = hit;
                light.irradiance[i] += irradiance_at(queries, hit, sampler) / samples;
                if (textured || k == 0) light.reflectance[i] += reflectance_at(hit, hit.ns) / (textured ? samples : 1);
            }
        }
        traced += queries.count();
        if (progress) progress->add(end - begin);
    });
    rays += traced;
    expect(mesh, light);
    return light;
}

}  // namespace gib
