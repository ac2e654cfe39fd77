#pragma once
// Final gathering: indirect light at a diffuse surface is estimated by rays over its hemisphere to other surfaces,
// instead of by the photons around it. The same kind of rays makes irradiance records. Source: Jensen 1996; Jensen
// 2001, section 9.4.
//
// At a point x, with rays w_i that are sampled by f with the density p(w), reflected radiance is the mean of f(wo,
// w_i) L(x <- w_i) cos(theta_i) / p(w_i). The rays of a pixel in all passes are one Sobol' sequence. A record takes
// one ray in each of M x N strata with equal parts of cos(theta) d omega
// (methods/parts/gathering/irradiance_record.h).

#include "methods/parts/gathering/gather_ray.h"
#include "methods/parts/gathering/irradiance_cache.h"
#include "methods/parts/transport/specular_walk.h"

namespace gib {

/// The point at which a record is made.
struct RecordPlace {
    SurfacePoint point;
    Vec3 normal;  ///< shading normal on the side that is seen
    RecordSpacing spacing;
    Sampler sampler;  ///< sampler of the path that found the point
    int vertex;       ///< the number of the point on that path
};

/// The mean over n gather rays, sampled by the diffuse lobes of `hit`, of arriving(ray, sampler) [W/(sr m^2)] times
/// the weight of the ray, f cos / pdf. `tag` keeps the rays' random numbers apart from those of other vertices.
template <typename Arriving>
Color gather_by_rays(const EyeVertex& vertex, const SurfaceHit& hit, int n, std::uint64_t tag, Arriving&& arriving) {
    // An eye path uses these dimensions for the place in the pixel and on the lens, which a gather ray does not have.
    constexpr std::uint32_t gather_direction = dimension::film, gather_lobe = dimension::lens;
    const Vec3 wo_local = hit.shading.to_local(vertex.wo);
    const auto count = static_cast<std::uint32_t>(n);
    Colord sum = Colord::Zero();
    for (std::uint32_t i = 0; i < count; ++i) {
        const Sampler u = vertex.walk.sampler.split(i, count, tag);
        const auto next = sample_scattering(hit, wo_local, u.get_2d(gather_lobe), u.get_2d(gather_direction),
                                            Transport::radiance, Lobes::diffuse);
        if (!next) continue;
        TracedRay ray{hit.spawn_ray(next->wi)};
        vertex.walk.rays.trace(ray);
        sum += (next->weight * arriving(ray, u)).template cast<double>();
    }
    return (sum / count).template cast<float>();
}

class FinalGather {
public:
    /// `light` must outlive this.
    FinalGather(const GatheredLight& light, int rays)
        : light_(light), strata_(HemisphereStrata::of(rays)), rays_(rays) {}

    const GatheredLight& light() const { return light_; }

    /// Indirect radiance [W/(sr m^2)] that the diffuse lobes of `hit` send back along the eye path that has reached
    /// it, estimated by the number of rays given to the constructor.
    Color reflected_radiance(const EyeVertex& vertex, const SurfaceHit& hit) const;

    /// The record at a point that the eye sees directly. Its light takes paths of one edge less than the longest,
    /// because the ray from the eye is an edge, too.
    IrradianceRecord record_at(RayQueries& rays, const RecordPlace& place) const;

private:
    const GatheredLight& light_;
    HemisphereStrata strata_;
    int rays_;
};

}  // namespace gib
