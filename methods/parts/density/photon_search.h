#pragma once
// The search for the photons of a density estimate: those that lie on the surface around its point.

#include "methods/parts/density/density_estimate.h"
#include "methods/parts/density/place_rounding.h"
#include "methods/parts/density/surface_disc.h"

#include <algorithm>

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

/// The search for the photons of one look-up: those that lie on the surface of its point, in the part of the disc that no
/// obstacle hides (surface_disc.h), and that may be joined with its eye path.
class PhotonSearch {
public:
    PhotonSearch(const DensityEstimator& estimator, const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit,
                 const Vec3& wo, const EyePath& eye, const Vec2& u, LastLookUp* last)
        : e_(estimator),
          map_(map),
          rays_(rays),
          hit_(hit),
          counts_(hit, wo, eye, estimator.area),
          disc_(hit, counts_.normal(), u),
          neighbours_(neighbours_of_thread()),
          last_(last) {}

    /// Finds the k nearest photons. If there are k, the last one is the farthest.
    ///
    /// Rays look for obstacles and layers only as far as the photons lie that were found without them, so a look-up without
    /// obstacles traces a few short rays. If something stands there, the search is repeated without the photons that it
    /// hides.
    std::vector<Neighbour>& nearest() {
        bool any_off_plane = false;
        find_k([&](const Photon& photon, float distance2) {
            const Vec3 offset = photon.p - hit_.p;
            if (!counts_(photon, offset, distance2)) return false;
            any_off_plane |= disc_.off_plane(offset);
            return true;
        });
        if (e_.area != DiscArea::surface || neighbours_.empty()) return neighbours_;

        const auto offset_of = [this](const Neighbour& n) -> Vec3 { return map_[n.index].p - hit_.p; };
        bool hidden = false;
        // The search may also have met photons off the plane that are not among the nearest.
        if (any_off_plane && std::any_of(neighbours_.begin(), neighbours_.end(),
                                         [&](const auto& n) { return disc_.off_plane(offset_of(n)); })) {
            disc_.find_layers(rays_, max_elevation_slope * e_.max_radius);
            near_obstacle_ = true;
            hidden = std::any_of(neighbours_.begin(), neighbours_.end(),
                                 [&](const auto& n) { return !disc_.in_layer(offset_of(n)); });
        }
        const float r = neighbours_.size() == e_.k && !hidden ? std::sqrt(neighbours_.back().distance2) : e_.max_radius;
        flat_ = !hidden && is_flat_within(r);
        if (flat_) return neighbours_;
        if (!disc_.find_obstacles(rays_, r, e_.max_radius) && !hidden) return neighbours_;
        near_obstacle_ = true;
        map_.nearest(
            hit_.p, e_.k, e_.max_radius,
            [this](const Photon& photon, float distance2) {
                const Vec3 offset = photon.p - hit_.p;
                return counts_(photon, offset, distance2) && disc_.contains(offset);
            },
            neighbours_);
        return neighbours_;
    }

    /// Calls visit(photon, distance2) for all photons within r > 0.
    template <typename Visit>
    void for_each_within(float r, const Visit& visit) {
        const bool on_surface = e_.area == DiscArea::surface;
        flat_ = on_surface && is_flat_within(r);
        if (on_surface && !flat_) {
            near_obstacle_ = disc_.find_layers(rays_, max_elevation_slope * r);
            near_obstacle_ |= disc_.find_obstacles(rays_, r, r);
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
    float unresolved_radius() const { return std::min(place_rounding(rays_.scene(), hit_.p), e_.max_radius); }
    bool near_obstacle() const { return near_obstacle_; }

private:
    /// Finds the k nearest photons that `accept` accepts. By the triangle inequality, the ball of the last look-up lies
    /// within its radius and the distance to it. If the last look-up was close by, this ball holds hardly more than k
    /// photons. If it holds fewer, which other surfaces or limits may cause, the search is repeated in the largest one.
    template <typename Accept>
    void find_k(const Accept& accept) {
        const float near = last_ ? last_->radius + (hit_.p - last_->p).norm() : infinity;
        if (near < e_.max_radius) map_.nearest(hit_.p, e_.k, near, accept, neighbours_);
        if (!(near < e_.max_radius) || neighbours_.size() < e_.k)
            map_.nearest(hit_.p, e_.k, e_.max_radius, accept, neighbours_);
        if (last_) *last_ = {hit_.p, neighbours_.size() == e_.k ? std::sqrt(neighbours_.back().distance2) : infinity};
    }

    bool is_flat_within(float r) const { return e_.by_place.is_flat_within(hit_, r); }

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
