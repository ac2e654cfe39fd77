#pragma once
// Reflected radiance from the density of photons around a point.
//
// The estimate is the sum over photons of f(wo, wi) power K(d) / phi, with a kernel K that integrates to 1 over the
// disc of radius r around the point and the share phi of the disc (weighted by K) that lies on the surface. Source:
// Jensen 2001, chapter 7, corrected:
//  - with k photons found, r is the distance of the k-th and only the k - 1 inside count: pi r_k^2 lambda is a Gamma(k)
//    variable, so (k - 1) / (pi r_k^2) is unbiased where k / (pi r_k^2) is too bright by k / (k - 1);
//  - with fewer than k inside the maximum radius, or with all photons asked for, all of them count and r is the maximum
//    radius;
//  - where the k-th lies closer than rounding knows the place, at a focus, all photons within that distance count and r
//    is that distance: the density has no bound there, its estimate has, and their power is kept;
//  - every kernel is divided by its own integral;
//  - photons that do not lie on the point's surface do not count, and where the disc leaves the surface (edges,
//    corners, thin walls, other layers) the area is that of the part that is on it: methods/parts/density/surface_disc.h.
//
// Two bounds, and what they cost:
//  - a photon from below the look-up's horizon (on a curved surface) is taken to come from just above it. An ideal
//    diffuse lobe is the same from everywhere, so that costs nothing; one whose reflectance falls to 0 at the horizon
//    (plastic) loses what it would lose by dropping the photon, the share of the light within the angle by which the
//    normals differ.
//  - the ratio |wi.ns| / |wi.ng| of interpolated to geometric normals is cut off at 100: without a bound the variance
//    has none either. In even light, with the angle delta between the normals, that loses sin^2(delta) / 200 of the
//    irradiance to second order: 0.015 % at 10 degrees, 0.25 % at 45 degrees (test).

#include "common/sampling/sampler.h"
#include "methods/parts/density/kernel.h"
#include "methods/parts/photons/photon_join.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/transport/ray_queries.h"

#include <limits>

namespace gib {

enum class DiscArea {
    surface,   ///< photons on the point's surface, over the part of the disc that lies on it
    rejected,  ///< photons whose normals agree, close to the tangent plane; over pi r^2
    plain      ///< every photon in the ball, over pi r^2: the estimate of the textbooks, kept to be measured
};
inline constexpr std::array<std::string_view, 3> disc_area_names = {"surface", "rejected", "plain"};

/// k that stands for all photons within the maximum radius.
inline constexpr std::size_t all_photons = std::numeric_limits<std::size_t>::max();

/// Radiance [W/(sr m^2)] by the photons' paths: those between surfaces alone, and those that a medium scattered.
struct Reflected {
    Color between_surfaces = Color::Zero(), through_media = Color::Zero();
    float radius = 0.f;  ///< of the disc that was looked at [scene units]
    bool near_obstacle =
        false;  ///< with DiscArea::surface: something stands on the disc, or another surface lies close to it
};

struct DensityEstimator {
    Kernel kernel;
    std::size_t k;
    float max_radius;  ///< [scene units]
    DiscArea area;
    bool compensation =
        false;  ///< at most k photons, as many as agree: methods/parts/density/bias_compensation.h; not with all_photons

    /// Scratch memory, at most 2 k + 16 neighbours; kept between look-ups.
    using Neighbours = std::vector<PhotonMap::Neighbour>;

    /// Radiance [W/(sr m^2)] that the photons around `hit` which `eye` accepts add towards wo. `dimension` of the
    /// sampler decides where the disc is probed.
    Reflected reflected_radiance(const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit, const Vec3& wo,
                                 const EyePath& eye, const Sampler& sampler, std::uint32_t dimension,
                                 Neighbours& neighbours) const;
};

/// |wi.ns| / |wi.ng|, at most 100: the density of photons is irradiance on the geometric surface, |wi.ng|; what an
/// interpolated normal reflects is |wi.ns|.
float shading_normal_factor(const SurfaceHit& hit, const Vec3& wi);

}  // namespace gib
