#pragma once
// The search for the photons of one look-up on a surface: those that lie on the surface of its point, in the part of the
// disc that no obstacle hides (surface_disc.h), and that may be joined with its eye path.

#include "methods/parts/density/density_estimate.h"
#include "methods/parts/density/surface_disc.h"

namespace gib {

/// Whether photons lie on the surface of a hit, as seen from wo.
class OnSurface {
public:
    OnSurface(const SurfaceHit& hit, const Vec3& wo, const EyePath& eye, DiscArea area)
        : normal_(normal_towards(hit, wo)), eye_(eye), area_(area), transmits_(hit.bsdf->traits().transmission) {}

    const Vec3& normal() const { return normal_; }

    /// `offset` is the photon's position relative to the hit, and `distance2` its squared length.
    bool operator()(const Photon& photon, const Vec3& offset, float distance2) const {
        if (!eye_.accepts(photon)) return false;
        if (area_ == DiscArea::plain) return true;
        return normal_agrees(photon) && sqr(offset.dot(normal_)) <= sqr(max_elevation_slope) * distance2;
    }

private:
    /// Whether the normal at the photon agrees with that of the hit. The last answer is kept, because neighbouring
    /// photons mostly lie on one plane: this saves a tenth of a look-up's time.
    bool normal_agrees(const Photon& photon) const {
        if (photon.normal_code() != judged_normal_) {
            const float cosine = photon.surface_normal().dot(normal_);
            agrees_ = (transmits_ ? std::abs(cosine) : cosine) > min_normal_cosine;
            judged_normal_ = photon.normal_code();
        }
        return agrees_;
    }

    Vec3 normal_;
    const EyePath& eye_;
    DiscArea area_;
    bool transmits_;                                     ///< the material scatters light from behind, too
    mutable std::uint32_t judged_normal_ = 0xffffffffu;  ///< normal code of the photon judged last; none at first
    mutable bool agrees_ = false;                        ///< the answer for that code
};

class PhotonSearch {
public:
    /// The random numbers `u` place the rays that probe the disc. `last` may be null. All arguments must outlive this.
    PhotonSearch(const DensityEstimator& estimator, const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit,
                 const Vec3& wo, const EyePath& eye, const Vec2& u, LastLookUp* last);

    /// Finds the k nearest photons. If there are k, the last one is the farthest.
    std::vector<Neighbour>& nearest();
    /// Calls visit(photon, distance2) for all photons within r > 0.
    template <typename Visit>
    void for_each_within(float r, const Visit& visit) {
        const bool on_surface = e_.area == DiscArea::surface;
        if (on_surface && !is_flat_within(r)) {
            disc_.find_layers(rays_, max_elevation_slope * r);
            near_obstacle_ = disc_.find_obstacles(rays_, r, r);
        }
        map_.within(hit_.p, r, [&](const Photon& photon, float distance2) {
            const Vec3 offset = photon.p - hit_.p;
            if (counts_(photon, offset, distance2) && (!on_surface || disc_.contains(offset))) visit(photon, distance2);
        });
    }

    const PhotonMap& map() const { return map_; }
    /// The share phi of the kernel's disc of radius r that lies on the surface, as far as rays have shown.
    float share_on_surface(float r) const {
        if (e_.area != DiscArea::surface || flat_) return 1.f;
        return disc_.share(e_.kernel, r) * disc_.covered(rays_, e_.kernel, r);
    }
    /// The area of the part of a disc of radius r that no obstacle hides, over pi.
    double free_area(float r) const { return double{disc_.share(Kernel::uniform, r)} * double{r} * double{r}; }
    /// The largest radius that the rounding of positions does not resolve, but at most the estimator's.
    float unresolved_radius() const;
    bool near_obstacle() const { return near_obstacle_; }

private:
    template <typename Accept>
    void find_k(const Accept& accept);
    bool is_flat_within(float r);

    const DensityEstimator& e_;
    const PhotonMap& map_;
    RayQueries& rays_;
    const SurfaceHit& hit_;
    OnSurface counts_;
    SurfaceDisc disc_;
    std::vector<Neighbour>& neighbours_;
    LastLookUp* last_;
    bool near_obstacle_ = false;
    bool flat_ = false;  ///< the whole disc lies on the surface, with nothing near it
};

}  // namespace gib
