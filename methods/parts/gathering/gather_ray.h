#pragma once
// The radiance that a final gather ray receives: light from diffuse surfaces, paths L (S|D)* D S*. Light that
// reaches the ray's origin straight from its source or over specular surfaces only is direct light or a caustic
// there, and is estimated otherwise.

#include "methods/parts/gathering/precomputed_irradiance.h"
#include "methods/parts/transport/trace_path.h"

#include <vector>

namespace gib {

/// How the radiance along a gather ray is estimated.
enum class GatherSource {
    irradiance,  ///< by irradiance precomputed from the photons: methods/parts/gathering/precomputed_irradiance.h
    photons,     ///< by the density of photons where the ray ends
    paths        ///< by path tracing from the ray's end on; needs no photons
};
inline constexpr std::array<std::string_view, 3> gather_source_names = {"irradiance", "photons", "paths"};

/// The distribution of the photons' power over the lengths of their paths.
class PhotonLengths {
public:
    PhotonLengths() = default;
    explicit PhotonLengths(const std::vector<Photon>& photons);

    /// The power of the photons with at most `limit` edges over that of the photons with at most `longest` edges, in
    /// the whole scene. If only paths of at most `limit` edges may be counted, an estimate from the photons with at
    /// most `longest` edges is multiplied by this share. Light of many bounces is nearly the same everywhere, so a
    /// rescaling by up to 5 % is accepted, once at the surface that the eye sees and once where a gather ray ends.
    /// Empty if the share is below 95 %.
    std::optional<float> share(int limit, int longest) const;

private:
    /// At index n: the power of the photons with at most n edges, in the photons' unit.
    std::vector<double> power_;
};

struct GatheredLight {
    GatherSource source;
    int max_edges;  ///< limit on the length of whole paths
    bool samples_lights, follows_specular;

    PhotonMap map = {};  ///< PhotonMapKind::full; empty for `paths`
    DensityEstimator estimator = {};
    PhotonLengths lengths = {};
    PrecomputedIrradiance irradiance = {};

    /// The most edges of a photon's path that count where a gather ray ends. Two edges are taken by the gather ray
    /// and by the ray from the eye to its origin.
    int longest_photon_path() const { return max_edges - 2; }

    /// Radiance [W/(sr m^2)] that arrives along a gather ray by paths of at most `edges` edges, including the ray,
    /// which must have been traced. `sampler` provides all further random numbers.
    Color arriving(RayQueries& rays, const TracedRay& ray, const Sampler& sampler, int edges) const;
};

}  // namespace gib
