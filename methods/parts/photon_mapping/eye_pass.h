#pragma once
// The photon mapper's eye pass, its second pass: one path through a pixel is followed through specular surfaces, and
// the light that reaches the surfaces and media on the way is added up.
// Source: Jensen 2001, section 9.4; media: chapter 10.

#include "methods/parts/density/biased_film.h"
#include "methods/parts/density/light_along_rays.h"
#include "methods/parts/gathering/cached_gather.h"
#include "methods/parts/shadow_photons/light_visibility.h"

namespace gib {

/// The photon maps and the estimators that look them up. A map that is not made is empty.
struct PhotonMaps {
    PhotonMap caustic, global, volume;
    DensityEstimator caustic_estimator, global_estimator;
    VolumeEstimator volume_estimator;
    std::optional<LightAlongRays> along_rays;  ///< all light in media; empty: it comes from `volume` and light sampling
    const FinalGather* final_gather = nullptr;  ///< null: indirect light comes from the global map
    CachedGather* cache = nullptr;              ///< null: every gather traces its rays
    std::optional<LightVisibility> light_visibility;
};

/// The present pixel of a block of pixels, and the last look-ups of the block.
struct PixelBlock {
    std::size_t pixel = 0;
    LastLookUp caustic = {}, global = {};
    std::vector<std::uint32_t> near_ray = {};  ///< scratch memory
};

/// The eye pass over one block of pixels. Maps and settings must outlive it.
class EyePass {
public:
    EyePass(const PhotonMaps& maps, const WalkSettings& settings) : maps_(maps), settings_(settings) {}

    /// One sample of a pixel along the camera's ray `eye`, with the bias of estimators that are asked for it.
    BiasedSample sample(RayQueries& rays, const TracedRay& eye, const Sampler& sampler);

    /// The same without the bias, but emission and direct light are the mean over `direct_samples` eye paths of their own
    /// through the pixel, which look up no photons and gather nothing; those of all passes take the points of one
    /// sequence. Where one path serves for all light, more of them are made for the sake of emission and direct light,
    /// and look up the same photons again.
    PixelSample sample_split(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, std::size_t pixel,
                             int direct_samples);

private:
    const PhotonMaps& maps_;
    const WalkSettings& settings_;
    PixelBlock block_;
};

}  // namespace gib
