// Normals between creases.

#include "common/mesh_files/smooth_angle.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gib::test::smooth_angle_test {
namespace {

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

}  // namespace
}  // namespace gib::test::smooth_angle_test
