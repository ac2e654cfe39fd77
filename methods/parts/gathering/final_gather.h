#pragma once
// Final gathering: indirect light at a diffuse surface by rays over the hemisphere to other surfaces, instead of by the
// photons around it, and irradiance records by the same rays. Source: Jensen 1996; Jensen 2001, section 9.4.
//
// For a point x and the rays w_i of density p(w), reflected light is the mean of f(wo, w_i) L(x <- w_i) cos(theta_i) /
// p(w_i), sampled by f; a pixel's rays of all passes are one Sobol' sequence. A record takes one ray in each of M x N
// equal strata of cos(theta) (methods/parts/gathering/irradiance_record.h).

#include "methods/parts/gathering/gather_ray.h"
#include "methods/parts/gathering/irradiance_cache.h"
#include "methods/parts/transport/specular_walk.h"

namespace gib {

/// Where a record is made.
struct RecordPlace {
    SurfacePoint point;
    Vec3 normal;  ///< shading normal on the side that is seen
    RecordSpacing spacing;
    Sampler sampler;  ///< of the path that found it
    int vertex;       ///< of that path
};

class FinalGather {
public:
    /// `light` must outlive this.
    FinalGather(const GatheredLight& light, int rays)
        : light_(light), strata_(HemisphereStrata::of(rays)), rays_(rays) {}

    const GatheredLight& light() const { return light_; }

    /// Indirect radiance [W/(sr m^2)] that the hit's diffuse lobes send towards wo, at the vertex where `walk` is: by
    /// as many rays as this gathers with.
    Color reflected_radiance(const SpecularWalk& walk, const SurfaceHit& hit, const Vec3& wo,
                             DensityEstimator::Neighbours& neighbours) const;

    /// For a surface that the eye sees: of the longest paths that reach it over one edge more.
    IrradianceRecord record_at(RayQueries& rays, const RecordPlace& place,
                               DensityEstimator::Neighbours& neighbours) const;

private:
    const GatheredLight& light_;
    HemisphereStrata strata_;
    int rays_;
};

}  // namespace gib
