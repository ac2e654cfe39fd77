#pragma once
// Reflected radiance from the density of photons around a point.
//
// The estimate is the sum over photons of f(wo, wi) power K(d) / phi. The kernel K integrates to 1 over the disc of
// radius r around the point, and phi is the share of the disc (weighted by K) that lies on the surface. Source:
// Jensen 2001, chapter 7, with these corrections:
//  - if k photons are found, r is the distance of the k-th, and only the k - 1 photons inside count: with lambda
//    photons per area pi r_k^2 lambda is a Gamma(k) variable, so (k - 1) / (pi r_k^2) is an unbiased estimate of
//    lambda, whereas k / (pi r_k^2) is too large by the factor k / (k - 1);
//  - if fewer than k photons lie inside the maximum radius, or if all photons are asked for, all of them count and r
//    is the maximum radius;
//  - at a focus the k-th photon may be closer than the rounding error of positions. All photons within that
//    error then count, and r is that error: the true density is unbounded there, the estimate is bounded and
//    keeps their power;
//  - every kernel is divided by its own integral;
//  - photons that do not lie on the point's surface do not count, and where the disc leaves the surface (edges,
//    corners, thin walls, other layers) only the area of the part on it counts: methods/parts/density/surface_disc.h.
//
// Two approximations and their cost:
//  - a photon that comes from below the look-up's horizon (on a curved surface) is treated as if it came from just
//    above the horizon. The f of an ideal diffuse lobe is the same for all directions, so nothing is lost. A lobe
//    whose reflectance falls to 0 at the horizon (plastic) loses as much as if the photon were dropped: the share of
//    the light within the angle between the two normals.
//  - the ratio |wi.ns| / |wi.ng| of the cosines at the interpolated and at the geometric normal is limited to
//    100, because its variance is infinite without a limit. In even light, with the angle delta between the
//    normals, the limit loses sin^2(delta) / 200 of the irradiance to second order: 0.015 % at 10 degrees, 0.25 %
//    at 45 degrees (tested).

#include "common/sampling/sampler.h"
#include "common/scene/scene.h"
#include "methods/parts/density/flat_regions.h"
#include "methods/parts/density/kernel.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/transport/ray_queries.h"

#include <limits>
#include <numbers>

namespace gib {

enum class DiscArea {
    surface,   ///< photons on the point's surface, over the part of the disc that lies on it
    rejected,  ///< photons near the tangent plane whose normals agree, over pi r^2
    plain      ///< every photon in the ball, over pi r^2: the estimate of the textbooks, kept for comparison
};
inline constexpr std::array<std::string_view, 3> disc_area_names = {"surface", "rejected", "plain"};

/// The value of k that selects all photons within the maximum radius.
inline constexpr std::size_t all_photons = std::numeric_limits<std::size_t>::max();

/// Reflected radiance [W/(sr m^2)], kept apart by the photons' paths: between surfaces only, or scattered
/// by a medium.
struct Reflected {
    Color between_surfaces = Color::Zero(), through_media = Color::Zero();
    /// Estimates of their bias, if the estimator is asked for them.
    Color bias_between_surfaces = Color::Zero(), bias_through_media = Color::Zero();
    float radius = 0.f;  ///< radius of the disc [scene units]
    /// With DiscArea::surface: something stands on the disc, or another surface lies close to it.
    bool near_obstacle = false;
};

/// The last of a sequence of look-ups in one map, with the same k, that mostly follow each other closely in space. It makes
/// the next one faster. The photons found do not depend on it, but the order in which they are added does. A sequence
/// therefore has to belong to one block of work, so that rounding is the same for any number of threads.
struct LastLookUp {
    Vec3 p = Vec3::Zero();
    float radius = std::numeric_limits<float>::infinity();  ///< radius that held k photons; infinite: none is known
};

struct DensityEstimator {
    Kernel kernel;
    std::size_t k;
    float max_radius;  ///< [scene units]
    DiscArea area;
    bool estimates_bias = false;  ///< only with all_photons
    /// With all_photons, the radius from which place_radius.h finds the share of `max_radius` that suits the place; 0:
    /// all of it.
    float largest_by_place = 0.f;
    const FlatRegions* flat = nullptr;  ///< spare look-ups rays; null: rays are always traced

    /// Radiance [W/(sr m^2)] reflected at `hit` towards wo, estimated from the photons around it that `eye` accepts.
    /// The sampler's numbers of `dimension` place the rays that probe the disc. `last` may be null.
    Reflected reflected_radiance(const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit, const Vec3& wo,
                                 const EyePath& eye, const Sampler& sampler, std::uint32_t dimension,
                                 LastLookUp* last = nullptr) const;
    /// Whether there is nothing but the surface's plane as far from the centre as the rays for a disc of radius r
    /// reach.
    bool is_flat_within(const SurfaceHit& hit, float r) const {
        constexpr float reach = 1.1f;  // rays for obstacles are r / cos(pi / 8) long
        return flat && flat->flat_around(hit, reach * r);
    }
};

/// Bound of the rounding error of the position p in any direction [scene units]: p is a sum of numbers as large
/// as the scene. (SurfacePoint::offset is smaller on planes along the axes, because it bounds only the error
/// along the normal.)
inline float place_rounding(const Scene& scene, const Vec3& p) {
    return 4.f * unit_roundoff * (p.cwiseAbs().maxCoeff() + scene.diagonal());
}

}  // namespace gib
