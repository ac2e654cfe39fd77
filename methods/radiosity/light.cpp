#include "methods/radiosity/light.h"

#include "common/core/parallel.h"
#include "common/sampling/warp.h"
#include "methods/parts/transport/direct_light.h"
#include "methods/parts/transport/white_surface.h"
#include "methods/radiosity/contacts.h"

#include <algorithm>
#include <array>
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

/// The patches that rays from a leaf without direct light meet, one ray from each of its points.
std::vector<std::uint32_t> seen_from(RayQueries& rays, const PatchMesh& mesh, const PatchLight& light, std::size_t leaf,
                                     std::uint64_t seed) {
    std::vector<std::uint32_t> seen;
    for (std::uint32_t k = 0; k < light.samples; ++k) {
        const SurfacePoint& from = light.points[light.first_point[leaf] + k];
        const Vec2 u = Sampler(PointSet::sobol, seed, leaf, k).get_2d(on_patch + 1);
        const Vec3 w = Frame(from.ng).to_world(square_to_cosine_hemisphere(u));
        const auto hit = rays.intersect({.o = offset_origin(from, w), .d = w});
        const auto place = hit ? mesh.locate(*hit, -w) : std::nullopt;
        if (place) seen.push_back(place->leaf);
    }
    return seen;
}

/// The leaves that no light gets to: those from which no chain of rays leads to one with direct light. Light goes both
/// ways along a ray.
std::vector<bool> dark_leaves(const PatchMesh& mesh, const PatchLight& light, std::uint64_t seed, std::uint64_t& rays) {
    const auto& nodes = mesh.nodes();
    std::vector<bool> dark(nodes.size(), false);
    if (mesh.charts().scene().has_holes()) return dark;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        dark[i] = nodes[i].is_leaf() && !(light.irradiance[i].maxCoeff() > 0);
    std::vector<std::vector<std::uint32_t>> seen(nodes.size());
    std::atomic<std::uint64_t> traced = 0;
    parallel_blocks(nodes.size(), leaves_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries queries(mesh.charts().scene());
        for (std::size_t i = begin; i < end; ++i)
            if (dark[i]) seen[i] = seen_from(queries, mesh, light, i, seed);
        traced += queries.count();
    });
    rays += traced;
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            for (const std::uint32_t other : seen[i]) {
                changed |= dark[i] != dark[other];
                dark[i] = dark[other] = dark[i] && dark[other];
            }
    }
    return dark;
}

/// Leaves out the points of a flat leaf that have no direct light and that what stands on the leaf separates from all
/// points with direct light: they lie under a block. What is left has the radiosity, and is seen, as if it were all of
/// the leaf. Returns the share of points that are left.
double leave_out_covered(RayQueries& rays, const PatchNode& leaf, std::span<SurfacePoint> points,
                         std::span<const Colord> irradiance) {
    std::vector<SurfacePoint> lit, uncovered;
    for (std::size_t k = 0; k < points.size(); ++k)
        if (irradiance[k].sum() > 0) lit.push_back(points[k]);
    if (lit.empty() || lit.size() == points.size()) return 1;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const auto reaches = [&](const SurfacePoint& from) { return way_is_clear(rays, from, points[k], leaf.radius); };
        if (irradiance[k].sum() > 0 || std::any_of(lit.begin(), lit.end(), reaches)) uncovered.push_back(points[k]);
    }
    const std::size_t left = uncovered.size();
    if (left < points.size())
        for (std::size_t k = 0; k < points.size(); ++k)
            points[k] = uncovered[k * left / points.size()];
    return static_cast<double>(left) / static_cast<double>(points.size());
}

/// Fills in the expected radiosity of inner nodes, which is the mean of their halves, its spread, and its middle.
void pull_expected(const PatchMesh& mesh, PatchLight& light) {
    const auto& nodes = mesh.nodes();
    for (std::size_t i = nodes.size(); i-- > 0;) {
        if (nodes[i].is_leaf()) continue;
        const std::uint32_t a = nodes[i].child, b = a + 1;
        const double share = nodes[a].area / (nodes[a].area + nodes[b].area);
        light.expected[i] = share * light.expected[a] + (1 - share) * light.expected[b];
        const double bright = light.expected[i] > 0 ? share * light.expected[a] / light.expected[i] : share;
        light.middle[i] = bright * light.middle[a] + (1 - bright) * light.middle[b];
        light.spread[i] = std::sqrt(share * sqr(light.spread[a]) + (1 - share) * sqr(light.spread[b]) +
                                    share * (1 - share) * sqr(light.expected[a] - light.expected[b]));
    }
}

/// Estimates the radiosity that the exchange of light will lead to: light that is reflected more than once is spread
/// evenly over all patches. Source: the ambient term of Cohen, Chen, Wallace and Greenberg 1988.
void expect(const PatchMesh& mesh, PatchLight& light) {
    const auto& nodes = mesh.nodes();
    Colord area = Colord::Zero(), absorbed = Colord::Zero(), received = Colord::Zero(), reflected = Colord::Zero();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf() || nodes[i].dark) continue;
        area += nodes[i].area;
        absorbed += nodes[i].area * (1 - light.reflectance[i]);
        received += nodes[i].area * light.irradiance[i];
        reflected += nodes[i].area * light.irradiance[i] * light.reflectance[i];
    }
    if (!(area[0] > 0)) return;
    const Colord ambient = reflected / absorbed.max(1e-3 * area);
    light.mean_irradiance = (received / area + ambient).mean();
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (nodes[i].is_leaf() && !nodes[i].dark)
            light.expected[i] = (light.reflectance[i] * (light.irradiance[i] + ambient)).mean();
    pull_expected(mesh, light);
}

}  // namespace

Color diffuse_reflectance(const SurfaceHit& hit, const Vec3& wo) {
    const Vec3 wo_local = hit.shading.to_local(wo);
    if (const auto ideal = hit.bsdf->ideal_diffuse_reflectance(wo_local.z())) return *ideal;
    return hit.bsdf->coefficients_local(wo_local).diffuse;
}

PatchLight patch_light(PatchMesh& mesh, std::uint32_t samples, std::uint64_t seed, std::uint64_t& rays,
                       const StageTimes* stages) {
    const auto& nodes = mesh.nodes();
    PatchLight light;
    light.irradiance.assign(nodes.size(), Colord::Zero());
    light.reflectance.assign(nodes.size(), Colord::Zero());
    light.expected.assign(nodes.size(), 0.0);
    light.spread.assign(nodes.size(), 0.0);
    light.samples = samples;
    std::uint32_t count = 0;
    for (const PatchNode& node : nodes) {
        light.first_point.push_back(count);
        if (node.is_leaf()) count += samples;
    }
    light.points.resize(count);
    for (const PatchNode& node : nodes)
        light.middle.push_back(node.center);
    std::vector<double> uncovered(nodes.size(), 1.0);
    std::atomic<std::uint64_t> traced = 0;
    std::optional<StageProgress> progress;
    if (stages) progress.emplace(*stages, "direct light", nodes.size());
    parallel_blocks(nodes.size(), leaves_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries queries(mesh.charts().scene());
        std::vector<Colord> irradiance(samples);
        for (std::size_t i = begin; i < end; ++i) {
            if (!nodes[i].is_leaf()) continue;
            const std::span<SurfacePoint> points(&light.points[light.first_point[i]], samples);
            const bool textured = !queries.scene().material_of_shape(mesh.chart_of(nodes[i]).shape).constant();
            for (std::uint32_t k = 0; k < samples; ++k) {
                const Sampler sampler(PointSet::sobol, seed, i, k);
                const SurfaceHit hit = mesh.point_on(nodes[i], sampler.get_2d(on_patch).cast<double>());
                points[k] = hit;
                irradiance[k] = irradiance_at(queries, hit, sampler);
                if (textured || k == 0) light.reflectance[i] += reflectance_at(hit, hit.ns) / (textured ? samples : 1);
            }
            if (!mesh.chart_of(nodes[i]).curved)
                uncovered[i] = leave_out_covered(queries, nodes[i], points, irradiance);
            for (const Colord& E : irradiance)
                light.irradiance[i] += E / (uncovered[i] * samples);
        }
        traced += queries.count();
        if (progress) progress->add(end - begin);
    });
    rays += traced;
    mesh.set_exposure(dark_leaves(mesh, light, seed, rays), uncovered);
    expect(mesh, light);
    return light;
}

}  // namespace gib
