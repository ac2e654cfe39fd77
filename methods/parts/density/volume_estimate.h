#pragma once
// Radiance scattered in a medium, from the density of photons around a point.
//
// The source of scattered light, integral of p(wo, wi) L(wi) over wi [W/(sr m^2)], is estimated by the sum over
// photons of p(wo, wi) F K(d) / phi. F is the value that the photon walk stored (its sum over a volume is the
// integral of fluence), K is a kernel that integrates to 1 over the ball of radius r, and phi is the share of the
// ball (weighted by K) that no surface hides from its centre. Each eye path samples one free flight and places one
// ball at its end; the estimate is multiplied by the flight's weight, which contains sigma_s T / pdf. Source: Jensen
// and Christensen 1998, "Efficient Simulation of Light Transport in Scenes with Participating Media using Photon
// Maps", equation 12; corrected as on surfaces:
//  - if k photons are found, r is the distance of the k-th, and only the k - 1 photons inside count: 4/3 pi r_k^3
//    lambda is a Gamma(k) variable;
//  - if fewer than k photons lie inside the maximum radius, all of them count and r is the maximum radius;
//  - if the k-th photon is closer than the rounding error of positions, all photons within that error count and r
//    is that error;
//  - r is at most the mean free path at p. In a dense medium light enters only a layer of a few mean free paths. A ball
//    larger than the layer is mostly dark, so the estimate would divide the layer's photons by too large a volume.

#include "common/media/phase.h"
#include "common/sampling/sampler.h"
#include "methods/parts/density/density_estimate.h"

namespace gib {

/// Radiance scattered per unit of the scattering coefficient [W/(sr m^2)].
struct Scattered {
    Color radiance = Color::Zero();
    Color bias = Color::Zero();  ///< an estimate of its bias, if the estimator is asked for it
};

struct VolumeEstimator {
    Kernel kernel;
    std::size_t k;                ///< or all_photons
    float max_radius;             ///< [scene units]
    DiscArea area;                ///< `surface`: only the part of the ball counts that no surface hides from p
    bool estimates_bias = false;  ///< only with all_photons

    /// The estimator at a point of a medium with this mean free path [scene units].
    VolumeEstimator within(float mean_free_path) const {
        VolumeEstimator limited = *this;
        limited.max_radius = std::min(max_radius, largest_mean_free_paths * mean_free_path);
        return limited;
    }
    /// The largest radius of a look-up, in mean free paths.
    static constexpr float largest_mean_free_paths = 1.f;

    /// The light scattered at p towards wo, estimated from the photons around p. `phase` is the phase function of the
    /// medium at p.
    Scattered scattered_radiance(const PhotonMap& map, RayQueries& rays, const Vec3& p, const PhaseFunction& phase,
                                 const Vec3& wo, const EyePath& eye, NumberStream& u) const;
};

}  // namespace gib
