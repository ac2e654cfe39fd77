#pragma once
// The light with which the solution starts: direct irradiance of the patches, and their reflectance.

#include "methods/radiosity/links.h"

namespace gib {

/// Reflectance of the diffuse lobes at a hit seen from wo, in [0, 1]; 0 where there are none. If the diffuse lobes
/// are not ideal, it is the share of the light arriving from wo that they reflect.
Color diffuse_reflectance(const SurfaceHit& hit, const Vec3& wo);

/// Direct irradiance and mean reflectance of all leaves. Irradiance is estimated for each patch by `samples` shadow
/// rays and as many rays sampled by the bsdf, combined by the power heuristic (Veach 1997, chapter 9); the mean
/// reflectance of textured patches is taken over as many points. Adds the rays traced to `rays`. Finds the dark nodes
/// and the covered areas of `mesh`.
PatchLight patch_light(PatchMesh& mesh, std::uint32_t samples, std::uint64_t seed, std::uint64_t& rays,
                       const StageTimes* stages = nullptr);

}  // namespace gib
