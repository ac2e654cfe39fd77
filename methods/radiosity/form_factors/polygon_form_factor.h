#pragma once
// Form factors of polygons without obstacles: the share of the light that leaves one diffuse surface evenly and
// arrives at another (Goral et al. 1984). Geometry is in double; nothing here knows a scene or visibility.
//
// Notation: the kernel between x on a polygon with the unit normal n and y on one with the normal m, r = y - x, is
// k(x, y) = (n . r) (-m . r) / (pi |r|^4) where both factors are positive, else 0.

#include "common/core/math.h"

#include <array>
#include <span>

namespace gib {

/// A convex planar polygon of 3 or 4 vertices, counter-clockwise seen from its front side.
struct PatchPolygon {
    std::array<Vec3d, 4> vertices;  ///< the first `count` are set [scene units]
    int count = 0;
    Vec3d normal;     ///< unit, on the front side
    double area = 0;  ///< [scene units^2]

    /// Throws InputError without a positive, finite area.
    static PatchPolygon triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
    /// The vertices must form a convex quadrilateral, in one plane up to rounding; two neighbours may be in the same
    /// place. `normal` and `area` are those of its projection along the cross product of its diagonals. Throws
    /// InputError without a positive, finite area.
    static PatchPolygon quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

    std::span<const Vec3d> corners() const { return {vertices.data(), static_cast<std::size_t>(count)}; }
    /// The same polygon with its back as its front: its vertices are in the opposite order.
    PatchPolygon flipped() const;
};

/// The form factor from a point, in [0, 1]: the integral of k(point, y) over the polygon, which is the share of the
/// light that leaves a differential area at `point` with the unit `normal` and arrives at the polygon's front. Closed
/// form: the polygon is clipped at the horizon of the point; then each edge adds the angle that it subtends times the
/// normalised cross product of the rays to its ends, and the factor is the sum's component along the normal over 2 pi
/// (Lambert 1760; Baum, Rushmeier and Winget 1989). The factor is 0 for points behind the polygon's front and in its
/// plane, which includes its edges.
double point_form_factor(const Vec3d& point, const Vec3d& normal, const PatchPolygon& polygon);

/// F_ij from i = `from` to j = `to`: the mean of point_form_factor over `from`; 0 for polygons in one plane. Distant polygons take a few
/// points on the smaller one, near ones an integral around both contours. The error is below 1e-4 of the factor.
double polygon_form_factor(const PatchPolygon& from, const PatchPolygon& to);

}  // namespace gib
