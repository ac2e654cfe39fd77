#pragma once
// Irradiance precomputed at the positions of some of the photons. A gather ray then looks up the nearest of these
// positions, its `place`, where it otherwise would look up many photons and weight them. Source: Christensen 1999,
// "Faster Photon Map Global Illumination", journal of graphics tools 4(3).
//
// One photon in n gives a place; the others are counted, with their power times n / (n - 1). Parts into which a Poisson
// process is thinned are independent, so the places are independent of the photons that are counted, and the estimate
// at a place is as unbiased as elsewhere. (If all photons were counted, each place would have a photon for certain,
// and the region in which it is the nearest would have too few others.) Irradiance is blurred over a disc of k photons,
// so that twelve places in a disc resolve it, whatever the density of photons: n = k / 12, but at least 8, and so small
// that there are 4096 places.

#include "methods/parts/density/density_estimate.h"

namespace gib {

class StageProgress;

/// The number n for estimates from k of so many photons.
std::size_t photons_per_place(std::size_t k, std::size_t photons);
/// Takes the places, one in `per_place` photons, out of `photons` and raises the power of the others. Which photons
/// become places depends on their order only.
std::vector<Photon> take_places(std::vector<Photon>& photons, std::size_t per_place = 8);

/// The data of a place besides its position. 16 bytes.
struct IrradiancePlacePayload {
    PackedColor irradiance;    ///< irradiance in the unit of all places; its tag is near_obstacle
    std::uint16_t normal;      ///< encoded, on the side where the irradiance arrives
    std::uint16_t radius;      ///< radius of the place's estimate, in 65535ths of the largest radius, rounded down
    std::uint32_t unused = 0;  ///< see KdTree for the least size

    bool near_obstacle() const { return irradiance.tag() != 0; }  ///< the estimate has met one
    Vec3 surface_normal() const { return decode_normal(normal); }
};
struct IrradiancePlace : IrradiancePlacePayload {
    using Payload = IrradiancePlacePayload;
    Vec3 p;

    IrradiancePlace() = default;
    IrradiancePlace(const Vec3& position, const Payload& payload) : Payload(payload), p(position) {}
};

class PrecomputedIrradiance {
public:
    PrecomputedIrradiance() = default;
    /// Estimates irradiance at the places from all photons of `map` whose paths have at most `max_photon_edges`
    /// edges. Adds the rays traced to `rays`. Uses all threads.
    PrecomputedIrradiance(const Scene& scene, const std::vector<Photon>& places, const PhotonMap& map,
                          const DensityEstimator& estimator, int max_photon_edges, std::uint64_t seed,
                          std::uint64_t& rays, StageProgress* progress);

    /// Irradiance [W/m^2] at the nearest place on the surface of `hit`, on the side of `normal`. A place serves
    /// if the hit lies within the disc of the place's own estimate, and if the place is not behind a wall or on another
    /// surface. Empty if no place within `max_distance` (the estimator's largest radius) serves. A short ray tests for
    /// walls, but only if the estimate at the place has met an obstacle or if the place is farther away than `seen`,
    /// the length of the ray to `hit`: the nearest place may lie outside a room that is small compared with the scene
    /// and has no places of its own.
    std::optional<Color> at(RayQueries& rays, const SurfaceHit& hit, const Vec3& normal, float seen,
                            float max_distance) const;

    std::size_t size() const { return places_.size(); }

private:
    KdTree<IrradiancePlace> places_;
    double unit_ = 1;  ///< unit of the stored irradiance [W/m^2]
};

}  // namespace gib
