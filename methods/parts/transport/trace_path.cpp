#include "methods/parts/transport/trace_path.h"

#include "methods/parts/transport/path_walk.h"

namespace gib {

namespace {

/// Russian roulette starts at the vertex of this number. Earlier vertices carry most of the image, and ending paths
/// there would add more variance than it saves time.
constexpr int first_roulette_vertex = 3;

/// Russian roulette. A throughput that is not finite goes into the sample, where the film counts it.
bool survives(PathWalk& walk, float most, const VertexNumbers& u, PixelSample& sample) {
    if (walk.at.vertex < first_roulette_vertex) return true;
    return walk.survives(most, u.roulette(), sample[walk.at.path_class.component()]);
}

constexpr auto both_techniques = LightTechniques::light_and_bsdf_sampling;

}  // namespace

PixelSample trace_path(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, const PathSettings& settings) {
    PixelSample sample;
    PathWalk walk(rays, sampler, eye, rays.scene().camera_medium());
    PathState& path = walk.at;
    const auto add = [&](const PathClass& path_class, const Color& radiance) {
        sample[path_class.component()] += path.beta * radiance;
    };
    while (path.vertex < settings.max_edges) {
        const bool is_last = path.vertex + 1 >= settings.max_edges;  // no vertex may follow at the end of this edge
        const Flight flight = walk.fly();
        if (flight.is_black) break;
        if (const auto& p = flight.scattering_at) {
            if (is_last) break;
            path.path_class.in_medium = true;
            const VertexNumbers u = sampler.at_vertex(path.vertex);
            if (settings.light_sampling)
                add(path.path_class, sample_direct_light(rays, *p, walk.wo(), u, walk.surroundings(), both_techniques));
            const Vec3 wi = walk.scatter_in_medium(u, settings.light_sampling);
            if (!survives(walk, most_survival(path.vertex), u, sample)) break;
            walk.go_on(*p, wi);
            continue;
        }
        auto hit = walk.surface_hit();
        if (!hit || hit->emitter) sample[path.path_class.component()] += walk.emitted(hit);
        if (!hit) break;
        if (walk.passes_through(*hit)) continue;
        if (is_last) break;

        walk.disperse(*hit, dimension::stratum);
        const VertexNumbers u = sampler.at_vertex(path.vertex);
        const Vec3 wo_local = hit->shading.to_local(walk.wo());
        const LobeTraits& lobes = hit->bsdf->traits_at(wo_local.z());
        const bool sees_lights = settings.light_sampling && (lobes.diffuse || lobes.glossy);
        if (sees_lights) {
            const LobeValues direct =
                sample_direct_light(rays, *hit, wo_local, u, walk.surroundings(), both_techniques);
            if (lobes.diffuse) add(path.path_class.after(LobeKind::diffuse), direct.diffuse);
            if (lobes.glossy) add(path.path_class.after(LobeKind::specular), direct.specular);
        }
        const auto next = walk.scatter(*hit, wo_local, u, Transport::radiance, sees_lights);
        if (!next) break;
        if (!survives(walk, next->delta ? most_specular_survival(path.vertex) : most_survival(path.vertex), u, sample))
            break;
        walk.go_on(*hit, next->wi);
    }
    return sample;
}

}  // namespace gib
