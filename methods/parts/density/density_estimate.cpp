#include "methods/parts/density/density_estimate.h"

#include "methods/parts/density/place_radius.h"
#include "methods/parts/density/surface_disc.h"
#include "methods/parts/kd_tree/nearest.h"

#include <algorithm>

namespace gib {

namespace {

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

/// The search for the photons of one look-up. A photon counts if it lies on the surface of the look-up's point, in the
/// part of the disc that no obstacle hides (surface_disc.h), and if its path may be joined with the eye path.
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
        find_nearest(
            map_, hit_.p, e_.k, e_.max_radius,
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
        if (near < e_.max_radius) find_nearest(map_, hit_.p, e_.k, near, accept, neighbours_);
        if (!(near < e_.max_radius) || neighbours_.size() < e_.k)
            find_nearest(map_, hit_.p, e_.k, e_.max_radius, accept, neighbours_);
        if (last_) *last_ = {hit_.p, neighbours_.size() == e_.k ? std::sqrt(neighbours_.back().distance2) : infinity};
    }

    bool is_flat_within(float r) const { return e_.is_flat_within(hit_, r); }

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

/// f Phi of one photon, its term in the sum of Jensen's equation 7.5. Factors that all photons have in common are left to
/// common().
class ReflectedPower {
public:
    ReflectedPower(const SurfaceHit& hit, const Vec3& wo, const EyePath& eye, double unit)
        : hit_(hit),
          wo_local_(hit.shading.to_local(wo)),
          eye_(eye),
          transmits_(hit.bsdf->traits().transmission),
          common_(Colord::Constant(unit)) {
        // All photons are lifted above the horizon, so that an ideal diffuse side has the same f for all of them.
        if (!transmits_ && hit.ns == hit.ng && hit.bsdf->ideal_diffuse_reflectance(wo_local_.z())) {
            has_same_f_ = true;
            common_ *= hit.bsdf->f_local(wo_local_, wo_local_).diffuse.cast<double>();
        }
    }

    /// The unit of power [W], times f [1/sr] if all photons have the same.
    const Colord& common() const { return common_; }

    Colord operator()(const Photon& photon) const {
        // In double: a bright photon's power times the factors may exceed the range of float before the
        // kernel lowers it.
        Colord arriving = photon.power().cast<double>();
        if (eye_.stratum) arriving *= eye_.weight(photon).cast<double>();
        if (has_same_f_) return arriving;
        const Vec3 wi = photon.direction();
        if (!hit_.normals_agree_about(wi)) return Colord::Zero();
        const Vec3 wi_local =
            transmits_ ? hit_.shading.to_local(wi) : lifted_above_horizon(wo_local_, hit_.shading.to_local(wi));
        const Color f = hit_.bsdf->f_local(wo_local_, wi_local).diffuse;
        return f.cast<double>() * arriving * double{shading_normal_factor(hit_, wi)};
    }

private:
    const SurfaceHit& hit_;
    Vec3 wo_local_;
    const EyePath& eye_;
    bool transmits_;           ///< the material scatters light from behind, too
    bool has_same_f_ = false;  ///< f does not depend on the photon's direction
    Colord common_;
};

/// Sum of f Phi K(d) over the photons of a disc, kept apart by whether a medium scattered the photon on its path.
class KernelSum {
public:
    KernelSum(Kernel kernel, float r)
        : kernel_(kernel), r_(r), at_centre_(r > 0.f ? kernel_weight(kernel, 0.f, r) : 0) {}

    void add(const Photon& photon, const Colord& f_phi, float distance2) {
        const double K = kernel_ == Kernel::uniform ? at_centre_ : kernel_weight(kernel_, distance2, r_);
        (photon.in_medium() ? through_media : between_surfaces) += f_phi * K;
    }

    Colord between_surfaces = Colord::Zero(), through_media = Colord::Zero();

private:
    Kernel kernel_;
    float r_;
    double at_centre_;  ///< the uniform kernel, which is constant over the disc
};

/// One estimate of the radiance that photons cause at a hit (Jensen 2001, chapter 7).
class Estimate {
public:
    Estimate(const DensityEstimator& estimator, PhotonSearch& search, const ReflectedPower& f_phi)
        : e_(estimator), search_(search), f_phi_(f_phi) {}

    /// From the k - 1 photons inside the disc whose radius is the distance of the k-th, or from all photons if fewer
    /// than k are found.
    Reflected from_nearest() const {
        auto& neighbours = search_.nearest();
        std::size_t inside = neighbours.size();
        float r = e_.max_radius;
        if (inside == e_.k) {
            r = std::sqrt(neighbours.back().distance2);
            --inside;
        }
        const float unresolved = search_.unresolved_radius();
        if (inside < neighbours.size() && r <= unresolved) return from_all_within(unresolved);
        if (inside == 0 || !(r > 0.f)) return {.radius = r};
        return radiance(r, 0.f, [&](const auto& add) {
            for (std::size_t i = 0; i < inside; ++i)
                add(search_.map()[neighbours[i].index], neighbours[i].distance2);
        });
    }

    Reflected from_all_within(float r) const {
        if (!(r > 0.f)) return {};
        return radiance(r, e_.estimates_bias ? narrow_radius * r : 0.f,
                        [&](const auto& add) { search_.for_each_within(r, add); });
    }

private:
    /// The radiance estimate of Jensen 2001, equation 7.5,
    ///     L_r(x, wo) = sum over photons p of f(x, w_p, wo) Phi_p / (pi r^2),
    /// with K(d_p) / phi in place of 1 / (pi r^2). `photons` calls a function for each photon within r. If a smaller
    /// radius is given, the bias is estimated by the difference to the estimate from it.
    template <typename Photons>
    Reflected radiance(float r, float narrow_r, const Photons& photons) const {
        KernelSum sum(e_.kernel, r), narrow(e_.kernel, narrow_r);
        photons([&](const Photon& p, float distance2) {
            const Colord f_phi = f_phi_(p);
            sum.add(p, f_phi, distance2);
            if (narrow_r > 0.f && distance2 < sqr(narrow_r)) narrow.add(p, f_phi, distance2);
        });
        Reflected L = over_phi(sum, r);
        if (narrow_r > 0.f) set_bias(L, over_phi(narrow, narrow_r));
        return L;
    }

    /// The sums times the factors of all photons, over the share phi of the disc that lies on the surface.
    Reflected over_phi(const KernelSum& sum, float r) const {
        Reflected L{.between_surfaces = (f_phi_.common() * sum.between_surfaces).cast<float>(),
                    .through_media = (f_phi_.common() * sum.through_media).cast<float>(),
                    .radius = r};
        if (is_black(L.between_surfaces) && is_black(L.through_media)) return L;
        const float phi = search_.share_on_surface(r);
        L.between_surfaces /= phi;
        L.through_media /= phi;
        return L;
    }

    static void set_bias(Reflected& L, const Reflected& narrow) {
        L.bias_between_surfaces = bias_of_difference * (L.between_surfaces - narrow.between_surfaces);
        L.bias_through_media = bias_of_difference * (L.through_media - narrow.through_media);
    }

    const DensityEstimator& e_;
    PhotonSearch& search_;
    const ReflectedPower& f_phi_;
};

}  // namespace

Reflected DensityEstimator::reflected_radiance(const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit,
                                               const Vec3& wo, const EyePath& eye, const Sampler& sampler,
                                               std::uint32_t dimension, LastLookUp* last) const {
    PhotonSearch search(*this, map, rays, hit, wo, eye, sampler.get_2d(dimension), last);
    const ReflectedPower f_phi(hit, wo, eye, map.unit());
    const Estimate estimate(*this, search, f_phi);
    const bool by_place = largest_by_place > 0.f && !is_flat_within(hit, largest_by_place);
    const float share = by_place ? share_of_radius_at(rays, hit, wo, largest_by_place) : 1.f;
    Reflected light = k == all_photons ? estimate.from_all_within(share * max_radius) : estimate.from_nearest();
    light.near_obstacle = search.near_obstacle();
    return light;
}

}  // namespace gib
