#pragma once
// The loop of path tracing, over any way to choose directions. Source: Kajiya 1986, "The Rendering Equation".

#include "common/images/film.h"
#include "methods/parts/transport/path_walk.h"

namespace gib {

/// Paths that no specular chains are sampled for: light that comes through mirrors or glass is found by hitting it.
struct NoChains {
    /// Whether other samples make the path that ends on the emitter at `hit`.
    static constexpr bool leaves_out(PathWalk&, const std::optional<SurfaceHit>& /*hit*/) { return false; }
    /// Calls add(kind of lobe, radiance) for light that reaches the hit through specular vertices and is scattered to wo.
    template <typename Add>
    void add_light_of_chains(PathWalk&, const SurfaceHit&, const Vec3& /*wo_local*/, int /*edges_left*/, Add&&) {}
};

/// Directions by the bsdf or phase function alone. Other classes of directions have the same members.
struct BsdfDirections : NoChains {
    /// The path has come to a place that scatters.
    void arrive(const Vec3& /*p*/, const Vec3& /*normal*/) {}
    /// PathWalk::scatter() for an eye path, by all lobes.
    std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                        const VertexNumbers& u, bool sees_lights) {
        return walk.scatter(hit, wo_local, u, Transport::radiance, sees_lights);
    }
    std::optional<Vec3> scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights) {
        return walk.scatter_in_medium(u, sees_lights);
    }
    /// PathWalk::survives().
    bool survives(PathWalk& walk, float most, float u, Color& lost) { return walk.survives(most, u, lost); }
    /// The path has found this light, times its throughput [W/(sr m^2)].
    void found(const Color& /*light*/) {}
};

/// trace_path(), whose paths go on in the given directions. `light_sampling`: false where no light can be sampled.
template <typename Directions>
PixelSample trace_path_in(Directions& directions, RayQueries& rays, const TracedRay& eye, const Sampler& sampler,
                          int max_edges, bool light_sampling) {
    constexpr auto both = LightTechniques::light_and_bsdf_sampling;
    PixelSample sample;
    PathWalk walk(rays, sampler, eye, rays.scene().camera_medium());
    PathState& path = walk.at;
    const auto add = [&](const PathClass& path_class, const Color& light) {
        sample[path_class.component()] += light;
        directions.found(light);
    };
    // A throughput that is not finite goes into the sample, where the film counts it.
    const auto survives = [&](float most, const VertexNumbers& u) {
        if (path.vertex < first_roulette_vertex) return true;
        return directions.survives(walk, most, u.roulette(), sample[path.path_class.component()]);
    };
    while (path.vertex < max_edges) {
        const bool is_last = path.vertex + 1 >= max_edges;  // no vertex may follow at the end of this edge
        const Flight flight = walk.fly();
        if (flight.is_black) break;
        if (const auto& p = flight.scattering_at) {
            if (is_last) break;
            path.path_class.in_medium = true;
            directions.arrive(*p, Vec3::Zero());
            const VertexNumbers& u = walk.vertex_numbers;
            if (light_sampling)
                add(path.path_class,
                    path.beta * sample_direct_light(walk.rays, *p, walk.wo(), u, walk.surroundings(), both));
            const auto wi = directions.scatter_in_medium(walk, u, light_sampling);
            if (!wi || !survives(most_survival(path.vertex), u)) break;
            walk.go_on(*p, *wi);
            continue;
        }
        auto hit = walk.surface_hit();
        if ((!hit || hit->emitter) && !directions.leaves_out(walk, hit)) add(path.path_class, walk.emitted(hit));
        if (!hit) break;
        if (walk.passes_through(*hit)) continue;
        if (is_last) break;

        walk.disperse(*hit, dimension::stratum);
        directions.arrive(hit->p, normal_towards(*hit, walk.wo()));
        const VertexNumbers& u = walk.vertex_numbers;
        const Vec3 wo_local = hit->shading.to_local(walk.wo());
        const LobeTraits& lobes = hit->bsdf->traits_at(wo_local.z());
        const bool sees_lights = light_sampling && (lobes.diffuse || lobes.glossy);
        if (sees_lights) {
            const LobeValues direct = sample_direct_light(walk.rays, *hit, wo_local, u, walk.surroundings(), both);
            if (lobes.diffuse) add(path.path_class.after(LobeKind::diffuse), path.beta * direct.diffuse);
            if (lobes.glossy) add(path.path_class.after(LobeKind::specular), path.beta * direct.specular);
            directions.add_light_of_chains(walk, *hit, wo_local, max_edges - (path.vertex + 1),
                                           [&](LobeKind kind, const Color& light) {
                                               const PathClass there = path.path_class.after(kind);
                                               add(there.after(LobeKind::specular), path.beta * light);
                                           });
        }
        const auto next = directions.scatter(walk, *hit, wo_local, u, sees_lights);
        if (!next) break;
        if (!survives(next->delta ? most_specular_survival(path.vertex) : most_survival(path.vertex), u)) break;
        walk.go_on(*hit, next->wi);
    }
    return sample;
}

}  // namespace gib
