// Tests of the surfaces that mesh files become: the triangulation of polygons, normals between creases, and the light of
// lamps, which does not depend on how the file parts their surface.

#include "common/mesh_files/polygon.h"
#include "common/mesh_files/mesh_data.h"
#include "common/scene/scene.h"
#include "tests/support/mesh_area.h"
#include "tests/support/random.h"
#include "tests/support/scene_builder.h"
#include "tests/support/scene_text.h"

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
                const double angle = 2 * std::numbers::pi * (i + 0.8 * double{random.next()}) / n;
                const double radius = 0.2 + double{random.next()};
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

/// A box of 8 vertices that share all faces, with uv.
MeshData box() {
    MeshData mesh;
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
            for (const double z : {-1.0, 1.0})
                mesh.positions.emplace_back(x, y, z);
    for (const auto& p : mesh.positions)
        mesh.uvs.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    for (const auto& [a, b, c, d] : {std::array<std::uint32_t, 4>{0, 1, 3, 2},
                                     {4, 6, 7, 5},
                                     {0, 4, 5, 1},
                                     {2, 3, 7, 6},
                                     {0, 2, 6, 4},
                                     {1, 5, 7, 3}}) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    }
    return mesh;
}

Vec3d facet(const MeshData& mesh, const std::array<std::uint32_t, 3>& t) {
    const Vec3d& p = mesh.positions[t[0]];
    return (mesh.positions[t[1]] - p).cross(mesh.positions[t[2]] - p).normalized();
}

TEST(SmoothAngle, PartsABoxAtItsEdges) {
    MeshData mesh = box();
    compute_normals_between_creases(mesh, 45);
    EXPECT_EQ(mesh.positions.size(), 24u);
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t i : triangle) {
            EXPECT_LT((mesh.normals[i].cast<double>() - facet(mesh, triangle)).norm(), 1e-6);
            EXPECT_EQ(mesh.uvs[i].x(), static_cast<float>(mesh.positions[i].x()));
        }
}

// Above 90 degrees a corner of the box is smooth: its three faces have the same angle there, and its normal is the diagonal.
TEST(SmoothAngle, JoinsFacesThatLeanLess) {
    MeshData mesh = box();
    compute_normals_between_creases(mesh, 91);
    EXPECT_EQ(mesh.positions.size(), 8u);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        EXPECT_LT((mesh.normals[i].cast<double>() - mesh.positions[i].normalized()).norm(), 1e-6);
    // Vertices that the file keeps apart are joined, too: what counts is where they are.
    MeshData apart = box();
    MeshData soup;
    for (const auto& triangle : apart.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.positions.size());
        for (const std::uint32_t i : triangle)
            soup.positions.push_back(apart.positions[i]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    compute_normals_between_creases(soup, 91);
    for (std::size_t i = 0; i < soup.positions.size(); ++i)
        EXPECT_LT((soup.normals[i].cast<double>() - soup.positions[i].normalized()).norm(), 1e-6);
}

/// The irradiance [W/m^2] at a point of the floor, by a midpoint rule over the light's samples.
double irradiance(const gib::Scene& scene, const Vec3& p) {
    constexpr int steps = 32;
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const Vec2 u((static_cast<float>(i) + 0.5f) / steps, (static_cast<float>(j) + 0.5f) / steps);
            const auto sample = scene.sample_light(p, 0.5f, u);
            if (!sample) continue;
            sum += double{sample->Le[0] * sample->wi.z() / sample->pdf_w};
        }
    return sum / (steps * steps);
}

/// The mean irradiance [W/m^2] of the square [-0.5, 0.5]^2 in z = 0, by a midpoint rule.
double mean_irradiance(const LoadedScene& loaded) {
    constexpr int steps = 16;
    const Vec3 lowered(0, 0, -0.5f);  // the scene's centre is at z = 0.5
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            sum += irradiance(*loaded.scene, lowered + Vec3((static_cast<float>(i) + 0.5f) / steps - 0.5f,
                                                            (static_cast<float>(j) + 0.5f) / steps - 0.5f, 0));
    return sum / (steps * steps);
}

TEST(LampMesh, TheLightOfASquareDoesNotDependOnItsFaces) {
    const std::string corners = "v -0.5 -0.5 1\nv 0.5 -0.5 1\nv 0.5 0.5 1\nv -0.5 0.5 1\n";
    const std::pair<const char*, std::string> lamps[] = {
        {"two triangles", corners + "f 1 3 2\nf 1 4 3\n"},
        {"a fan about the centre", corners + "v 0 0 1\nf 5 2 1\nf 5 1 4\nf 5 4 3\nf 5 3 2\n"},
        {"needles", corners + "f 1 3 2\nf 1 4 3\nf 1 1 2\nf 1 1 2\n"},
        {"a notch apart", corners + "v 0 0.4 1\nf 3 2 5 1 4\nf 1 5 2\n"},
        {"a byte order mark", "\xEF\xBB\xBF" + corners + "v -0.4 0.5 1\nf 1 4 3 2\n"}};
    const TemporaryFolder folder;
    for (const auto& [name, text] : lamps) {
        folder.write("lamp.obj", text);
        const auto loaded =
            load_in(folder, shape("rectangle", to_world(scale(3))) + shape("obj", filename("lamp.obj"), area_light(1)));
        EXPECT_NEAR(loaded.scene->emitted_power()[0], std::numbers::pi, 1e-5) << name;
        // The form factor of two parallel unit squares at distance 1 (Howell, configuration C-11) is 0.199825.
        EXPECT_NEAR(mean_irradiance(loaded) / std::numbers::pi, 0.199825, 5e-4) << name;
    }
}

}  // namespace
}  // namespace gib::test::polygon_test
