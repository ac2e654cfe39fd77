// Tests of the triangulation of polygons: area, facing, and which fans stay.

#include "common/mesh_files/polygon.h"
#include "common/mesh_files/mesh_data.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <numbers>

namespace gib::test::polygon_test {
namespace {

using Corners = std::vector<Vec3d>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Corners in_plane(const std::vector<std::pair<double, double>>& xy) {
    Corners corners;
    for (const auto& [x, y] : xy)
        corners.emplace_back(x, y, 0);
    return corners;
}

Triangles fan_of(std::size_t corners) {
    Triangles fan;
    for (std::uint32_t i = 1; i + 1 < corners; ++i)
        fan.push_back({0, i, i + 1});
    return fan;
}

Triangles triangulated(const Corners& corners) {
    Triangles triangles = fan_of(corners.size());
    const Fan fan{0, static_cast<std::uint32_t>(corners.size())};
    triangulate_fans(corners, triangles, {&fan, 1});
    return triangles;
}

Vec3d area_vector(const Corners& corners, const std::array<std::uint32_t, 3>& t) {
    return 0.5 * (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]);
}

/// Expects triangles that lie side by side and cover the polygon: their areas add up to the polygon's, and none is
/// turned over. Corners in a line still need a triangle each, so that none may be without area.
void expect_covered(const Corners& corners, const char* name) {
    const Triangles triangles = triangulated(corners);
    ASSERT_EQ(triangles.size() + 2, corners.size()) << name;
    Vec3d whole = Vec3d::Zero();
    for (const auto& t : fan_of(corners.size()))
        whole += area_vector(corners, t);
    double sum = 0;
    for (const auto& t : triangles) {
        EXPECT_GT(area_vector(corners, t).dot(whole), 1e-12 * whole.squaredNorm()) << name;
        sum += area_vector(corners, t).norm();
    }
    EXPECT_NEAR(sum, whole.norm(), 1e-9 * whole.norm()) << name;
}

/// The same polygon, written from another corner on.
Corners from_corner(Corners corners, std::size_t first) {
    std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(first), corners.end());
    return corners;
}

const Corners notched = in_plane({{0.5, 0.5}, {0.5, -0.5}, {0, 0.4}, {-0.5, -0.5}, {-0.5, 0.5}});
/// A comb of three teeth with corners in a line along its back.
const Corners comb = in_plane({{0, 0}, {1, 0}, {1, 3}, {2, 1}, {3, 3}, {4, 1}, {5, 3}, {6, 0}, {6, 4}, {3, 4}, {0, 4}});
const Corners l_shape = in_plane({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1.5, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}});

TEST(Polygon, ConvexFacesKeepTheirFan) {
    Corners hexagon;
    for (int i = 0; i < 6; ++i)
        hexagon.emplace_back(1e3 + std::cos(i * std::numbers::pi / 3), std::sin(i * std::numbers::pi / 3), 0.1 * i);
    EXPECT_EQ(triangulated(hexagon), fan_of(6));
    const Corners with_middles = in_plane({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}});
    EXPECT_EQ(triangulated(with_middles), fan_of(8));
}

TEST(Polygon, NonConvexFacesAreCoveredFromEveryCorner) {
    for (const Corners& plane : {notched, comb, l_shape})
        for (std::size_t first = 0; first < plane.size(); ++first)
            for (const bool reversed : {false, true}) {
                Corners corners = from_corner(plane, first);
                if (reversed) std::reverse(corners.begin(), corners.end());
                // The fans of some corners are right and stay, with triangles that have no area.
                if (triangulated(corners) == fan_of(corners.size())) continue;
                expect_covered(corners, reversed ? "reversed" : "as written");
                const Eigen::Matrix3d turn =
                    Eigen::AngleAxisd(1.1, Vec3d(1, 2, 3).normalized()).toRotationMatrix() * 1e-3;
                for (Vec3d& p : corners)
                    p = turn * p + Vec3d(5, -7, 11);
                expect_covered(corners, "turned");
            }
}

TEST(Polygon, AFanThatDoesNotCoverItsPolygonIsReplaced) {
    EXPECT_NE(triangulated(notched), fan_of(5));
    EXPECT_NE(triangulated(comb), fan_of(11));
}

TEST(Polygon, RandomStarsAreCovered) {
    Random random(7);
    for (int n : {5, 8, 20, 60})
        for (int star = 0; star < 50; ++star) {
            Corners corners;
            for (int i = 0; i < n; ++i) {
                const double angle = 2 * std::numbers::pi * (i + 0.8 * static_cast<double>(random.next())) / n;
                const double radius = 0.2 + static_cast<double>(random.next());
                corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
            }
            expect_covered(corners, "star");
        }
}

TEST(Polygon, ABridgeToAHoleIsNoSurface) {
    // A square of side 4 around one of side 2; the edge from (0, 0) to (1, 1) is passed both ways.
    const Corners ring = in_plane({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}});
    for (std::size_t first = 0; first < ring.size(); ++first)
        expect_covered(from_corner(ring, first), "ring");
}

TEST(Polygon, WhatHasNoTriangulationStaysAFan) {
    const Corners line = in_plane({{0, 0}, {1, 0}, {3, 0}, {2, 0}});
    EXPECT_EQ(triangulated(line), fan_of(4));
    const Corners crossing = in_plane({{0, 0}, {1, 1}, {1, 0}, {0, 1}});
    EXPECT_EQ(triangulated(crossing).size(), 2u);
}

double area_of(const MeshData& mesh) {
    double area = 0;
    for (const auto& t : mesh.triangles)
        area += area_vector(mesh.positions, t).norm();
    return area;
}

TEST(Polygon, BothFileFormatsPartNonConvexFaces) {
    // The notched square: 1 less the notch of base 1 and height 0.9.
    const double area = 1 - 0.45;
    const std::string obj = "v 0.5 0.5 1\nv 0.5 -0.5 1\nv 0 0.4 1\nv -0.5 -0.5 1\nv -0.5 0.5 1\nf 1 2 3 4 5\n";
    EXPECT_NEAR(area_of(parse_obj(obj, "m.obj")), area, 1e-12);
    const std::string vertices = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
    const std::string vertex_data = "0.5 0.5 1\n0.5 -0.5 1\n0 0.4 1\n-0.5 -0.5 1\n-0.5 0.5 1\n";
    const std::string face_data = "5 0 1 2 3 4\n", head = "ply\nformat ascii 1.0\n", end = "end_header\n";
    EXPECT_NEAR(area_of(parse_ply(head + vertices + faces + end + vertex_data + face_data, "m.ply")), area, 1e-12);
    EXPECT_NEAR(area_of(parse_ply(head + faces + vertices + end + face_data + vertex_data, "m.ply")), area, 1e-12);
}

}  // namespace
}  // namespace gib::test::polygon_test
