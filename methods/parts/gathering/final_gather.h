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
    Sampler sampler;  ///< of the path that found the point
    int vertex;       ///< the number of the point on that path
};

class FinalGather {
public:
    /// `light` must outlive this.
    FinalGather(const GatheredLight& light, int rays)
        : light_(light), strata_(HemisphereStrata::of(rays)), rays_(rays) {}

    const GatheredLight& light() const { return light_; }

    /// Indirect radiance [W/(sr m^2)] that the diffuse lobes of `hit`, the vertex that `walk` has reached, send
    /// towards wo, estimated by the number of rays given to the constructor.
    Color reflected_radiance(const SpecularWalk& walk, const SurfaceHit& hit, const Vec3& wo,
                             DensityEstimator::Neighbours& neighbours) const;

    /// The record at a point that the eye sees directly. Its light takes paths of one edge less than the longest,
    /// because the ray from the eye is an edge, too.
    IrradianceRecord record_at(RayQueries& rays, const RecordPlace& place,
                               DensityEstimator::Neighbours& neighbours) const;

private:
    const GatheredLight& light_;
    HemisphereStrata strata_;
    int rays_;
};

}  // namespace gib
