#pragma once
// The part of a look-up's disc that belongs to the surface around its centre, for density estimates at corners,
// edges, thin walls and close layers.
//
// S is the part of the disc that can be reached from the centre along the surface. The disc is split into n sectors,
// and a ray runs close above the tangent plane along each side of a sector. The sector ends at cos(pi / n) times the
// smaller of the two distances to the first obstacle. This factor keeps every part of S in front of a straight wall
// across the disc, however thin the wall: in a sector the distance to a straight line is never below cos(pi / n)
// times the smaller of the distances along its sides. Photons outside S do not count, and the area is that of S.
// Both use the same n distances, so the estimate for evenly spread photons is unbiased for any S, and its area is
// exact, without noise.
//
// Where the surface ends (the outer edge of a box or of a sheet) there are no photons, and only the area must shrink:
// rays down to the disc estimate the share q of S that is covered by surface. The estimate from m stratified rays
// enters as 1 / q, which is too large by var(q) / q^2, below 1 % on straight edges (tested).
//
// Two rays along the normal find a second layer of surface within reach above or below (a double floor, a thin slab).
// Photons nearer to that layer than to the tangent plane do not count.
//
// Not handled: posts that stand between the rays; a wall that ends inside the disc, which hides what is behind it by
// whole sectors; an overhang that starts beside the centre's normal, which is not found as a layer.

#include "common/sampling/sampler.h"
#include "methods/parts/density/kernel.h"
#include "methods/parts/transport/ray_queries.h"

#include <array>

namespace gib {

/// A photon or a point counts as lying on the surface of a look-up if its normal agrees with the look-up's within 60
/// degrees and if it is seen from the centre within 30 degrees of the tangent plane. On a smooth surface both hold
/// for radii up to its radius of curvature.
inline constexpr float min_normal_cosine = 0.5f;
inline constexpr float max_elevation_slope = 0.5f;

/// Whether light at a point that a probe has found counts at `centre`, whose normal is `normal`: the surface there faces the
/// same way and has lobes of the centre's kind.
bool belongs_to(const SurfaceHit& found, const SurfaceHit& centre, const Vec3& normal);

/// An unbiased estimate of 1 / phi, where phi is the share of the kernel's ball of radius r around p that no surface
/// hides from p. Independent points of the ball are probed until m of them are visible, and the estimate is the number
/// of probes over m. That number is a negative binomial variable of mean m / phi; the reciprocal of a share found by n
/// probes would be too large by (1 - phi) / (n phi), which is 12 % where half of the ball is hidden and n = 8.
float reciprocal_share_in_sight(Kernel kernel, RayQueries& rays, const Vec3& p, float r, NumberStream& u);

class SurfaceDisc {
public:
    /// The disc around `hit` on the side of `normal`. The random numbers `u` turn the rays and place the probes.
    SurfaceDisc(const SurfaceHit& hit, const Vec3& normal, const Vec2& u);

    /// Looks for other layers within `reach` above and below the centre. True if there are any.
    bool find_layers(RayQueries& rays, float reach);
    /// Looks for obstacles within `r` in a few directions; if there are any, looks again in more directions up to
    /// `max_radius`. True if there are any.
    bool find_obstacles(RayQueries& rays, float r, float max_radius);

    /// Whether the point at `offset` from the centre [scene units] lies in S and in this layer. It must be seen from
    /// the centre at less than the largest slope.
    bool contains(const Vec3& offset) const { return in_layer(offset) && inside(offset); }
    bool in_layer(const Vec3& offset) const {
        const float height = offset.dot(frame_.n);
        return height > -below_ && height < above_;
    }
    /// Whether a point is farther from the tangent plane than rounding explains, so that it may lie on another layer.
    bool off_plane(const Vec3& offset) const { return std::abs(offset.dot(frame_.n)) > rounding_; }

    /// The kernel's integral over the part of S within r, in [0, 1]; 0 only if an obstacle lies at the centre itself.
    float share(Kernel kernel, float r) const;
    /// The fraction of share() that is covered by surface, estimated by rays, in (0, 1].
    float covered(RayQueries& rays, Kernel kernel, float r) const;

private:
    static constexpr int few = Accelerator::packet_size, many = 32;
    /// Number of radii at which the disc is probed in each of `many` directions, if its surface may end within it.
    static constexpr int strata = 2;

    /// Whether the point lies in S.
    bool inside(const Vec3& offset) const;
    /// Traces the rays for obstacles and finds where the sectors end. False if nothing stands within r
    /// in any direction.
    bool look_around(RayQueries& rays, float r, int directions);
    /// The distance at which a ray of the largest slope in this direction meets something; infinite if it
    /// meets nothing. A surface that rises and closes above the centre, as a dome does, hides what lies
    /// behind that distance.
    float end_of_rise(RayQueries& rays, const Vec3& direction, float reach) const;
    /// The ray down to where the surface may lie at `distance` from the centre.
    Ray probe(const Vec3& direction, float distance) const;
    bool is_covered(RayQueries& rays, const Vec3& direction, float distance, float rise) const;
    Vec3 direction(float turns) const;

    const SurfaceHit& hit_;
    Frame frame_;
    Vec3 origin_;
    Vec2 u_;
    float rounding_;
    float below_ = infinity, above_ = infinity;  ///< half the distances to the next layers
    int directions_ = 0;
    std::array<float, many> free_;    ///< by direction: the distance at which S ends
    std::array<float, many> rise_;    ///< by direction: the distance at which the surface itself rises above the rays
    std::array<float, many> sector_;  ///< by sector, between a direction and the next: the distance at which S ends
    float shortest_ = infinity, longest_ = infinity;  ///< least and greatest of these distances
};

}  // namespace gib
