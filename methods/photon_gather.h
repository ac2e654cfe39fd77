#pragma once
// The photon mapper's second pass: one path of a pixel among specular surfaces, and the light that reaches its end.
// Source: Jensen 2001, chapters 9 and 10.

#include "common/film.h"
#include "methods/density_estimate.h"
#include "methods/light_visibility.h"
#include "methods/volume_estimate.h"

namespace gib {

/// The maps and how each is looked up; a map that is not made is empty.
struct PhotonMaps {
    PhotonMap caustic, global, volume;
    DensityEstimator caustic_estimator, global_estimator;
    VolumeEstimator volume_estimator;
    std::optional<LightVisibility> light_visibility;
};

struct GatherSettings {
    int max_edges;          ///< edges of the longest path, the photon's included
    bool samples_lights;    ///< off where no light can be sampled from anywhere
    bool follows_specular;  ///< off where no surface is specular
};

class PhotonGather {
public:
    /// Both must outlive this.
    PhotonGather(const PhotonMaps& maps, const GatherSettings& settings) : maps_(maps), settings_(settings) {}

    /// One sample of a pixel by component [W/(sr m^2)].
    PixelSample sample(RayQueries& rays, const TracedRay& eye, const Sampler& sampler);

private:
    class Path;

    const PhotonMaps& maps_;
    const GatherSettings& settings_;
    std::vector<PhotonMap::Neighbour> found_;  ///< kept for its memory
};

}  // namespace gib
