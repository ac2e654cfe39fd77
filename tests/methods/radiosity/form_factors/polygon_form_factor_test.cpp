// Form factors from points and polygons against closed forms.
#include "methods/radiosity/form_factors/polygon_form_factor.h"

#include "tests/methods/radiosity/form_factors/polygon_fixtures.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

namespace gib::polygon_form_factor_test {
namespace {

using test::box;
using test::RandomPolygons;
using test::rectangle;

constexpr double pi_d = std::numbers::pi;
/// The tolerance of polygon_form_factor, relative.
constexpr double tolerance = 6e-4;

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

TEST(PointFormFactor, FarPolygonAtAnAngleIsThatOfItsCentre) {
    for (double d : {1e4, 1e5, 3e5, 1e6, 1e8}) {
        const PatchPolygon lamp = rectangle({0.6 * d - 0.5, -0.5, 0.8 * d}, {0, 1, 0}, {1, 0, 0});
        const double exact = 0.8 * 0.8 / (pi_d * d * d);
        EXPECT_NEAR(point_form_factor({0, 0, 0}, {0, 0, 1}, lamp) / exact, 1, 4 / (d * d) + 1e-8) << d;
    }
}

// The walls of a closed box fill the hemisphere of every point in it. Some walls cross the point's horizon. If the
// normal is along an axis and the point is at the height of an edge, the horizon meets vertices.
TEST(PointFormFactor, WallsOfAClosedBoxAddUpToOne) {
    RandomPolygons random(1);
    const std::vector<PatchPolygon> walls = box({3, 2, 1}, 2);
    const auto sum = [&](const Vec3d& p, const Vec3d& n) {
        double all = 0;
        for (const PatchPolygon& wall : walls)
            all += point_form_factor(p, n, wall);
        return all;
    };
    for (int i = 0; i < 200; ++i) {
        const Vec3d p(3 * random.next(), 2 * random.next(), random.next());
        EXPECT_NEAR(sum(p, random.direction()), 1, 1e-12) << p.transpose();
        EXPECT_NEAR(sum({p.x(), p.y(), 0.5}, Vec3d::UnitZ()), 1, 1e-12) << "horizon along edges";
        EXPECT_NEAR(sum({p.x(), 1, 0.5}, Vec3d::UnitX()), 1, 1e-12) << "opposite a corner";
        EXPECT_NEAR(sum({1.5, 1, 0.5}, (Vec3d(1.5, 1, 0.5).cross(random.direction())).normalized()), 1, 1e-12)
            << "horizon through vertices";
        EXPECT_NEAR(sum({p.x(), p.y(), 1e-9}, Vec3d::UnitZ()), 1, 1e-12) << "close to a wall";
    }
}

TEST(PointFormFactor, IsDefinedInThePlaneAndOnTheEdges) {
    const PatchPolygon wall = rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 1});  // faces +x
    const Vec3d up(0, 0, 1);
    EXPECT_EQ(point_form_factor({0, 0.5, 0}, up, wall), 0) << "on an edge";
    EXPECT_EQ(point_form_factor({0, 0, 0}, up, wall), 0) << "at a vertex";
    EXPECT_EQ(point_form_factor({0, 0.5, 0.5}, Vec3d::UnitX(), wall), 0) << "on it";
    EXPECT_EQ(point_form_factor({0, 2, 0}, up, wall), 0) << "on the line of an edge";
    EXPECT_NEAR(point_form_factor({1e-9, 0.5, 0}, up, wall), 0.5, 1e-8) << "close to an edge";
    EXPECT_NEAR(point_form_factor({1e-9, 0.5, 0.5}, Vec3d::UnitX(), wall), 0, 1e-12) << "its back";
    EXPECT_NEAR(point_form_factor({1e-9, 0.5, 0.5}, -Vec3d::UnitX(), wall), 1, 1e-8) << "close to the inside";
    EXPECT_EQ(point_form_factor({1, 0.5, 1}, up, wall), 0) << "below the horizon but for an edge";
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
            EXPECT_NEAR(polygon_form_factor(floor, ceiling), exact / floor.area, tolerance * exact / floor.area + 1e-7);
            EXPECT_NEAR(polygon_form_factor(ceiling, floor), exact / ceiling.area,
                        tolerance * exact / ceiling.area + 1e-7);
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

/// Sector k of n, a triangle, of a regular polygon around the z axis at the height z. The polygon circumscribes the
/// disc of the radius (`outside`) or is inscribed in it.
PatchPolygon sector(double radius, double z, int k, int n, bool outside, bool up) {
    const double r = outside ? radius / std::cos(pi_d / n) : radius;
    const auto at = [&](int i) { return Vec3d(r * std::cos(2 * pi_d * i / n), r * std::sin(2 * pi_d * i / n), z); };
    const PatchPolygon upwards = PatchPolygon::triangle({0, 0, z}, at(k), at(k + 1));
    return up ? upwards : upwards.flipped();
}

// Area times form factor of facing discs grows with each disc, so inscribed and circumscribed polygons bound the
// value. The bounds differ by a factor of (1 + (pi / n)^2)^2 at most. The exact value is Howell's.
TEST(PolygonFormFactor, CoaxialDiscsLieBetweenThoseOfPolygons) {
    constexpr int n = 384;
    for (double radius : {1.0, 0.2})
        for (double z : distances) {
            const auto from_disc = [&](bool outside) {  // area times form factor
                const PatchPolygon first = sector(1, 0, 0, n, outside, true);
                double sum = 0;
                for (int k = 0; k < n; ++k)
                    sum += polygon_form_factor(first, sector(radius, z, k, n, outside, false));
                return n * first.area * sum;
            };
            const double s = 1 + z * z + radius * radius;
            const double exact = pi_d * 2 * sqr(radius) / (s + std::sqrt(s * s - 4 * sqr(radius)));
            const double lower = from_disc(false), upper = from_disc(true);
            EXPECT_LT(lower, exact * (1 + tolerance)) << z;
            EXPECT_GT(upper, exact * (1 - tolerance)) << z;
            EXPECT_LT(upper / lower, 1 + 2 * sqr(pi_d / n) + 2 * tolerance) << z;
        }
}

// By symmetry, the form factor from the surface of a unit sphere is the solid angle that the centre sees, over 4 pi.
// A rectangle a x b whose corner lies h below the centre has the solid angle atan(a b / (h sqrt(a^2 + b^2 + h^2))).
// The mean over the sphere is a midpoint rule in the height of rings and in the angle around them.
TEST(PolygonFormFactor, SphereSeesARectangleAsItsCentreDoes) {
    constexpr int rings = 200, around = 200;
    for (double gap : distances) {
        const double h = 1 + gap, a = 1, b = 1.5;
        const PatchPolygon floor = rectangle({0, 0, -h}, {a, 0, 0}, {0, b, 0});
        double sum = 0;
        for (int i = 0; i < rings; ++i)
            for (int k = 0; k < around; ++k) {
                const double z = (2 * i + 1.0) / rings - 1, r = std::sqrt(1 - z * z),
                             phi = 2 * pi_d * (k + 0.5) / around;
                const Vec3d p(r * std::cos(phi), r * std::sin(phi), z);
                sum += point_form_factor(p, p, floor);
            }
        const double exact = std::atan(a * b / (h * std::sqrt(a * a + b * b + h * h))) / (4 * pi_d);
        EXPECT_NEAR(sum / (rings * around) / exact, 1, 1e-3) << gap;
    }
}

}  // namespace
}  // namespace gib::polygon_form_factor_test
