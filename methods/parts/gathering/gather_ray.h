#pragma once
// What a gather ray sees: the radiance that arrives from diffuse surfaces, L (S|D)* D S*. Light that comes straight
// from its source or from specular surfaces alone is direct light or a caustic where the gather ray starts, and found
// otherwise.

#include "methods/parts/gathering/precomputed_irradiance.h"
#include "methods/path/path.h"

#include <vector>

namespace gib {

/// Where the light of a gather ray comes from.
enum class GatherSource {
    irradiance,  ///< estimated ahead from the photons: methods/parts/gathering/precomputed_irradiance.h
    photons,     ///< the density of photons where the ray ends
    paths        ///< followed on by path tracing; no photons are needed
};
inline constexpr std::array<std::string_view, 3> gather_source_names = {"irradiance", "photons", "paths"};

/// How the power of photons is spread over the lengths of their paths.
class PhotonLengths {
public:
    PhotonLengths() = default;
    explicit PhotonLengths(const std::vector<Photon>& photons);

    /// What is estimated from photons of at most `limit` edges, as a share of what is from those of at most `longest`:
    /// that of their power everywhere. Light of many bounces is nearly the same everywhere, and a rescaling by up to 5
    /// % is taken as right everywhere, once at the surface that the eye sees and once where a gather ray ends; empty:
    /// it would be more.
    std::optional<float> share(int limit, int longest) const;

private:
    std::vector<double> power_;  ///< of photons of at most so many edges, in their unit
};

struct GatheredLight {
    GatherSource source;
    int max_edges;  ///< of whole paths
    bool samples_lights, follows_specular;
    PathFeatures features;  ///< of `paths`

    PhotonMap map;  ///< PhotonMapKind::full; empty for `paths`
    DensityEstimator estimator;
    PhotonLengths lengths;
    PrecomputedIrradiance irradiance;

    /// The longest path of photons where a gather ray from a surface that the eye sees ends.
    int longest_photon_path() const { return max_edges - 2; }

    /// Radiance [W/(sr m^2)] that arrives along a gather ray that was traced, by paths of at most `edges` edges, the
    /// ray's included. `sampler` decides all that follows.
    Color arriving(RayQueries& rays, const TracedRay& ray, const Sampler& sampler, int edges,
                   DensityEstimator::Neighbours& neighbours) const;
};

}  // namespace gib
