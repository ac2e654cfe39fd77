#include "methods/parts/density/density_estimate.h"

#include "methods/parts/density/bias_compensation.h"
#include "methods/parts/density/place_rounding.h"
#include "methods/parts/density/surface_disc.h"

#include <algorithm>

namespace gib {

namespace {

/// Sums over photons [W/(sr m^2)], kept apart by whether a medium scattered the photon on its path.
struct PhotonSums {
    Colord between_surfaces = Colord::Zero(), through_media = Colord::Zero();

    void add(const Photon& photon, const Colord& value) {
        (photon.in_medium() ? through_media : between_surfaces) += value;
    }
};

/// One look-up: finds the photons around a hit and estimates the radiance that they cause (Jensen 2001, chapter 7).
class LookUp {
public:
    LookUp(const DensityEstimator& estimator, const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit,
           const Vec3& wo, const EyePath& eye, const Vec2& u, std::vector<Neighbour>& neighbours, LastLookUp* last)
        : e_(estimator),
          map_(map),
          rays_(rays),
          hit_(hit),
          normal_(normal_towards(hit, wo)),
          wo_local_(hit.shading.to_local(wo)),
          eye_(eye),
          transmits_(hit.bsdf->traits().transmission),
          common_factor_(Colord::Constant(map.unit())),
          disc_(hit, normal_, u),
          neighbours_(neighbours),
          last_(last) {
        neighbours_.clear();
        // All photons are lifted above the horizon, so that an ideal diffuse side has the same f for all of them.
        if (!transmits_ && hit.ns == hit.ng && hit.bsdf->ideal_diffuse_reflectance(wo_local_.z())) {
            has_same_f_ = true;
            common_factor_ *= hit.bsdf->f_local(wo_local_, wo_local_).diffuse.cast<double>();
        }
    }

    Reflected radiance() {
        Reflected light = e_.k == all_photons ? radiance_within(e_.max_radius) : radiance_of_nearest();
        light.near_obstacle = near_obstacle_;
        return light;
    }

private:
    /// The estimate from the nearest photons (Jensen 2001, chapter 7): the sum of f power K(d) over the k - 1 photons
    /// inside the disc whose radius is the distance of the k-th, or over all photons if fewer than k are found.
    Reflected radiance_of_nearest() {
        find_nearest();
        std::size_t inside = neighbours_.size();
        float r = e_.max_radius;
        if (inside == e_.k) {
            r = std::sqrt(neighbours_.back().distance2);
            --inside;
        }
        const float known = std::min(place_rounding(rays_.scene(), hit_.p), e_.max_radius);
        if (e_.compensation) compensate(inside, r, known);
        if (inside < neighbours_.size() && r <= known) return radiance_within(known);
        if (inside == 0 || !(r > 0.f)) return {.radius = r};
        PhotonSums sums;
        const bool even = e_.kernel == Kernel::uniform;
        const double weight = kernel_weight(e_.kernel, 0.f, r);
        for (std::size_t i = 0; i < inside; ++i) {
            const Photon photon = map_[neighbours_[i].index];
            sums.add(photon,
                     reflected(photon) * (even ? weight : kernel_weight(e_.kernel, neighbours_[i].distance2, r)));
        }
        return normalised(sums, r);
    }

    bool counts(const Photon& photon, const Vec3& offset, float distance2) const {
        if (!eye_.accepts(photon)) return false;
        if (e_.area == DiscArea::plain) return true;
        return normal_agrees(photon) && sqr(offset.dot(normal_)) <= sqr(max_elevation_slope) * distance2;
    }

    /// Whether the normal at the photon agrees with the look-up's. The last answer is kept, because neighbouring
    /// photons mostly lie on one plane: this saves a tenth of a look-up's time.
    bool normal_agrees(const Photon& photon) const {
        if (photon.normal_code() != judged_normal_) {
            const float cosine = photon.surface_normal().dot(normal_);
            agrees_ = (transmits_ ? std::abs(cosine) : cosine) > min_normal_cosine;
            judged_normal_ = photon.normal_code();
        }
        return agrees_;
    }

    /// Finds the k nearest photons that count. Rays look for obstacles and layers only as far as the photons lie that
    /// were found without them, so a look-up without obstacles traces a few short rays. If something stands there,
    /// the search is repeated without the photons that it hides.
    void find_nearest() {
        bool any_off_plane = false;
        const auto near_plane = [&](const Photon& photon, float distance2) {
            const Vec3 offset = photon.p - hit_.p;
            if (!counts(photon, offset, distance2)) return false;
            any_off_plane |= disc_.off_plane(offset);
            return true;
        };
        find_k(near_plane);
        if (e_.area != DiscArea::surface || neighbours_.empty()) return;

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
        if (!hidden && is_flat_within(r)) return;
        if (!disc_.find_obstacles(rays_, r, e_.max_radius) && !hidden) return;
        near_obstacle_ = true;
        map_.nearest(
            hit_.p, e_.k, e_.max_radius,
            [this](const Photon& photon, float distance2) {
                const Vec3 offset = photon.p - hit_.p;
                return counts(photon, offset, distance2) && disc_.contains(offset);
            },
            neighbours_);
    }

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

    /// Whether nothing but the surface's plane lies as far from the centre as the rays of disc_ for this radius reach.
    bool is_flat_within(float r) {
        constexpr float reach = 1.1f;  // rays for obstacles are r / cos(pi / 8) long
        flat_ = e_.flat_regions && e_.flat_regions->flat_around(hit_, reach * r);
        return flat_;
    }

    /// The estimate from all photons within r.
    Reflected radiance_within(float r) {
        const bool on_surface = e_.area == DiscArea::surface;
        if (!(r > 0.f)) return {};
        if (on_surface && !is_flat_within(r)) {
            disc_.find_layers(rays_, max_elevation_slope * r);
            near_obstacle_ = disc_.find_obstacles(rays_, r, r);
        }
        PhotonSums sums, narrow;
        const float narrow_r = e_.estimates_bias ? narrow_radius * r : 0.f;
        map_.within(hit_.p, r, [&](const Photon& photon, float distance2) {
            const Vec3 offset = photon.p - hit_.p;
            if (!counts(photon, offset, distance2) || (on_surface && !disc_.contains(offset))) return;
            const Colord value = reflected(photon);
            sums.add(photon, value * kernel_weight(e_.kernel, distance2, r));
            if (distance2 < sqr(narrow_r)) narrow.add(photon, value * kernel_weight(e_.kernel, distance2, narrow_r));
        });
        Reflected L = normalised(sums, r);
        if (e_.estimates_bias) {
            const Reflected less = normalised(narrow, narrow_r);
            L.bias_between_surfaces = bias_of_difference * (L.between_surfaces - less.between_surfaces);
            L.bias_through_media = bias_of_difference * (L.through_media - less.through_media);
        }
        return L;
    }

    /// f times the power of one photon, its term of the sum without the kernel. Factors that all photons have in common
    /// are left to normalised().
    Colord reflected(const Photon& photon) const {
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

    /// The sums times the factors of all photons, over the share phi of the disc that lies on the surface.
    Reflected normalised(const PhotonSums& sums, float r) {
        Reflected L{.between_surfaces = (common_factor_ * sums.between_surfaces).cast<float>(),
                    .through_media = (common_factor_ * sums.through_media).cast<float>(),
                    .radius = r};
        if (e_.area == DiscArea::surface && !flat_ && !(is_black(L.between_surfaces) && is_black(L.through_media))) {
            const float share = disc_.share(e_.kernel, r) * disc_.covered(rays_, e_.kernel, r);
            L.between_surfaces /= share;
            L.through_media /= share;
        }
        return L;
    }

    /// Reduces `inside` and `r` to the largest disc whose estimate agrees with those of all smaller discs
    /// (bias_compensation.h). No disc has a radius below `least` [scene units].
    void compensate(std::size_t& inside, float& r, float least) {
        if (inside <= smallest_disc) return;
        std::sort(neighbours_.begin(), neighbours_.end());
        std::array<NestedDisc, most_discs> discs;
        std::array<float, most_discs> radii;
        std::size_t n = 0;
        NestedDisc disc{};
        const auto close = [&](float reach) {
            const float radius = std::max(reach, least);
            disc.area = double{disc_.share(Kernel::uniform, radius)} * double{radius} * double{radius};
            discs[n] = disc;
            radii[n++] = radius;
        };
        // The rim of a disc of n photons passes through the next photon, as that of the whole disc does.
        for (std::size_t end = smallest_disc; end < inside; end = next_disc(end)) {
            add(disc, end);
            close(std::sqrt(neighbours_[end].distance2));
        }
        add(disc, inside);
        close(r);
        const std::size_t chosen = largest_agreeing_disc(std::span(discs).first(n));
        inside = discs[chosen].photons;
        r = radii[chosen];
    }

    void add(NestedDisc& disc, std::size_t end) const {
        for (; disc.photons < end; ++disc.photons) {
            const double weight = (common_factor_ * reflected(map_[neighbours_[disc.photons].index])).sum();
            disc.weight += weight;
            disc.squared_weight += weight * weight;
        }
    }

    const DensityEstimator& e_;
    const PhotonMap& map_;
    RayQueries& rays_;
    const SurfaceHit& hit_;
    Vec3 normal_;
    Vec3 wo_local_;
    const EyePath& eye_;
    bool transmits_;           ///< the material scatters light from behind, too
    bool has_same_f_ = false;  ///< f does not depend on the photon's direction
    Colord common_factor_;     ///< the unit of power [W], times f [1/sr] if all photons have the same
    mutable std::uint32_t judged_normal_ = 0xffffffffu;  ///< normal code of the photon judged last; none at first
    mutable bool agrees_ = false;                        ///< the answer for that code
    bool near_obstacle_ = false;
    bool flat_ = false;  ///< the whole disc lies on the surface, with nothing near it
    SurfaceDisc disc_;
    std::vector<Neighbour>& neighbours_;
    LastLookUp* last_;
};

/// The memory of a thread's look-ups, which none of them has to take for itself.
std::vector<Neighbour>& neighbours_of_thread() {
    static thread_local std::vector<Neighbour> neighbours;
    return neighbours;
}

}  // namespace

Vec3 lifted_above_horizon(const Vec3& wo_local, Vec3 wi_local) {
    constexpr float horizon = 1e-4f;
    if (wi_local.z() * wo_local.z() <= 0.f) wi_local.z() = std::copysign(horizon, wo_local.z());
    return wi_local;
}

float shading_normal_factor(const SurfaceHit& hit, const Vec3& wi) {
    if (hit.ns == hit.ng) return 1.f;
    const float towards = std::abs(wi.dot(hit.ns));
    const float of_surface = std::max(std::abs(wi.dot(hit.ng)), 0.01f * towards);
    return of_surface > 0.f ? towards / of_surface : 1.f;
}

Reflected DensityEstimator::reflected_radiance(const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit,
                                               const Vec3& wo, const EyePath& eye, const Sampler& sampler,
                                               std::uint32_t dimension, LastLookUp* last) const {
    return LookUp(*this, map, rays, hit, wo, eye, sampler.get_2d(dimension), neighbours_of_thread(), last).radiance();
}

}  // namespace gib
