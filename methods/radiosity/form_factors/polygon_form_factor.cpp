#include "methods/radiosity/form_factors/polygon_form_factor.h"

#include "common/core/error.h"
#include "methods/radiosity/form_factors/closest_approach.h"
#include "methods/radiosity/form_factors/convex_region.h"
#include "methods/radiosity/form_factors/polygon_contour.h"
#include "methods/radiosity/form_factors/quadrature_rules.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace gib {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

PatchPolygon polygon_of(std::array<Vec3d, 4> vertices, int count, const Vec3d& doubled_area) {
    const double length = doubled_area.stableNorm();
    if (!(length > 0) || !std::isfinite(length)) throw InputError("a polygon without a positive, finite area");
    return {.vertices = std::move(vertices), .count = count, .normal = doubled_area / length, .area = 0.5 * length};
}

/// A bound of the second derivative of n . r |r|^-4 in any direction, times |r|^5: 2 * 4 from the product of the
/// first derivatives, 20 from the second derivative of |r|^-4.
constexpr double curvature_bound = 28;

/// The kernel at the polygon's centroid times its area, which is exact for a kernel that is linear in y, with a bound
/// of the error. The factor -m . r of the kernel is the point's height over the polygon's plane and the same for all
/// y, so only (n . r) / |r|^4 departs from a linear function.
struct CentroidEstimate {
    double value = 0, error = 0;

    CentroidEstimate(std::span<const Vec3d> rays, const Vec3d& normal, double height) {
        double area = 0;
        Vec3d moment = Vec3d::Zero();
        for (std::size_t i = 2; i < rays.size(); ++i) {
            const double part = 0.5 * (rays[i - 1] - rays[0]).cross(rays[i] - rays[0]).norm();
            area += part;
            moment += part / 3 * (rays[0] + rays[i - 1] + rays[i]);
        }
        error = std::numeric_limits<double>::infinity();
        if (!(area > 0)) return;
        const Vec3d center = moment / area;
        double radius = 0;
        for (const Vec3d& ray : rays)
            radius = std::max(radius, (ray - center).norm());
        const double nearest = center.norm() - radius;
        if (!(nearest > 0)) return;
        value = area * height * normal.dot(center) / (std::numbers::pi * sqr(center.squaredNorm()));
        error = 0.5 * curvature_bound * area * height * sqr(radius) / (std::numbers::pi * sqr(sqr(nearest)) * nearest);
    }
};

/// point_form_factor of a polygon that lies wholly above the horizon. `rays` lead from the point to the polygon's
/// vertices, and `height` is the point's height over the polygon's plane.
double visible_form_factor(std::span<const Vec3d> rays, const Vec3d& normal, double height) {
    double sum = 0, magnitude = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Vec3d& a = rays[i];
        const Vec3d& b = rays[i + 1 == rays.size() ? 0 : i + 1];
        // Equal to b x a, which would cancel where the edge is short.
        const Vec3d cross = (b - a).cross(a);
        const double sine = cross.norm();
        if (sine == 0) continue;
        const double term = normal.dot(cross) * (std::atan2(sine, a.dot(b)) / sine);
        sum += term;
        magnitude += std::abs(term);
    }
    const double share = sum / (2 * std::numbers::pi);
    // If the polygon is far away or seen from the side, the sum is much smaller than its terms; only then the
    // centroid estimate can be better.
    constexpr double cancelled = 1e-4;
    if (std::abs(sum) < cancelled * magnitude) {
        const double error = 4 * epsilon * magnitude / std::numbers::pi;
        const CentroidEstimate estimate(rays, normal, height);
        if (estimate.error < error) return std::max(estimate.value, 0.0);
    }
    return std::clamp(share, 0.0, 1.0);  // removes rounding
}

RoundedPlane plane_of(const PatchPolygon& polygon, double rounding) {
    const auto corners = polygon.corners();
    double squared = 0;
    for (const Vec3d& vertex : corners)
        squared = std::max(squared, (vertex - corners[0]).squaredNorm());
    const double width = polygon.area / std::sqrt(squared);
    return {.origin = corners[0], .normal = polygon.normal, .offset = rounding, .slope = rounding / width};
}

/// The part of a polygon in front of the other polygon. All of its points see all points of the other one's part, so
/// between these parts the kernel is smooth where they do not touch.
struct Side {
    ConvexRegion region;
    RoundedPlane plane;
    Vec3d center = Vec3d::Zero();
    double radius = 0;  ///< of the bounding sphere around `center`

    Side(const PatchPolygon& polygon, const RoundedPlane& own, const RoundedPlane& other)
        : region(front_part(polygon.corners(), other)), plane(own) {
        if (region.size() == 0) return;
        center = region.mean();
        radius = region.radius(center);
    }

    double area() const {
        Vec3d doubled = Vec3d::Zero();
        for (std::size_t i = 2; i < region.size(); ++i)
            doubled += (region[i - 1] - region[0]).cross(region[i] - region[0]);
        return 0.5 * doubled.norm();
    }
};

/// The distance from `small` to the points where the point form factor of `large` is not smooth, which are the edges
/// of `large`. Of an edge in the plane of `small` only the ends count, because the edge adds nothing but its angle.
double distance_to_edges(const Side& small, const Side& large) {
    double nearest = std::numeric_limits<double>::infinity();
    std::array<double, ConvexRegion::max_vertices> heights;
    for (std::size_t i = 0; i < large.region.size(); ++i)
        heights[i] = small.plane.height(large.region[i]);
    for (std::size_t i = 0; i < large.region.size(); ++i) {
        const Vec3d& vertex = large.region[i];
        const std::size_t next = i + 1 == large.region.size() ? 0 : i + 1;
        const bool in_plane = heights[i] == 0 && heights[next] == 0;
        const Vec3d& end = in_plane ? vertex : large.region[next];
        bool above = true;  // the vertex lies above the inside of `small`
        for (std::size_t k = 0; k < small.region.size(); ++k) {
            const Vec3d &a = small.region[k], &b = small.region.after(k);
            nearest = std::min(nearest, closest_approach(vertex, end, a, b).distance);
            above = above && small.plane.normal.dot((b - a).cross(vertex - a)) >= 0;
        }
        if (above) nearest = std::min(nearest, std::abs(heights[i]));
    }
    return nearest;
}

/// A quadrilateral, or a triangle whose last vertex is its first.
using Corners = std::array<Vec3d, 4>;

/// Number of nodes that Gauss's rule needs along a segment for a relative error of point_form_factor's mean below
/// `tolerance`, or max_gauss_nodes + 1 if it needs more than max_gauss_nodes.
///
/// Each edge's angle over its sine is the integral of |r|^-2 along the edge. It is analytic in the complex coordinate
/// x along the segment where |r|^2 != 0, which holds where |Im x| is below the distance of Re x from the edge. With d
/// = distance / half_length and ellipses around [-1, 1] of the semi-axes sqrt(1 + B^2) and B, this holds for B <= d
/// and sqrt(1 + 2 B^2) <= 1 + d. The error of the rule of n nodes is then about M rho^(-2 n), rho = B + sqrt(1 + B^2)
/// (Trefethen 2008, theorem 4.5). M grows like rho^2 because the height over the other plane and the Jacobian are
/// linear, so one node is added.
std::size_t nodes_along(double half_length, double distance, double tolerance) {
    constexpr double within = 0.9;  // |r|^-2 is infinite on the largest ellipse
    constexpr double relative_bound = 20;
    if (half_length == 0) return 2;
    if (distance == 0) return max_gauss_nodes + 1;
    const double d = within * distance / half_length;
    const double b = std::min(d, std::sqrt(d + 0.5 * sqr(d)));
    const double decay = 2 * std::asinh(b);  // 2 ln rho
    const double nodes = 1 + std::ceil(std::max(1.0, std::log(relative_bound / tolerance) / decay));
    return nodes <= static_cast<double>(max_gauss_nodes) ? static_cast<std::size_t>(nodes) : max_gauss_nodes + 1;
}

/// The integral of point_form_factor over a quadrilateral by Gauss's rules in both of its directions.
struct AreaRule {
    Corners corners;
    std::size_t nodes_u, nodes_v;

    AreaRule(const Corners& c, double distance, double tolerance)
        : corners(c),
          nodes_u(nodes_along(0.5 * std::max((c[1] - c[0]).norm(), (c[2] - c[3]).norm()), distance, tolerance)),
          nodes_v(nodes_along(0.5 * std::max((c[3] - c[0]).norm(), (c[2] - c[1]).norm()), distance, tolerance)) {}

    bool suffices() const { return std::max(nodes_u, nodes_v) <= max_gauss_nodes; }

    double integral(const Vec3d& normal, const Side& seen) const {
        double sum = 0;
        for (const QuadratureNode& u : gauss_rule(nodes_u))
            for (const QuadratureNode& v : gauss_rule(nodes_v))
                sum += u.weight * v.weight * integrand(0.5 + 0.5 * u.x, 0.5 + 0.5 * v.x, normal, seen);
        return 0.25 * sum;
    }

private:
    double integrand(double u, double v, const Vec3d& normal, const Side& seen) const {
        const Vec3d low = corners[0] + u * (corners[1] - corners[0]), high = corners[3] + u * (corners[2] - corners[3]);
        const Vec3d along_u = (1 - v) * (corners[1] - corners[0]) + v * (corners[2] - corners[3]);
        const Vec3d point = low + v * (high - low);
        ConvexRegion rays;
        for (const Vec3d& vertex : seen.region.vertices())
            rays.add(vertex - point);
        const double height = std::max(seen.plane.normal.dot(point - seen.plane.origin), 0.0);
        return along_u.cross(high - low).norm() * visible_form_factor(rays.vertices(), normal, height);
    }
};

/// The integral of the kernel over both parts [scene units^2]: points are taken on the smaller part, because from all
/// of its points the other part looks nearly the same.
double pair_integral(const Side& small, const Side& large, double tolerance) {
    // The distance of the bounding spheres suffices if the parts are so far apart that few nodes are needed.
    constexpr double far = 10;
    const double gap = (large.center - small.center).norm() - large.radius - small.radius;
    const double distance = gap > far * small.radius ? gap : distance_to_edges(small, large);
    const ConvexRegion& r = small.region;
    const Corners whole = r.size() == 3 ? Corners{r[0], r[1], r[2], r[0]} : Corners{r[0], r[1], r[2], r[3]};
    const AreaRule first(whole, distance, tolerance);
    std::optional<AreaRule> rest;
    if (r.size() == 5) rest.emplace(Corners{r[0], r[3], r[4], r[0]}, distance, tolerance);
    if (r.size() <= 5 && first.suffices() && (!rest || rest->suffices()))
        return first.integral(small.plane.normal, large) + (rest ? rest->integral(small.plane.normal, large) : 0.0);
    // The factor of neighbours that are in one plane up to rounding has no meaning.
    constexpr double negligible = 1e-6;
    return contour_integral(small.region, large.region, tolerance, negligible * small.area());
}

}  // namespace

PatchPolygon PatchPolygon::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    // The cross product of the two shorter edges: rounding then turns the normal of a thin triangle about
    // its length only.
    const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
    const Vec3d doubled_area = ab >= std::max(bc, ca)   ? (a - c).cross(b - c)
                               : bc >= std::max(ab, ca) ? (b - a).cross(c - a)
                                                        : (c - b).cross(a - b);
    return polygon_of({a, b, c, c}, 3, doubled_area);
}

PatchPolygon PatchPolygon::quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    // The cross product of the diagonals, computed from edges: the diagonals of a narrow strip are nearly parallel.
    return polygon_of({a, b, c, d}, 4, (b - a).cross(d - a) + (d - c).cross(b - c));
}

PatchPolygon PatchPolygon::flipped() const {
    PatchPolygon other = *this;
    std::reverse(other.vertices.begin(), other.vertices.begin() + count);
    other.normal = -normal;
    return other;
}

double point_form_factor(const Vec3d& point, const Vec3d& normal, const PatchPolygon& polygon) {
    const auto corners = polygon.corners();
    const double rounding = std::max(coordinate_rounding(corners), coordinate_rounding({&point, 1}));
    const double height = plane_of(polygon, rounding).height(point);
    if (!(height > 0)) return 0;
    std::array<Vec3d, 4> rays;
    for (std::size_t i = 0; i < corners.size(); ++i)
        rays[i] = corners[i] - point;
    const ConvexRegion seen = front_part({rays.data(), corners.size()}, {Vec3d::Zero(), normal, rounding});
    return visible_form_factor(seen.vertices(), normal, height);
}

double polygon_form_factor(const PatchPolygon& from, const PatchPolygon& to, double tolerance) {
    const double rounding = std::max(coordinate_rounding(from.corners()), coordinate_rounding(to.corners()));
    const RoundedPlane from_plane = plane_of(from, rounding), to_plane = plane_of(to, rounding);
    const Side a(from, from_plane, to_plane), b(to, to_plane, from_plane);
    if (a.region.size() == 0 || b.region.size() == 0) return 0;
    const bool from_is_smaller = a.radius <= b.radius;
    const double share = pair_integral(from_is_smaller ? a : b, from_is_smaller ? b : a, tolerance) / from.area;
    return std::clamp(share, 0.0, 1.0);  // removes rounding
}

}  // namespace gib
