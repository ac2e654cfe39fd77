#pragma once
// What the solution starts from: the light that patches get straight from the lights, and what they reflect.

#include "methods/radiosity/links.h"

namespace gib {

/// Of a surface hit, seen from wo: the share of light that its diffuse lobes send on, 0 where it has none. Where
/// there are no ideal diffuse lobes, the share of light that comes from wo.
Color diffuse_reflectance(const SurfaceHit& hit, const Vec3& wo);

/// Irradiance by `samples` shadow rays and as many in chance directions a patch (weighted by the power heuristic),
/// the mean reflectance of textured ones by as many points.
PatchLight patch_light(const PatchMesh& mesh, std::uint32_t samples, std::uint64_t seed, std::uint64_t& rays,
                       const StageTimes* stages = nullptr);

}  // namespace gib
