#pragma once
// Irradiance estimated ahead at some of the photons, for gather rays: one nearest photon is found where otherwise many
// would be, and weighed. Source: Christensen 1999, "Faster Photon Map Global Illumination", journal of graphics tools
// 4(3).
//
// One photon in eight gives its place, the others their power, times 8 / 7: the places are then independent of the
// photons that are counted, as the thinned parts of a Poisson process are, so that the estimate at a place is as
// unbiased as anywhere else. (Were all photons counted, each place would have a photon for certain, and the region in
// which it is the nearest would have too few others.)

#include "methods/parts/density/density_estimate.h"

namespace gib {

class StageProgress;

/// Takes the places out of `photons` and raises the power of the others. By the order in which photons are stored.
std::vector<Photon> take_places(std::vector<Photon>& photons);

class PrecomputedIrradiance {
public:
    PrecomputedIrradiance() = default;
    /// Estimates irradiance at the places by all photons of `map` whose paths have at most `max_photon_edges`. Uses all
    /// threads.
    PrecomputedIrradiance(const Scene& scene, const std::vector<Photon>& places, const PhotonMap& map,
                          const DensityEstimator& estimator, int max_photon_edges, std::uint64_t seed,
                          std::uint64_t& rays, StageProgress* progress);

    /// Irradiance [W/m^2] at the nearest place on the surface of `hit` on the side of `normal`; empty: there is none
    /// within `max_distance`, which is the estimator's largest radius, or within the disc of its own estimate; or that
    /// one may lie behind a wall or on another surface. That is asked, by a short ray, only where the estimate at the
    /// place has met an obstacle, or where the place lies farther away than the ray to `hit` has come, whose length is
    /// `seen`: a room that is small beside the scene has no places of its own for what it does not see.
    std::optional<Color> at(RayQueries& rays, const SurfaceHit& hit, const Vec3& normal, float seen, float max_distance,
                            DensityEstimator::Neighbours& neighbours) const;

    std::size_t size() const { return places_.size(); }
    std::size_t memory() const { return places_.memory(); }

private:
    PhotonMap places_;  ///< whose photons carry irradiance instead of power
};

}  // namespace gib
