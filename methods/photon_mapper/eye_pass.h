#pragma once
// The photon mapper's second pass: one path of a pixel among specular surfaces, and the light that reaches its end.
// Source: Jensen 2001, chapters 9 and 10.

#include "common/images/film.h"
#include "methods/parts/density/volume_estimate.h"
#include "methods/parts/gathering/cached_gather.h"
#include "methods/photon_mapper/light_visibility.h"

namespace gib {

/// The maps and how each is looked up; a map that is not made is empty.
struct PhotonMaps {
    PhotonMap caustic, global, volume;
    DensityEstimator caustic_estimator, global_estimator;
    VolumeEstimator volume_estimator;
    const FinalGather* final_gather = nullptr;  ///< null: indirect light comes from the global map
    CachedGather* cache = nullptr;              ///< null: nothing is cached
    std::optional<LightVisibility> light_visibility;
};

class EyePass {
public:
    /// Both must outlive this.
    EyePass(const PhotonMaps& maps, const WalkSettings& settings) : maps_(maps), settings_(settings) {}

    /// One sample of a pixel by component [W/(sr m^2)].
    PixelSample sample(RayQueries& rays, const TracedRay& eye, const Sampler& sampler);

private:
    class EyePathVisitor;

    const PhotonMaps& maps_;
    const WalkSettings& settings_;
    std::vector<PhotonMap::Neighbour> neighbours_;  ///< kept for its memory
};

}  // namespace gib
