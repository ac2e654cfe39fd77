// Form factors from points and polygons against closed forms, and the laws that they obey.
#include "methods/radiosity/form_factors/polygon_form_factor.h"

#include "common/core/error.h"
#include "common/core/float_traps.h"
#include "tests/methods/radiosity/form_factors/polygon_fixtures.h"
#include "tests/support/moments.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <numeric>

namespace gib::test::polygon_form_factor_test {
namespace {

constexpr double pi_d = std::numbers::pi;
/// The tolerance of polygon_form_factor, relative.
constexpr double tolerance = 1e-4;

const std::vector<double> distances = {1e-3, 1e-2, 0.1, 0.3, 1, 3, 10, 100, 1e3};

// The closed forms are differences of large numbers. At sizes of 1e3, long double leaves a relative error of 1e-6.
using Long = long double;

/// Form factor from a differential area to a parallel rectangle a x b at the distance c; one corner of the rectangle
/// is above the area (Howell's catalogue).
double element_to_corner(double a, double b, double c) {
    const double x = a / c, y = b / c, p = std::hypot(1.0, x), q = std::hypot(1.0, y);
    return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * pi_d);
}

/// Area times form factor of the parallel rectangles [0, x] x [0, y] and [u0, u1] x [v0, v1] at the distance z
/// (Howell's catalogue): an alternating sum over the 16 differences of corners. Division by z^2 in the logarithm adds
/// a constant that cancels in the sum; it keeps the logarithms small.
double parallel_rectangles(Long x, Long y, Long u0, Long u1, Long v0, Long v1, Long z) {
    const auto g = [z](Long u, Long v) {
        const Long p = std::hypot(u, z), q = std::hypot(v, z);
        return v * p * std::atan(v / p) + u * q * std::atan(u / q) - z * z / 2 * std::log1p((u * u + v * v) / (z * z));
    };
    Long sum = 0;
    for (int corner = 0; corner < 16; ++corner) {
        const Long u = ((corner & 1) ? x : 0) - ((corner & 2) ? u1 : u0);
        const Long v = ((corner & 4) ? y : 0) - ((corner & 8) ? v1 : v0);
        sum += (std::popcount(static_cast<unsigned>(corner)) % 2 ? -1 : 1) * g(u, v);
    }
    return static_cast<double>(sum / (2 * std::numbers::pi_v<Long>));
}

/// Area times form factor from a floor of the width w to a wall of the height h at 90 degrees; their shared edge has
/// the length 1 (Howell's catalogue).
Long floor_to_wall(Long w, Long h) {
    if (w == 0 || h == 0) return 0;
    const Long ww = w * w, hh = h * h, r = std::hypot(w, h), all = 1 + ww + hh;
    const Long logarithms = std::log1p(ww * hh / all) + ww * std::log1p(-hh / ((1 + ww) * (ww + hh))) +
                            hh * std::log1p(-ww / ((1 + hh) * (ww + hh)));
    return (w * std::atan(1 / w) + h * std::atan(1 / h) - r * std::atan(1 / r) + logarithms / 4) /
           std::numbers::pi_v<Long>;
}

TEST(PointFormFactor, RectangleAboveHasTheClosedForm) {
    for (double c : {1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e9}) {
        const PatchPolygon lamp = rectangle({0, 0, c}, {0, 0.7, 0}, {1, 0, 0});
        const double exact = element_to_corner(1, 0.7, c);
        EXPECT_NEAR(point_form_factor({0, 0, 0}, {0, 0, 1}, lamp) / exact, 1, 1e-12 + std::min(1e-15 * c, 1e-10)) << c;
        EXPECT_EQ(point_form_factor({0, 0, 0}, {0, 0, 1}, lamp.flipped()), 0);
        EXPECT_EQ(point_form_factor({0, 0, 0}, {0, 0, -1}, lamp), 0);
    }
}

TEST(PolygonFormFactor, ParallelRectanglesHaveTheClosedForm) {
    const PatchPolygon floor = rectangle({0, 0, 0}, {1, 0, 0}, {0, 0.7, 0});
    struct Offset {
        double u, v, width, depth;
    };
    for (double z : distances)
        for (const Offset& o :
             {Offset{0, 0, 1, 0.7}, Offset{0.4, -0.3, 1, 0.7}, Offset{1, 0.7, 2, 1}, Offset{5, 0, 1, 1},
              Offset{0.2, 0.3, 1e-4, 1e-4}, Offset{1, 0, 0.01, 0.7}, Offset{-20, -30, 70, 90}}) {
            const PatchPolygon ceiling = rectangle({o.u, o.v, z}, {0, o.depth, 0}, {o.width, 0, 0});
            const double exact = parallel_rectangles(1, 0.7L, o.u, o.u + o.width, o.v, o.v + o.depth, z);
            SCOPED_TRACE(testing::Message() << "z " << z << " at " << o.u << " " << o.v << " width " << o.width);
            EXPECT_NEAR(polygon_form_factor(floor, ceiling), exact / floor.area, tolerance * exact / floor.area + 1e-8);
            EXPECT_NEAR(polygon_form_factor(ceiling, floor), exact / ceiling.area,
                        tolerance * exact / ceiling.area + 1e-8);
        }
}

// First, floor and wall share an edge. Then both are moved away from this edge by z, and the closed form is a sum of
// four of those with a shared edge.
TEST(PolygonFormFactor, PerpendicularRectanglesHaveTheClosedForm) {
    for (double width : {1e-4, 1e-2, 1.0, 30.0, 1e3})
        for (double height : {1e-4, 1e-2, 1.0, 30.0, 1e3}) {
            const PatchPolygon floor = rectangle({0, 0, 0}, {width, 0, 0}, {0, 1, 0});
            const PatchPolygon wall = rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, height});
            const auto exact = static_cast<double>(floor_to_wall(width, height)) / width;
            EXPECT_NEAR(polygon_form_factor(floor, wall) / exact, 1, tolerance) << width << " " << height;
            EXPECT_NEAR(polygon_form_factor(wall, floor) * height / width / exact, 1, tolerance);
        }
    for (double z : distances) {
        const PatchPolygon floor = rectangle({z, 0, 0}, {1, 0, 0}, {0, 1, 0});
        const PatchPolygon wall = rectangle({0, 0, z}, {0, 1, 0}, {0, 0, 1});
        const Long near = z, end = near + 1;
        const auto exact =
            static_cast<double>(floor_to_wall(end, end) - 2 * floor_to_wall(near, end) + floor_to_wall(near, near));
        EXPECT_NEAR(polygon_form_factor(floor, wall) / exact, 1, tolerance) << z;
    }
}

// Strips of the width 1 share an edge. If they are endless, the method of crossed strings gives 1 - sin(angle / 2)
// (Hottel 1954). At the ends of strips of the length L, less than the share 2 / L of the light leaves.
TEST(PolygonFormFactor, FoldedStripsHaveThatOfCrossedStrings) {
    constexpr double length = 1e4;
    for (double angle : {0.1, 0.5, 1.0, 2.0, 3.0}) {
        const PatchPolygon floor = rectangle({0, 0, 0}, {1, 0, 0}, {0, length, 0});
        const PatchPolygon wall = rectangle({0, 0, 0}, {0, length, 0}, {std::cos(angle), 0, std::sin(angle)});
        EXPECT_NEAR(polygon_form_factor(floor, wall) / (1 - std::sin(angle / 2)), 1, 2 / length + tolerance) << angle;
    }
}

// Laws that every form factor obeys: rows of closed scenes sum up to 1, reciprocity, agreement with rays.

/// The relative tolerance of these laws.
constexpr double law_tolerance = 1e-4;

/// Polygons after a random rotation and translation, so that their coordinates and planes are rounded.
std::vector<PatchPolygon> turned(const std::vector<PatchPolygon>& polygons, RandomPolygons& random) {
    const Eigen::Matrix3d rotation = random.rotation();
    const Vec3d translation = 3 * random.direction();
    std::vector<PatchPolygon> all;
    for (const PatchPolygon& polygon : polygons)
        all.push_back(moved(polygon, [&](const Vec3d& p) { return Vec3d(rotation * p + translation); }));
    return all;
}

double row_sum(const PatchPolygon& from, const std::vector<PatchPolygon>& all) {
    double sum = 0;
    for (const PatchPolygon& to : all)
        sum += polygon_form_factor(from, to);
    return sum;
}

TEST(PolygonFormFactorLaws, RowsOfClosedBoxesAddUpToOne) {
    RandomPolygons random(1);
    for (const Vec3d& size : {Vec3d(1, 1, 1), Vec3d(1, 2, 0.5), Vec3d(1, 1, 1e-3), Vec3d(1e-2, 1, 1)})
        for (int n : {1, 3}) {
            const auto walls = turned(box(size, n), random);
            for (const PatchPolygon& wall : walls)
                EXPECT_NEAR(row_sum(wall, walls), 1, law_tolerance) << size.transpose() << " in " << n;
        }
}

/// Whether the ray hits the front side of the polygon.
bool meets(const PatchPolygon& polygon, const Vec3d& o, const Vec3d& d) {
    const double towards = polygon.normal.dot(d), height = polygon.normal.dot(o - polygon.vertices[0]);
    if (towards >= 0 || height <= 0) return false;
    const Vec3d p = o - height / towards * d;
    const auto corners = polygon.corners();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d& next = corners[i + 1 == corners.size() ? 0 : i + 1];
        if (polygon.normal.dot((next - corners[i]).cross(p - corners[i])) < 0) return false;
    }
    return true;
}

// The planes of the polygons cut each other; many of the polygons pierce each other. 160
// comparisons within 5 standard errors: false alarm 1e-4. The share of n rays that hit has the
// variance F (1 - F) / n; n F is at least some tens.
TEST(PolygonFormFactorLaws, AgreesWithRaysWherePolygonsCrossHorizons) {
    RandomPolygons random(5);
    constexpr int rays = 20000;
    int compared = 0;
    while (compared < 80) {
        const PatchPolygon from = random.polygon({0, 0, 0});
        const double distance = 2 * random.next();
        const PatchPolygon to = random.polygon(distance * random.direction());
        const double factor = polygon_form_factor(from, to);
        if (factor < 3e-3) continue;
        ++compared;
        const Eigen::Quaterniond frame = Eigen::Quaterniond::FromTwoVectors(Vec3d::UnitZ(), from.normal);
        const double first =
            (from.vertices[1] - from.vertices[0]).cross(from.vertices[2] - from.vertices[0]).norm() / 2;
        Moments whole, point;
        const Vec3d middle = (from.vertices[0] + from.vertices[1] + from.vertices[2]) / 3;
        for (int i = 0; i < rays; ++i) {
            const std::size_t k = random.next() * from.area < first ? 1 : 2;
            const double u = std::sqrt(random.next()), v = random.next();
            const Vec3d p = (1 - u) * from.vertices[0] + u * ((1 - v) * from.vertices[k] + v * from.vertices[k + 1]);
            const double r = std::sqrt(random.next()), phi = 2 * std::numbers::pi * random.next();
            const Vec3d d = frame * Vec3d(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r * r));
            whole.add(meets(to, p, d) ? 1 : 0);
            point.add(meets(to, middle, d) ? 1 : 0);
        }
        const auto error_of = [](double f) { return std::sqrt(f * (1 - f) / rays); };
        EXPECT_NEAR(whole.mean(), factor, 5 * error_of(factor)) << compared;
        const double share = point_form_factor(middle, from.normal, to);
        EXPECT_NEAR(point.mean(), share, 5 * error_of(share) + 5.0 / rays) << compared;
    }
}

}  // namespace
}  // namespace gib::test::polygon_form_factor_test
