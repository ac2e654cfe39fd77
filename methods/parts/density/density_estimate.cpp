#include "methods/parts/density/density_estimate.h"

#include "methods/parts/density/bias_compensation.h"
#include "methods/parts/density/photon_search.h"

#include <algorithm>

namespace gib {

namespace {

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
        if (e_.compensation) compensate(neighbours, inside, r, unresolved);
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
    /// radius is given, the difference to the estimate from it tells the bias.
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

    /// Reduces `inside` and `r` to the largest disc whose estimate agrees with those of all smaller discs
    /// (bias_compensation.h). No disc has a radius below `least` [scene units].
    void compensate(std::vector<Neighbour>& neighbours, std::size_t& inside, float& r, float least) const {
        if (inside <= smallest_disc) return;
        std::sort(neighbours.begin(), neighbours.end());
        std::array<NestedDisc, most_discs> discs;
        std::array<float, most_discs> radii;
        std::size_t n = 0;
        NestedDisc disc{};
        const auto add_disc = [&](std::size_t photons, float rim) {
            for (; disc.photons < photons; ++disc.photons) {
                const double weight = (f_phi_.common() * f_phi_(search_.map()[neighbours[disc.photons].index])).sum();
                disc.weight += weight;
                disc.squared_weight += weight * weight;
            }
            radii[n] = std::max(rim, least);
            disc.area = search_.free_area(radii[n]);
            discs[n++] = disc;
        };
        // The rim of a disc of n photons passes through the next photon, as that of the whole disc does.
        for (std::size_t photons = smallest_disc; photons < inside; photons = next_disc(photons))
            add_disc(photons, std::sqrt(neighbours[photons].distance2));
        add_disc(inside, r);
        const std::size_t chosen = largest_agreeing_disc(std::span(discs).first(n));
        inside = discs[chosen].photons;
        r = radii[chosen];
    }

    const DensityEstimator& e_;
    PhotonSearch& search_;
    const ReflectedPower& f_phi_;
};

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
    PhotonSearch search(*this, map, rays, hit, wo, eye, sampler.get_2d(dimension), last);
    const ReflectedPower f_phi(hit, wo, eye, map.unit());
    const Estimate estimate(*this, search, f_phi);
    Reflected light = k == all_photons ? estimate.from_all_within(max_radius * by_place.share(rays, hit, wo))
                                       : estimate.from_nearest();
    light.near_obstacle = search.near_obstacle();
    return light;
}

}  // namespace gib
