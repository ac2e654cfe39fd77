#include "methods/parts/density/place_radius.h"

#include "methods/parts/density/surface_disc.h"

#include <array>

namespace gib {

namespace {

constexpr int probes = Accelerator::packet_size, probes_that_hit = 3;
constexpr float least_share = 0x1p-12f;
/// A disc spans at most 26 degrees of a curved surface to each side: light along the normal of its centre falls by a tenth there.
constexpr float level_cosine = 0.9f;

bool is_level(const SurfaceHit& found, const Vec3& normal) {
    return normal_towards(found, normal).dot(normal) > level_cosine;
}

/// Whether enough probes at this distance from the centre find its surface.
bool reaches(RayQueries& rays, const SurfaceHit& hit, const Frame& frame, float distance) {
    std::array<Ray, probes> tested;
    std::array<std::optional<Intersection>, probes> met;
    for (int i = 0; i < probes; ++i) {
        // Three eighths of a turn farther each time, so that the first ones look around, too.
        const float phi = 2.f * pi * static_cast<float>(3 * i % probes) / static_cast<float>(probes);
        const Vec3 w = std::cos(phi) * frame.s + std::sin(phi) * frame.t;
        tested[static_cast<std::size_t>(i)] = {.o = hit.p + distance * (w + max_elevation_slope * frame.n),
                                               .d = -frame.n,
                                               .t_max = 2.f * max_elevation_slope * distance};
    }
    int found = 0;
    const auto trace = [&](std::size_t begin, std::size_t end) {
        rays.trace_bodies(std::span(tested).subspan(begin, end - begin), std::span(met).subspan(begin, end - begin));
        for (std::size_t i = begin; i < end && found < probes_that_hit; ++i)
            if (const auto there = rays.surface_hit({tested[i], met[i]}))
                found += belongs_to(*there, hit, frame.n) && is_level(*there, frame.n) ? 1 : 0;
        return found >= probes_that_hit;
    };
    return trace(0, probes_that_hit) || trace(probes_that_hit, probes);  // on large surfaces the first ones do
}

/// Whether the triangle of the hit reaches as far in all directions, so that no probe is needed.
bool triangle_reaches(const Scene& scene, const SurfaceHit& hit, float distance) {
    const Mesh* mesh = scene.instances().empty() ? std::get_if<Mesh>(&scene.shapes()[hit.shape]) : nullptr;
    if (!mesh || !hit.is_flat()) return false;
    const auto& corners = mesh->triangles[hit.primitive];
    const auto is_farther = [&](std::uint32_t from, std::uint32_t to) {
        const Vec3 start = mesh->vertex(from), edge = mesh->vertex(to) - start;
        return edge.cross(hit.p - start).squaredNorm() > sqr(distance) * edge.squaredNorm();
    };
    return is_farther(corners[0], corners[1]) && is_farther(corners[1], corners[2]) &&
           is_farther(corners[2], corners[0]);
}

}  // namespace

float share_of_radius_at(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo, float largest) {
    if (triangle_reaches(rays.scene(), hit, largest)) return 1.f;
    // Light passes through a surface that transmits, and both sides have the same radius.
    const Frame frame(hit.bsdf->traits().transmission ? hit.ng : normal_towards(hit, wo));
    float share = 1.f;
    while (share > least_share && !reaches(rays, hit, frame, share * largest))
        share *= 0.5f;
    return share;
}

}  // namespace gib
