#pragma once
// The walk from the camera: its vertices, and the lights that it finds by itself.

#include "common/images/film.h"
#include "methods/parts/vertices/path_vertex.h"

#include <algorithm>

namespace gib {

/// Light that the camera's walk has found by itself (s = 0).
struct FoundLight {
    PathClass path_class;
    Color radiance;  ///< times the walk's throughput [W/(sr m^2)]
    float weight;
    int edges;  ///< of the path
};

/// Follows the path of the traced ray `eye`. Calls found(FoundLight) for lights on its way, and visit(vertex, numbers,
/// flights) at every vertex where another walk could end, before the path is scattered there. `light_paths`: the
/// number of light paths for each of the camera's paths of a pixel. A throughput that is not finite ends the path and is
/// added to the class's component of `lost`, for the film to count it.
template <typename Found, typename Visit>
void walk_from_camera(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, int max_edges, double light_paths,
                      const Techniques& used, PixelSample& lost, Found&& found, Visit&& visit) {
    constexpr int first_roulette_vertex = 3;  // as in path tracing
    const Scene& scene = rays.scene();
    PathWalk walk(rays, sampler, eye, scene.camera_medium());
    PathState& path = walk.at;
    TechniqueSums sums = TechniqueSums::at_camera(scene.sensor().ray_density(eye.ray.d), light_paths, used);

    const auto arrive = [&](const Vec3& p, double cosine) {
        const bool parallel = path.vertex == 0 && scene.sensor().is_orthographic();
        sums.arrive(parallel ? 1. : double{(p - path.previous).squaredNorm()}, cosine,
                    path.vertex == 0 || used.connections);
    };
    // The weight of a light that has been found in direction w: the density of this find by light sampling is
    // `sampling`, in the unit of TechniqueSums::other_than_hit(), and the emission's is `emission`. Light that the camera
    // sees without scattering is found by the camera's walk alone.
    const auto find = [&](const Color& Le, double sampling, double emission) {
        if (is_black(Le)) return;
        const double others = path.vertex == 0 ? 0 : sums.other_than_hit(sampling, emission, used);
        found(FoundLight{path.path_class, path.beta * Le, static_cast<float>(1 / (1 + others)), path.vertex + 1});
    };
    const auto survives = [&](float most, const VertexNumbers& u) {
        return path.vertex < first_roulette_vertex ||
               walk.survives(most, u.roulette(), lost[path.path_class.component()]);
    };

    while (path.vertex < max_edges) {
        const bool is_last = path.vertex + 1 >= max_edges;
        const Flight flight = walk.fly();
        if (flight.is_black) return;
        const VertexNumbers u = sampler.at_vertex(path.vertex);
        if (const auto& p = flight.scattering_at) {
            if (is_last) return;
            arrive(*p, 1);
            visit(PathVertex(walk, *p, path.path_class, sums), u, walk.flights);
            path.path_class.in_medium = true;
            const Vec3 from = walk.wo();
            const Vec3 to = walk.scatter_in_medium(u, true);
            sums.scatter(double{path.pdf_w}, double{path.medium->phase().value(to, from)}, 1);
            if (!survives(most_survival(path.vertex), u)) return;
            walk.go_on(*p, to);
            continue;
        }
        auto hit = walk.surface_hit();
        if (!hit) {
            if (!used.hits || !scene.environment()) return;
            const Vec3& w = walk.ray.ray.d;
            find(scene.environment_radiance(w), double{scene.environment_pdf_w(path.previous, w)},
                 scene.emission_pdf(scene.environment_index(), -w, 1.f));
            return;
        }
        const double cosine = std::abs(double{walk.wo().dot(hit->ng)});
        const TechniqueSums before = sums;
        arrive(hit->p, cosine);
        if (used.hits && hit->emitter) {
            const double per_area = cosine / double{(hit->p - path.previous).squaredNorm()};
            find(hit->Le(walk.wo()), double{scene.light_pdf_w(path.previous, *hit)} * per_area,
                 scene.emission_pdf(hit->light, walk.wo(), static_cast<float>(cosine)));
        }
        if (walk.passes_through(*hit)) {
            sums = before;
            continue;
        }
        if (is_last) return;

        walk.disperse(*hit, dimension::stratum);
        const PathVertex vertex(walk, *hit, path.path_class, sums);
        const LobeTraits& lobes = hit->bsdf->traits_at(vertex.from_local.z());
        if (!hit->delta_only && (lobes.diffuse || lobes.glossy)) visit(vertex, u, walk.flights);
        const auto next = walk.scatter(*hit, vertex.from_local, u, Transport::radiance, true);
        if (!next) return;
        step(sums, vertex, *next, Transport::power);
        if (!survives(next->delta ? most_specular_survival(path.vertex) : most_survival(path.vertex), u)) return;
        walk.go_on(*hit, next->wi);
    }
}

}  // namespace gib
