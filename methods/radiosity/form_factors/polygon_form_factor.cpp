#include "methods/radiosity/form_factors/polygon_form_factor.h"

#include "common/core/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gib {

namespace {

PatchPolygon polygon_of(std::array<Vec3d, 4> vertices, int count, const Vec3d& doubled_area) {
    const double length = doubled_area.stableNorm();
    if (!(length > 0) || !std::isfinite(length)) throw InputError("a polygon without a positive, finite area");
    return {.vertices = std::move(vertices), .count = count, .normal = doubled_area / length, .area = 0.5 * length};
}

/// A convex polygon that a plane may have cut: at most 6 vertices if four are not quite in one plane.
struct Region {
    std::array<Vec3d, 6> vertices;
    std::size_t count = 0;

    void add(const Vec3d& vertex) { vertices[count++] = vertex; }
    const Vec3d& operator[](std::size_t i) const { return vertices[i]; }
    const Vec3d& after(std::size_t i) const { return vertices[i + 1 == count ? 0 : i + 1]; }
    Vec3d mean() const {
        Vec3d sum = Vec3d::Zero();
        for (std::size_t i = 0; i < count; ++i)
            sum += vertices[i];
        return sum / static_cast<double>(count);
    }
    double radius(const Vec3d& from) const {
        double largest = 0;
        for (std::size_t i = 0; i < count; ++i)
            largest = std::max(largest, (vertices[i] - from).norm());
        return largest;
    }
};

/// The height of p over a plane; 0 where the rounding of p or of the normal hides the side.
double height_over(const Vec3d& origin, const Vec3d& normal, const Vec3d& p) {
    constexpr double slope = 1e-9, rounding = 16 * std::numeric_limits<double>::epsilon();
    const Vec3d way = p - origin;
    const double height = normal.dot(way);
    const double largest = std::max(p.cwiseAbs().maxCoeff(), origin.cwiseAbs().maxCoeff());
    return std::abs(height) <= slope * way.norm() + rounding * largest ? 0 : height;
}

/// The part of a polygon on the side of the plane to which the normal points. Vertices of height 0 are kept; the part
/// of a polygon that lies in the plane is empty. Source: Sutherland and Hodgman 1974.
Region front_part(std::span<const Vec3d> polygon, const Vec3d& origin, const Vec3d& normal) {
    std::array<double, 4> heights;
    double highest = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        heights[i] = height_over(origin, normal, polygon[i]);
        highest = std::max(highest, heights[i]);
    }
    Region part;
    if (!(highest > 0)) return part;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const std::size_t next = i + 1 == polygon.size() ? 0 : i + 1;
        if (heights[i] >= 0) part.add(polygon[i]);
        if ((heights[i] < 0 && heights[next] > 0) || (heights[i] > 0 && heights[next] < 0))
            part.add(polygon[i] + heights[i] / (heights[i] - heights[next]) * (polygon[next] - polygon[i]));
    }
    return part;
}

/// The angle whose sine and cosine are in proportion to `sine` >= 0 and `cosine`, over `sine`.
double angle_over_sine(double sine, double cosine) {
    const double t2 = sqr(sine / cosine);
    if (!(cosine > 0) || t2 > 0.01) return std::atan2(sine, cosine) / sine;
    // The series of the arc tangent; what is left out is 1e-17.
    double sum = 0;
    for (int n = 15; n > 1; n -= 2)
        sum = t2 * (1.0 / n - sum);
    return (1 - sum) / cosine;
}

/// point_form_factor of a region that lies wholly above the horizon.
double visible_form_factor(const Vec3d& point, const Vec3d& normal, const Region& region) {
    double sum = 0;
    for (std::size_t i = 0; i < region.count; ++i) {
        const Vec3d a = region[i] - point, edge = region.after(i) - region[i];
        const Vec3d cross = edge.cross(a);  // b x a, which would cancel where the edge is short
        const double sine = cross.norm();
        if (sine > 0) sum += normal.dot(cross) * angle_over_sine(sine, a.dot(a + edge));
    }
    return std::clamp(sum / (2 * std::numbers::pi), 0.0, 1.0);  // removes rounding
}

/// A point of a rule on [0, 1].
struct Node {
    double x, weight;
};
/// Gauss's rules of 2, 3 and 5 points; exact for polynomials of degree 3, 5 and 9.
constexpr std::array<Node, 2> two_nodes = {{{0.21132486540518713, 0.5}, {0.78867513459481287, 0.5}}};
constexpr std::array<Node, 3> three_nodes = {
    {{0.11270166537925831, 5.0 / 18}, {0.5, 8.0 / 18}, {0.88729833462074169, 5.0 / 18}}};
constexpr std::array<Node, 5> five_nodes = {{{0.04691007703066800, 0.11846344252809454},
                                             {0.23076534494715845, 0.23931433524968324},
                                             {0.5, 0.28444444444444444},
                                             {0.76923465505284155, 0.23931433524968324},
                                             {0.95308992296933200, 0.11846344252809454}}};

/// The integral of the form factor of `large` over the quadrilateral of p, by a rule in both of its coordinates.
double quad_integral(const std::array<Vec3d, 4>& p, const Vec3d& normal, const Region& large,
                     std::span<const Node> rule) {
    double sum = 0;
    for (const Node& u : rule)
        for (const Node& v : rule) {
            const Vec3d left = p[0] + v.x * (p[3] - p[0]), du = p[1] + v.x * (p[2] - p[1]) - left;
            const Vec3d dv = (1 - u.x) * (p[3] - p[0]) + u.x * (p[2] - p[1]);
            sum += u.weight * v.weight * du.cross(dv).norm() * visible_form_factor(left + u.x * du, normal, large);
        }
    return sum;
}

/// The integral of the form factor of `large` over `small`, which is cut into quadrilaterals. Two corners of the last one
/// may be in one place.
double area_integral(const Region& small, const Vec3d& normal, const Region& large, std::span<const Node> rule) {
    double sum = 0;
    for (std::size_t i = 1; i + 1 < small.count; i += 2)
        sum += quad_integral({small[0], small[i], small[i + 1], small[std::min(i + 2, small.count - 1)]}, normal, large,
                             rule);
    return sum;
}

/// The integral of ln |x - y| `along` . dy around a contour, up to a constant. With u the coordinate along an edge and
/// p the distance of x from the edge's line, the integral of ln sqrt(u^2 + p^2) is u ln sqrt(u^2 + p^2) - u + p atan(u
/// / p). The second term adds up to the constant, and the third is p times the angle that the edge subtends.
double inner_contour(const Region& contour, const Vec3d& x, const Vec3d& along) {
    double sum = 0;
    for (std::size_t i = 0; i < contour.count; ++i) {
        const Vec3d edge = contour.after(i) - contour[i], a = contour[i] - x, b = a + edge;
        const double length = edge.norm(), aa = a.squaredNorm(), bb = b.squaredNorm();
        if (length == 0) continue;
        const auto logarithm = [](double squared) { return squared > 0 ? 0.5 * std::log(squared) : 0; };
        const double p_length = a.cross(edge).norm(), angle = std::atan2(p_length, a.dot(b));
        sum += along.dot(edge) / sqr(length) *
               (b.dot(edge) * logarithm(bb) - a.dot(edge) * logarithm(aa) + p_length * angle);
    }
    return sum;
}

/// Gauss's rule of 8 points on [0, 1], its lower half; the upper half mirrors it.
constexpr std::array<Node, 4> gauss_nodes = {{{0.01985507175123188, 0.05061426814518813},
                                              {0.10166676129318664, 0.11119051722668724},
                                              {0.23723379504183550, 0.15685332293894364},
                                              {0.40828267875217510, 0.18134189168918099}}};

/// The integral of inner_contour along a section of the outer contour, with the share u = t^2 (3 - 2 t) of the way: the
/// singular term u ln u du, which occurs where contours meet, becomes about t^3 ln t dt.
double along_section(const Region& inner, const Vec3d& start, const Vec3d& way) {
    double sum = 0;
    for (const Node& node : gauss_nodes)
        for (const double t : {node.x, 1 - node.x})
            sum += node.weight * 6 * t * (1 - t) * inner_contour(inner, start + t * t * (3 - 2 * t) * way, way);
    return sum;
}

/// The same, by halves until these agree with the whole within `allowed`. `whole` is along_section().
double refined(const Region& inner, const Vec3d& start, const Vec3d& way, double whole, double allowed, int depth) {
    const Vec3d half = way / 2, middle = start + half;
    const double first = along_section(inner, start, half), second = along_section(inner, middle, half);
    if (depth == 0 || std::abs(first + second - whole) <= allowed) return first + second;
    return refined(inner, start, half, first, allowed, depth - 1) +
           refined(inner, middle, half, second, allowed, depth - 1);
}

/// The integral of the kernel over two polygons, each wholly in front of the other or in its plane: area times form
/// factor. Stokes' theorem, applied twice, turns it into 1 / (2 pi) times the integral of ln |x - y| dx . dy around
/// both contours (Goral et al. 1984; Schroeder and Hanrahan 1993, "On the Form Factor between Two Polygons"). The
/// inner integral has a closed form, which is finite where the contours touch. `area` is that of the smaller polygon.
double contour_integral(const Region& outer, const Region& inner, double area) {
    // The tolerance is a share of the factor, but at least of 1e-3, below which little light is carried.
    constexpr double tolerance = 2e-5, least_factor = 1e-3;
    constexpr int most_halvings = 12;
    std::array<double, 6> wholes;
    double estimate = 0, sum = 0;
    for (std::size_t i = 0; i < outer.count; ++i) {
        wholes[i] = along_section(inner, outer[i], outer.after(i) - outer[i]);
        estimate += wholes[i];
    }
    const double allowed = tolerance * std::clamp(std::abs(estimate), least_factor * area, area);
    for (std::size_t i = 0; i < outer.count; ++i)
        sum += refined(inner, outer[i], outer.after(i) - outer[i], wholes[i], allowed, most_halvings);
    return sum / (2 * std::numbers::pi);
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
    if (!(height_over(polygon.vertices[0], polygon.normal, point) > 0)) return 0;
    return visible_form_factor(point, normal, front_part(polygon.corners(), point, normal));
}

double polygon_form_factor(const PatchPolygon& from, const PatchPolygon& to) {
    const Region a = front_part(from.corners(), to.vertices[0], to.normal);
    const Region b = front_part(to.corners(), from.vertices[0], from.normal);
    if (a.count == 0 || b.count == 0) return 0;
    const Vec3d a_mean = a.mean(), b_mean = b.mean();
    const double a_radius = a.radius(a_mean), b_radius = b.radius(b_mean);
    const bool a_is_smaller = a_radius <= b_radius;
    const Region &small = a_is_smaller ? a : b, &large = a_is_smaller ? b : a;
    // The error of Gauss's rule of n points is about r^(-2n), r = x + sqrt(x^2 - 1) with x = 1 / nearness.
    const double distance = (b_mean - a_mean).norm() - std::max(a_radius, b_radius);
    const double nearness = distance > 0 ? std::min(a_radius, b_radius) / distance : 1;
    const Vec3d& normal = a_is_smaller ? from.normal : to.normal;
    const double integral = nearness < 0.1   ? area_integral(small, normal, large, two_nodes)
                            : nearness < 0.3 ? area_integral(small, normal, large, three_nodes)
                            : nearness < 0.6 ? area_integral(small, normal, large, five_nodes)
                                             : contour_integral(small, large, a_is_smaller ? from.area : to.area);
    return std::clamp(integral / from.area, 0.0, 1.0);
}

}  // namespace gib
