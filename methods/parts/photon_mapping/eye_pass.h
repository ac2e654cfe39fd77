#pragma once
// The photon mapper's eye pass, its second pass: one path through a pixel is followed through specular surfaces, and
// the light that reaches the surfaces and media on the way is added up.
// Source: Jensen 2001, section 9.4; media: chapter 10.

#include "methods/parts/density/biased_film.h"
#include "methods/parts/density/density_estimate.h"
#include "methods/parts/density/light_along_rays.h"
#include "methods/parts/density/volume_estimate.h"
#include "methods/parts/transport/specular_walk.h"

namespace gib {

/// Other estimates of the light at diffuse surfaces than by the global map and by plain light sampling: photon_mapper has some.
class DiffuseLight {
public:
    virtual ~DiffuseLight() = default;
    /// Indirect radiance that is reflected along the path [W/(sr m^2)]; empty: it comes from the global map.
    virtual std::optional<Color> indirect(const EyeVertex& vertex, const SurfaceHit& hit, std::size_t pixel) = 0;
    /// One sample of direct light that is reflected towards wo [W/(sr m^2)]; empty: it comes from plain light sampling.
    virtual std::optional<Color> direct(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo,
                                        const VertexNumbers& u) = 0;
};

/// The photon maps and the estimators that look them up. A map that is not made is empty.
struct PhotonMaps {
    PhotonMap caustic, global, volume;
    DensityEstimator caustic_estimator, global_estimator;
    VolumeEstimator volume_estimator;
    std::optional<LightAlongRays> along_rays;  ///< all light in media; empty: it comes from `volume` and light sampling
    DiffuseLight* at_diffuse = nullptr;        ///< null: the global map and plain light sampling serve everywhere
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

    /// One sample of a pixel along the camera's ray `eye`, with the bias of estimators that are asked for it. It lasts until
    /// the next one, since a copy would wait for its parts.
    const BiasedSample& sample(RayQueries& rays, const TracedRay& eye, const Sampler& sampler);

    /// The same without the bias, but emission and direct light are the mean over `direct_samples` eye paths of their own
    /// through the pixel, which look up no photons and gather nothing; those of all passes take the points of one
    /// sequence. Where one path serves for all light, more of them are made for the sake of emission and direct light,
    /// and look up the same photons again.
    const PixelSample& sample_split(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, std::size_t pixel,
                                    int direct_samples);

private:
    const PhotonMaps& maps_;
    const WalkSettings& settings_;
    PixelBlock block_;
    BiasedSample sample_;
};

}  // namespace gib
