// Hard cases of geometry that are no single image: the same image in other units and elsewhere, rays to edges and
// vertices.

#include "tests/hard_cases.h"

#include <fmt/format.h>

namespace gib {
namespace {

using namespace test;

std::string number_text(double x) { return fmt::format("{}", x); }

/// The furnace of radiance 1 with everything in it that loses no light, put elsewhere.
LoadedScene placed_furnace(int exponent, const Vec3d& at) {
    return shipped_scene("hard/furnace.xml", {{{"e", std::to_string(exponent)},
                                               {"x", number_text(at.x())},
                                               {"y", number_text(at.y())},
                                               {"z", number_text(at.z())}},
                                              std::nullopt});
}

// The image of a scene in other units and at another place is the same image: no path but those that pass an edge
// within rounding takes another way.
TEST(HardGeometryOfEveryMethod, ImagesDependNeitherOnUnitsNorOnThePlace) {
    const Vec3d aside(1.1, -2.3, 1.7);
    for (const HardMethod& method : hard_methods()) {
        const LoadedScene scene = placed_furnace(0, Vec3d::Zero());
        if (!simulates(method.label, *scene.scene)) continue;
        const double expected = mean_of(render(scene, method.label, 4, 1, 1).total()).mean();
        for (const auto& [exponent, at] : std::vector<std::pair<int, Vec3d>>{{-12, Vec3d::Zero()},
                                                                             {-6, Vec3d::Zero()},
                                                                             {-3, Vec3d::Zero()},
                                                                             {3, Vec3d::Zero()},
                                                                             {6, Vec3d::Zero()},
                                                                             {12, Vec3d::Zero()},
                                                                             {0, 1e4 * aside},
                                                                             {0, 1e6 * aside},
                                                                             {-6, aside}}) {
            const Image image = render(placed_furnace(exponent, at), method.label, 4, 1, 1).total();
            EXPECT_NEAR(mean_of(image).mean() / expected, 1, 1e-3) << method.name << ' ' << exponent << ' ' << at;
        }
    }
}

// Rays from within a closed mesh to its vertices, the middles of its edges and points on them.
TEST(HardGeometryRays, EdgesAndVerticesOfAClosedMeshAreHit) {
    for (const double scale : {1e-9, 1.0, 1e9}) {
        const LoadedScene loaded = scene_of(
            scene_xml(camera(Place{}.view(Vec3d::Zero(), Vec3d::UnitZ()), 40, 4) +
                      shape("ply", "<transform name='to_world'><scale value='" + exact(scale) + "'/></transform>",
                            "<string name='filename' value='" + source_path("scenes/hard/sphere.ply") +
                                "'/><boolean name='face_normals' value='true'/>" + diffuse_bsdf(0.5))));
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

}  // namespace
}  // namespace gib
