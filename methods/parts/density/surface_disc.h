#pragma once
// The part of a look-up's disc that belongs to the surface around its centre, for density estimates at corners, edges,
// thin walls and close layers.
//
// S, the part, is what can be reached from the centre along the surface: the disc is split into n sectors, and each
// ends at the first obstacle that a ray close above the tangent plane meets along either of its sides, times cos(pi /
// n). So no part of S lies behind a straight wall as long as the disc, however thin the wall: the distance to a
// straight line is never below cos(pi / n) times the smaller of the distances along the sides of a sector. Photons
// outside S do not count, and the area is that of S: both follow the same n distances, so evenly spread photons are
// estimated without bias whatever S is, and its area is exact, without noise.
//
// Where the surface ends (the outer edge of a box, of a sheet), no photons lie, and only the area must shrink: rays
// down to the disc find the covered share of S. Its estimate q from m stratified rays enters as 1 / q, which is too
// bright by var(q) / q^2, below 1 % on straight edges (test).
//
// A second layer of surface within reach above or below (a double floor, a thin slab) is found by two rays along the
// normal; photons nearer to it than to the tangent plane do not count.
//
// Left: posts that pass between the rays; a wall that ends inside the disc hides what is behind it by sectors, not
// exactly; an overhang that starts beside the centre's normal is no layer.

#include "common/sampling/sampler.h"
#include "methods/parts/density/kernel.h"
#include "methods/parts/transport/ray_queries.h"

#include <array>

namespace gib {

/// A photon or a point lies on the surface of a look-up if their normals agree within 60 degrees and it is seen within
/// 30 degrees off the tangent plane: on a smooth surface both hold for radii up to its radius of curvature.
inline constexpr float min_normal_cosine = 0.5f;
inline constexpr float max_elevation_slope = 0.5f;

/// The geometric normal on wo's side.
inline Vec3 normal_towards(const SurfacePoint& s, const Vec3& wo) { return wo.dot(s.ng) >= 0.f ? s.ng : Vec3(-s.ng); }

class SurfaceDisc {
public:
    /// Around `hit`, on the side of `normal`; `u` turns the rays and places the probes.
    SurfaceDisc(const SurfaceHit& hit, const Vec3& normal, const Vec2& u);

    /// Looks for other layers within `reach` above and below the centre.
    void find_layers(RayQueries& rays, float reach);
    /// Looks for obstacles within `r` in a few directions; if there are any, looks again in more directions up to
    /// `max_radius`. True if there are any.
    bool find_obstacles(RayQueries& rays, float r, float max_radius);

    /// Whether a point so far from the centre, seen at less than the slope, lies in S and in this layer.
    bool contains(const Vec3& offset) const { return in_layer(offset) && inside(offset); }
    bool in_layer(const Vec3& offset) const {
        const float height = offset.dot(frame_.n);
        return height > -below_ && height < above_;
    }
    /// Farther off the tangent plane than rounding explains, so that it may lie on another layer.
    bool off_plane(const Vec3& offset) const { return std::abs(offset.dot(frame_.n)) > rounding_; }

    /// The kernel's integral over the part of S within r, in (0, 1].
    float share(Kernel kernel, float r) const;
    /// The part of that share where there is a surface, as a fraction, in (0, 1].
    float covered(RayQueries& rays, Kernel kernel, float r) const;

private:
    static constexpr int few = Accelerator::packet_size, many = 32;
    /// Radii at which the disc is probed along each of the many directions where its surface may end.
    static constexpr int strata = 2;

    bool inside(const Vec3& offset) const;
    /// False if nothing stands within r in any direction.
    bool look_around(RayQueries& rays, float r, int directions);
    /// How far a surface that rises in this direction goes on below the largest slope: what closes above the centre, as
    /// a dome does, hides what lies behind it.
    float end_of_rise(RayQueries& rays, const Vec3& direction, float reach) const;
    /// Down to where the surface may be, so far from the centre.
    Ray probe(const Vec3& direction, float distance) const;
    bool is_covered(RayQueries& rays, const Vec3& direction, float distance, float rise) const;
    Vec3 direction(float turns) const;

    const SurfaceHit& hit_;
    Frame frame_;
    Vec3 origin_;
    Vec2 u_;
    float rounding_;
    float below_ = infinity, above_ = infinity;  ///< half the way to the next layers
    int directions_ = 0;
    std::array<float, many> free_;    ///< by direction: S ends here
    std::array<float, many> rise_;    ///< by direction: the surface itself rises through the tangent plane here
    std::array<float, many> sector_;  ///< the end of S between a direction and the next
};

}  // namespace gib
