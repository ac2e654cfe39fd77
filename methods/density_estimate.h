#pragma once
// Reflected radiance from the density of photons around a point.
//
// The estimate is the sum over photons of f(wo, wi) power K(d) / phi, with a kernel K that integrates to 1 over the
// disc of radius r around the point and the share phi of the disc (weighted by K) that lies on the surface. Source:
// Jensen 2001, chapter 7, corrected:
//  - with k photons found, r is the distance of the k-th and only the k - 1 inside count: pi r_k^2 lambda is a Gamma(k)
//    variable, so (k - 1) / (pi r_k^2) is unbiased where k / (pi r_k^2) is too bright by k / (k - 1);
//  - with fewer than k inside the maximum radius, all of them count and r is the maximum radius;
//  - every kernel is divided by its own integral;
//  - where the disc leaves the surface (edges, corners, thin walls) the area is that of the part that is on it.

#include "common/sampler.h"
#include "methods/photon_join.h"
#include "methods/photon_map.h"
#include "methods/ray_queries.h"

#include <array>
#include <string_view>

namespace gib {

enum class Kernel { uniform, cone, gaussian, epanechnikov };
inline constexpr std::array<std::string_view, 4> kernel_names = {"uniform", "cone", "gaussian", "epanechnikov"};

/// Width of the Gaussian kernel in units of the radius at which it is cut off; exp(-r^2 / (2 sigma^2)) = exp(-2) there.
inline constexpr float gaussian_sigma = 0.5f;

/// K(d) [1/area] for d^2 = `d2` <= r^2; integrates to 1 over the disc of radius r.
float kernel_weight(Kernel kernel, float d2, float r);
/// The distance, as a fraction of r, below which the share `u` of the kernel's integral lies.
float kernel_radius(Kernel kernel, float u);

enum class DiscArea {
    plain,   ///< pi r^2 everywhere
    surface  ///< the part of the disc that lies on the surface, found by rays
};

/// Radiance [W/(sr m^2)] by the photons' paths: those between surfaces alone, and those that a medium scattered.
struct Reflected {
    Color between_surfaces = Color::Zero(), through_media = Color::Zero();
};

struct DensityEstimator {
    Kernel kernel;
    std::size_t k;
    float max_radius;  ///< [scene units]
    DiscArea area;

    /// Radiance [W/(sr m^2)] that the photons around `hit` which `eye` accepts add towards wo. `dimension` of the sampler decides
    /// where the disc is probed. `found` is scratch memory.
    Reflected reflected_radiance(const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit, const Vec3& wo,
                                 const EyePath& eye, const Sampler& sampler, std::uint32_t dimension,
                                 std::vector<PhotonMap::Neighbour>& found) const;

    /// The share of the kernel's disc of radius r around `hit` (seen from wo's side) that lies on the surface, in (0,
    /// 1].
    float share_on_surface(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo, float r, const Vec2& u) const;
};

}  // namespace gib
