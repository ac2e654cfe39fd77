// Curves become tubes of triangles.

#include "common/mesh_files/curve_mesh.h"
#include "tests/support/mesh_area.h"
#include "tests/support/scene_errors.h"

namespace gib::test::curve_mesh_test {
namespace {

const Mat4d as_it_is = Mat4d::Identity();

MeshData tube(const std::string& text, CurveKind kind, const Mat4d& to_world = as_it_is) {
    return parse_curves(text, "c.txt", kind, to_world);
}

TEST(Curves, AStraightCurveHasTheAreaOfACylinderAndFacesOutwards) {
    const double around = 2 * std::numbers::pi * 0.25;
    // A B-spline with control points at equal distances on a line is that line from the second to the last but one.
    for (const MeshData& mesh : {tube("0 0 0 0.25\n0 0 3 0.25\n", CurveKind::linear),
                                 tube("0 0 -3 0.25\n0 0 0 0.25\r\n0 0 3 0.25\n0 0 6 0.25", CurveKind::bspline)}) {
        EXPECT_NEAR(area_of(mesh), around * 3, 0.005 * around * 3);
        double lowest = 9, highest = -9;
        for (const Vec3d& p : mesh.positions) {
            lowest = std::min(lowest, p.z());
            highest = std::max(highest, p.z());
            EXPECT_NEAR(p.head<2>().norm(), 0.25, 0.003);
        }
        EXPECT_NEAR(lowest, 0, 1e-12);
        EXPECT_NEAR(highest, 3, 1e-12);
        for (const auto& t : mesh.triangles) {
            const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
            const Vec3d normal = (b - a).cross(c - a).normalized();
            EXPECT_GT(normal.dot(mesh.normals[t[0]].cast<double>()), 0.99);
            EXPECT_GT(normal.dot(Vec3d(a.x(), a.y(), 0)), 0);
        }
    }
}

TEST(Curves, ASplineBeginsAtTheWeightedMeanOfItsFirstThreePoints) {
    const MeshData mesh = tube("0 0 0 1\n6 0 0 1\n6 6 0 1\n0 6 0 1\n", CurveKind::bspline);
    Vec3d center = Vec3d::Zero();
    for (int k = 0; k < 32; ++k)
        center += mesh.positions[static_cast<std::size_t>(k)] / 32;
    EXPECT_LT((center - Vec3d(5, 1, 0)).norm(), 1e-9);
}

TEST(Curves, ATransformMovesThePointsAndKeepsTheRadius) {
    Mat4d twice = Mat4d::Identity() * 2;
    twice(3, 3) = 1;
    EXPECT_NEAR(area_of(tube("0 0 0 0.25\n0 0 3 0.25\n", CurveKind::linear, twice)),
                2 * area_of(tube("0 0 0 0.25\n0 0 3 0.25\n", CurveKind::linear)), 1e-9);
}

TEST(Curves, BlankLinesPartCurvesAndErrorsNameThePlace) {
    EXPECT_EQ(tube("\n0 0 0 1\n0 0 1 1\n \n\n5 0 0 1\n5 0 1 1\n5 0 2 1\n\n", CurveKind::linear).triangles.size(),
              3u * 2 * 32);
    const auto error_of = [](const std::string& text) {
        return input_error_of([&] { tube(text, CurveKind::bspline); });
    };
    expect_errors({{"0 0 0 1\n0 0 1 1\n0 0 2 1\n\n", "3:1", "a curve needs 4 control points, found 3"},
                   {"0 0 0\n", "1:6", "a number is missing"},
                   {"0 0 0 0\n", "1:1", "the radius of a curve must be above 0, not 0"},
                   {"0 0 0 1 2\n", "1:9", "a control point has four numbers"},
                   {"\n", "", "the file has no curves"}},
                  error_of, "c.txt");
}

}  // namespace
}  // namespace gib::test::curve_mesh_test
