#pragma once
// The walk from a light: its vertices, for connections to the camera and to vertices of the camera's walk.

#include "methods/parts/vertices/path_vertex.h"

#include <algorithm>

namespace gib {

/// Follows a path from a light and calls visit(vertex, numbers) at every vertex where another walk could end, before
/// the path is scattered there. The powers are in units of `unit` [W], the scene's emitted power, so that they keep to
/// the range of float. The path and one more edge have at most `max_edges` edges.
///
/// The walk survives a scattering event with a probability of the albedo, as photons do, so that all its vertices have
/// similar power (Jensen 2001, section 5.2).
template <typename Visit>
void walk_from_light(RayQueries& rays, const Sampler& sampler, int max_edges, double unit, const Techniques& used,
                     Visit&& visit) {
    const Scene& scene = rays.scene();
    if (max_edges < 2) return;
    const EmissionSample start =
        scene.sample_emission(sampler.get_1d(dimension::emission_light), sampler.get_2d(dimension::emission_position),
                              sampler.get_2d(dimension::emission_direction));
    const Color power = (start.power / unit).cast<float>();
    if (is_black(power)) return;
    const Light& light = scene.lights()[start.light];
    const bool from_point = std::holds_alternative<PointLight>(light) || std::holds_alternative<SpotLight>(light);
    const float cos_light = std::holds_alternative<AreaLight>(light) ? start.normal.dot(start.ray.d) : 1.f;
    const double emission = scene.emission_pdf(start.light, start.ray.d, cos_light);
    if (!(emission > 0)) return;

    TracedRay first{start.ray};
    rays.trace(first);
    PathWalk walk(rays, sampler, first, scene.has_media() ? rays.medium_at(start.ray.o) : nullptr);
    PathState& path = walk.at;
    path.beta = power;
    TechniqueSums sums = TechniqueSums::at_light(emission, 0, cos_light, is_delta(light), used);
    PathClass path_class;  // of the vertices so far, read towards the light

    // The sums for the arrival at p, whose normal has this cosine with the path.
    const auto arrive = [&](const Vec3& p, double cosine) {
        const double distance2 = double{(p - path.previous).squaredNorm()};
        if (path.vertex > 0) return sums.arrive(distance2, cosine, used.connections);
        const SurfacePoint origin{start.ray.o, start.normal, 0.f};
        const double sampling = double{scene.light_pdf_w(p, start.light, origin, start.ray.d)};
        sums = TechniqueSums::at_light(emission, from_point ? sampling * distance2 : sampling, cos_light,
                                       is_delta(light), used);
        sums.arrive(1, cosine, true);
    };

    while (path.vertex + 1 < max_edges) {
        const float before = path.beta.maxCoeff();
        const Flight flight = walk.fly();
        if (flight.is_black) return;
        const VertexNumbers u = sampler.at_vertex(path.vertex);
        if (const auto& p = flight.scattering_at) {
            arrive(*p, 1);
            visit(PathVertex(walk, *p, path_class, sums), u, walk.flights);
            if (!survives(path.beta, std::min(path.beta.maxCoeff() / before, most_survival(path.vertex)), u.roulette()))
                return;
            const Vec3 from = walk.wo();
            const Vec3 to = walk.scatter_in_medium(u, true);
            sums.scatter(double{path.pdf_w}, double{path.medium->phase().value(to, from)}, 1);
            path_class.in_medium = true;
            walk.go_on(*p, to);
            continue;
        }
        auto hit = walk.surface_hit();
        if (!hit) return;
        if (walk.passes_through(*hit)) continue;
        arrive(hit->p, std::abs(walk.wo().dot(hit->ng)));
        walk.disperse(*hit, dimension::photon_stratum);
        const PathVertex vertex(walk, *hit, path_class, sums);
        const LobeTraits& lobes = hit->bsdf->traits_at(vertex.from_local.z());
        if (!hit->delta_only && (lobes.diffuse || lobes.glossy)) visit(vertex, u, walk.flights);

        const ScatteringCoefficients c = hit->bsdf->coefficients_local(vertex.from_local);
        const float most = is_black(c.diffuse) ? most_specular_survival(path.vertex) : most_survival(path.vertex);
        if (!survives(path.beta, std::min(Color(c.diffuse + c.specular).maxCoeff(), most), u.roulette())) return;
        const auto next = walk.scatter(*hit, vertex.from_local, u, Transport::power, true);
        if (!next) return;
        step(sums, vertex, *next, Transport::radiance);
        path_class = path_class.preceded_by(next->lobe);
        walk.go_on(*hit, next->wi);
    }
}

}  // namespace gib
