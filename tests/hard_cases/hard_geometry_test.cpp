// Hard cases of geometry that no single image shows: rays to edges and vertices, cameras on
// surfaces.

#include "common/scene/scene.h"
#include "common/shapes/shape.h"
#include "tests/support/hard_cases.h"
#include "tests/support/random.h"
#include "tests/support/scene_fixtures.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gib::hard_geometry_test {
namespace {

using namespace test;

// Rays go from inside a closed mesh to its vertices, the middles of its edges and points on them.
TEST(HardGeometryRays, EdgesAndVerticesOfAClosedMeshAreHit) {
    for (const double scale : {1e-9, 1.0, 1e9}) {
        const LoadedScene loaded =
            scene_of(scene_xml(camera(40, box_film(4)) + shape("ply", to_world(test::scale(scale)),
                                                               text("filename", source_path("scenes/hard/sphere.ply")),
                                                               flag("face_normals"), diffuse_bsdf(0.5))));
        const auto& mesh = std::get<Mesh>(loaded.scene->shapes().front());
        int rays = 0;
        for (const Vec3& from : {Vec3(0, 0, 0), Vec3(0.31f, 0.22f, -0.17f), Vec3(0, 0.5f, 0)})
            for (const auto& triangle : mesh.triangles)
                for (int corner = 0; corner < 3; ++corner)
                    for (const float along : {0.f, 0.25f, 0.5f}) {
                        const Vec3 a = mesh.vertex(triangle[static_cast<std::size_t>(corner)]),
                                   b = mesh.vertex(triangle[static_cast<std::size_t>((corner + 1) % 3)]);
                        const Vec3 o = static_cast<float>(scale) * from, to = a + along * (b - a) - o;
                        ++rays;
                        EXPECT_TRUE(loaded.scene->intersect({o, to.stableNormalized()}))
                            << scale << ' ' << to.transpose();
                        EXPECT_TRUE(loaded.scene->occluded({o, 2.f * to, 0.f, 1.f})) << scale << ' ' << to.transpose();
                    }
        EXPECT_GT(rays, 5000);
    }
}

/// A shape and a camera on it, at `from` in the shape's own coordinates, under a sky of radiance 1.
LoadedScene camera_on(const std::string& shape_text, const Place& place, const Vec3d& from, const Vec3d& towards) {
    return test::Scene(camera(90, place.view(from, from + towards), box_film(8)), shape_text, constant_light(1)).load();
}

/// The smallest and the largest value of all pixels and channels.
std::pair<float, float> range_of(const LoadedScene& scene) {
    const Image image = render(scene, "path", 2).total();
    float least = infinity, most = -infinity;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        least = std::min(least, image.at(i).minCoeff());
        most = std::max(most, image.at(i).maxCoeff());
    }
    return {least, most};
}

// If a point lies beyond the neighbouring face, a ray that leaves it starts outside. Unless points
// are kept off edges, about half of those on the edges of a turned cube lie outside, and one in
// ten million paths leaks from a closed room.
TEST(HardGeometryRays, PointsOnTheEdgesOfAConvexMeshLieWithin) {
    Random random(5);
    for (int turn = 0; turn < 200; ++turn) {
        const Eigen::Matrix3d to_world =
            Eigen::AngleAxisd(7. * random.next(), random.direction().cast<double>()).toRotationMatrix();
        Mesh cube;
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d at(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            const Vec3 p = (to_world * at).cast<float>();
            cube.vertices.push_back({p.x(), p.y(), p.z()});
        }
        cube.vertices.push_back({});  // the padding
        cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
        for (std::size_t i = 0; i < cube.triangles.size(); ++i) {
            const float u = random.next();
            for (const Vec2& b : {Vec2(u, 0.f), Vec2(0.f, u), Vec2(u, 1.f - u), Vec2(0.f, 0.f), Vec2(1.f, 0.f)}) {
                const Vec3d p = cube.point_at(i, b.x(), b.y()).p.cast<double>();
                for (std::size_t j = 0; j < cube.triangles.size(); ++j) {
                    const Vec3d n = cube.normal_of(j).normalized();
                    if (n.dot(cube.normal_of(i).normalized()) > 0.5) continue;  // its own plane
                    const Vec3d from = cube.vertex(cube.triangles[j][0]).cast<double>();
                    ASSERT_LT(n.dot(p - from), 0) << "triangle " << i << ", weights " << b.transpose();
                }
            }
        }
    }
}

TEST(FrameAlong, IsOrthonormalForEveryDirection) {
    Random random(6);
    for (int i = 0; i < 10000; ++i) {
        const Vec3 n = random.direction(), other = random.direction();
        // If the direction is along n, its part across n is only rounding.
        for (const Vec3& direction :
             {other, n, Vec3(-n), Vec3(3.f * n), Vec3(n + 1e-7f * other), Vec3(1e-30f * other)}) {
            const Frame frame = frame_along(n, direction);
            ASSERT_NEAR(frame.s.norm(), 1, 1e-6);
            ASSERT_NEAR(frame.s.dot(n), 0, 1e-6) << n.transpose() << " along " << direction.transpose();
            ASSERT_NEAR((frame.t - n.cross(frame.s)).norm(), 0, 2e-6);
        }
    }
}

// A camera that lies on a lamp and looks away from it, to either side, sees the sky.
TEST(CameraOnASurface, SeesWhatIsBeyond) {
    const std::string bright = diffuse_bsdf(0.5) + area_light(100);
    const Vec3d up = Vec3d::UnitZ(), at(0.3, -0.2, 0), on_ball = Vec3d(1, 2, 2) / 3;
    for (const double scale : {1e-6, 1.0, 1e6})
        for (const double away : {0.0, 1e4}) {
            const Place place{scale, away * scale * Vec3d(1.1, -2.3, 1.7)};
            const auto expect_sky = [&](const std::string& kind, const Vec3d& from, const Vec3d& towards) {
                const auto [least, most] =
                    range_of(camera_on(shape(kind, place.transform(), bright), place, from, towards.normalized()));
                EXPECT_EQ(least, 1.f) << kind << ' ' << scale << ' ' << away << ' ' << towards;
                EXPECT_EQ(most, 1.f) << kind << ' ' << scale << ' ' << away << ' ' << towards;
            };
            for (const std::string kind : {"rectangle", "disk"})
                for (const Vec3d& towards : {up, Vec3d(-up), Vec3d(up + 0.9 * Vec3d::UnitX())})
                    expect_sky(kind, at, towards);
            expect_sky("cube", at + up, up);
            expect_sky("sphere", on_ball, on_ball);
        }
}

// A camera close above a large sphere, or close under its surface, is not on it. Distances are counted in roundings
// of the radius. From the front, the camera counts as on the surface within 2, the rounding of its own place, and it
// is 8 away. From behind, the sphere's own 24 are added (common/shapes/shape.cpp), and it is 30 away.
TEST(CameraOnASurface, SeesWhatItIsCloseTo) {
    const Vec3d on_ball = Vec3d(1, 2, 2) / 3;
    for (const double radius : {1e-3, 1.0, 1e3}) {
        const std::string lamp = sphere_at(Vec3d::Zero(), radius, diffuse_bsdf(0.5) + area_light(100));
        const auto above = range_of(camera_on(lamp, Place{}, (1 + 8 * 0x1p-24) * radius * on_ball, -on_ball));
        EXPECT_GT(above.first, 50.f) << radius;
        const auto below = range_of(camera_on(lamp, Place{}, (1 - 30 * 0x1p-24) * radius * on_ball, on_ball));
        EXPECT_EQ(below.second, 0.f) << radius;
    }
}

// A lossless body is invisible under an even sky, also from its own surface.
TEST(CameraOnASurface, IsOutsideOfGlass) {
    const Vec3d on_ball = Vec3d(1, 2, 2) / 3;
    for (const double side : {-1.0, 1.0}) {
        const auto [least, most] = range_of(
            camera_on(sphere_at(Vec3d::Zero(), 1, bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1))),
                      Place{}, on_ball, side * on_ball));
        EXPECT_NEAR(least, 1.f, 1e-5f) << side;
        EXPECT_NEAR(most, 1.f, 1e-5f) << side;
    }
}

}  // namespace
}  // namespace gib::hard_geometry_test
