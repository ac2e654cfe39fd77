// Laws that every form factor obeys: rows of closed scenes sum up to 1, reciprocity, agreement with rays.
#include "common/core/error.h"
#include "common/core/float_traps.h"
#include "tests/methods/radiosity/form_factors/polygon_fixtures.h"
#include "tests/support/moments.h"

#include <gtest/gtest.h>

#include <limits>

namespace gib::polygon_form_factor_laws_test {
namespace {

using test::box;
using test::moved;
using test::parts;
using test::RandomPolygons;
using test::rectangle;

/// The tolerance of polygon_form_factor, relative.
constexpr double tolerance = 1e-3;

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
                EXPECT_NEAR(row_sum(wall, walls), 1, tolerance) << size.transpose() << " in " << n;
        }
}

// The tetrahedra include needles and flat ones, whose faces lie nearly in one plane.
TEST(PolygonFormFactorLaws, RowsOfTetrahedraAddUpToOne) {
    RandomPolygons random(2);
    for (int i = 0; i < 300; ++i) {
        const double flatness = std::pow(10, -4 * random.next()), thickness = std::pow(10, -3 * random.next());
        const Eigen::Matrix3d shape = random.rotation() * Vec3d(1, thickness, flatness * thickness).asDiagonal();
        std::array<Vec3d, 4> v;
        for (Vec3d& p : v)
            p = shape * random.direction();
        if ((v[1] - v[0]).cross(v[2] - v[0]).dot(v[3] - v[0]) < 0) std::swap(v[1], v[2]);
        const std::vector<PatchPolygon> faces = {
            PatchPolygon::triangle(v[0], v[1], v[2]), PatchPolygon::triangle(v[0], v[3], v[1]),
            PatchPolygon::triangle(v[1], v[3], v[2]), PatchPolygon::triangle(v[0], v[2], v[3])};
        for (const PatchPolygon& face : faces)
            EXPECT_NEAR(row_sum(face, faces), 1, 3 * tolerance) << i;
    }
}

TEST(PolygonFormFactorLaws, ASplitTargetAddsUp) {
    RandomPolygons random(3);
    for (int i = 0; i < 60; ++i) {
        const double distance = std::pow(10, 2 * random.next() - 1);
        const PatchPolygon from = random.polygon(distance * random.direction());
        const PatchPolygon whole = rectangle({-0.5, -0.5, 0}, {1, 0, 0}, {0.2, 1, 0});
        const double factor = polygon_form_factor(from, whole);
        // The three points on each triangle leave up to 0.7 % of polygons that hardly see each other.
        EXPECT_NEAR(row_sum(from, parts(whole, 3)), factor, 2 * tolerance * factor + 2e-6) << i;
    }
}

/// The mean of point_form_factor over random points of `from`. Each triangle is divided into
/// n x n parts, with one point in each part.
double mean_over_points(const PatchPolygon& from, const PatchPolygon& to, int n, RandomPolygons& random) {
    double sum = 0;
    for (std::size_t i = 2; i < static_cast<std::size_t>(from.count); ++i) {
        const Vec3d a = from.vertices[0], b = from.vertices[i - 1] - a, c = from.vertices[i] - a;
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k) {
                const double u = std::sqrt((j + random.next()) / n), v = (k + random.next()) / n;
                sum +=
                    b.cross(c).norm() / (2 * n * n) * point_form_factor(a + u * ((1 - v) * b + v * c), from.normal, to);
            }
    }
    return sum / from.area;
}

/// Expects `factor` to equal the mean of 40 such means within 6 of its standard errors: false alarm 5e-7 (Student's
/// t, 39 degrees of freedom), 6e-5 for 120 comparisons.
void expect_mean_over_points(const PatchPolygon& from, const PatchPolygon& to, double factor, RandomPolygons& random) {
    test::Moments mean;
    for (int i = 0; i < 40; ++i)
        mean.add(mean_over_points(from, to, 16, random));
    EXPECT_NEAR(mean.mean(), factor, 6 * mean.standard_error() + tolerance * factor + 1e-6);
}

// Both factors are compared with means over points of either polygon, which do not use reciprocity. Some of the
// polygons cross each other's planes.
TEST(PolygonFormFactorLaws, IsReciprocalAndTheMeanOverEitherPolygon) {
    RandomPolygons random(4), points(5);
    int seen = 0;
    for (int i = 0; i < 300; ++i) {
        SCOPED_TRACE(i);
        const PatchPolygon a = random.polygon({0, 0, 0});
        const double distance = 2.5 + 10 * random.next();
        const PatchPolygon b = random.polygon(distance * random.direction());
        const double ab = polygon_form_factor(a, b), ba = polygon_form_factor(b, a);
        EXPECT_NEAR(ab * a.area, ba * b.area, 1e-12 * ab * a.area);
        if (ab < 1e-5) continue;
        ++seen;
        expect_mean_over_points(a, b, ab, points);
        expect_mean_over_points(b, a, ba, points);
    }
    EXPECT_GT(seen, 50);
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
        test::Moments whole, point;
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

TEST(PolygonFormFactorLaws, ScaleAndPlaceDoNotMatter) {
    RandomPolygons random(7);
    for (int i = 0; i < 100; ++i) {
        const PatchPolygon from = random.polygon({0, 0, 0});
        const double distance = std::pow(10, 3 * random.next() - 1);
        const PatchPolygon to = random.polygon(distance * random.direction());
        const double factor = polygon_form_factor(from, to);
        const Eigen::Matrix3d rotation = random.rotation();
        const Vec3d translation = random.direction();
        for (double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
            const auto motion = [&](const Vec3d& p) { return Vec3d(scale * (rotation * p + translation)); };
            EXPECT_NEAR(polygon_form_factor(moved(from, motion), moved(to, motion)), factor, 1e-6 * factor + 1e-12)
                << i << " scale " << scale;
        }
    }
}

TEST(PolygonFormFactorLaws, PolygonsInOnePlaneSeeNothing) {
    RandomPolygons random(8);
    const PatchPolygon square = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const std::vector<PatchPolygon> plane = {
        square, rectangle({1, 0, 0}, {1, 0, 0}, {0, 1, 0}), rectangle({1, 1, 0}, {1, 0, 0}, {0, 1, 0}),
        rectangle({0.2, 0.3, 0}, {0.01, 0, 0}, {0, 2, 0}), rectangle({40, 3, 0}, {1, 0, 0}, {0, 1e-3, 0})};
    for (int i = 0; i < 100; ++i) {
        const auto polygons = turned(plane, random);
        for (const PatchPolygon& a : polygons)
            for (const PatchPolygon& b : polygons) {
                EXPECT_EQ(polygon_form_factor(a, b), 0) << i;
                EXPECT_EQ(polygon_form_factor(a, b.flipped()), 0) << i;
            }
    }
}

TEST(PolygonFormFactorLaws, SmallAndNarrowNeighboursSeeHalfOfALargeOne) {
    RandomPolygons random(9);
    const PatchPolygon floor = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    for (double size : {1e-2, 1e-3, 1e-4, 1e-6})
        for (double x : {0.0, 0.5})
            for (double width : {size, 0.5}) {
                const auto pair = turned({floor, rectangle({x, 0.25, 0}, {0, width, 0}, {0, 0, size})}, random);
                // Rays from the small polygon that descend by less than about `size` over the distance to the
                // floor's edges miss the floor.
                EXPECT_NEAR(polygon_form_factor(pair[1], pair[0]), 0.5, 3 * size + tolerance) << size << " " << x;
                EXPECT_NEAR(polygon_form_factor(pair[0], pair[1]), 0.5 * width * size,
                            (3 * size + tolerance) * width * size);
            }
}

TEST(PolygonFormFactorLaws, APolygonHasAnArea) {
    const FloatTrapsPaused paused;  // a NaN is passed below
    const Vec3d a(0, 0, 0), b(1, 0, 0), c(2, 0, 0);
    EXPECT_THROW(PatchPolygon::triangle(a, b, c), InputError);
    EXPECT_THROW(PatchPolygon::quad(a, a, a, a), InputError);
    EXPECT_THROW(PatchPolygon::triangle(a, b, Vec3d::Constant(std::numeric_limits<double>::quiet_NaN())), InputError);
    const PatchPolygon square = PatchPolygon::quad(a, c, c + Vec3d(0, 3, 0), Vec3d(0, 3, 0));
    EXPECT_DOUBLE_EQ(square.area, 6);
    EXPECT_EQ(square.normal, Vec3d::UnitZ());
    EXPECT_EQ(square.flipped().normal, -Vec3d::UnitZ());
}

}  // namespace
}  // namespace gib::polygon_form_factor_laws_test
