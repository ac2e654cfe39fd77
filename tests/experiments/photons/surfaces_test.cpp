// A scene's surfaces as triangles: their places, colours and shares.
#include "experiments/photons/surfaces.h"

#include "tests/support/scene_fixtures.h"

#include <cmath>

namespace gib::test::surfaces_test {
namespace {

const std::string camera = "<sensor type='perspective'>" + box_film(4) + "</sensor>";

Vec3 point(const SurfaceTriangles& t, std::size_t i) {
    return {t.positions[i][0], t.positions[i][1], t.positions[i][2]};
}

double area_of(const SurfaceTriangles& t) {
    double area = 0;
    for (std::size_t i = 0; i < t.positions.size(); i += 3)
        area += 0.5 * static_cast<double>((point(t, i + 1) - point(t, i)).cross(point(t, i + 2) - point(t, i)).norm());
    return area;
}

TEST(SurfaceTriangles, CoverCurvedShapes) {
    const std::pair<const char*, double> shapes[] = {
        {"<shape type='sphere'><point name='center' x='1' y='2' z='3'/><float name='radius' value='2'/>",
         16 * std::numbers::pi},
        {"<shape type='disk'><transform name='to_world'><scale value='3'/></transform>", 9 * std::numbers::pi},
        {"<shape type='cylinder'><point name='p0' x='0' y='0' z='0'/><point name='p1' x='0' y='0' z='4'/><float "
         "name='radius' value='0.5'/>",
         4 * std::numbers::pi}};
    for (const auto& [shape, area] : shapes) {
        const auto scene = scene_of(scene_xml(camera + shape + diffuse(0.5) + "</shape>"));
        const SurfaceTriangles triangles = surface_triangles(*scene.scene, 100000);
        EXPECT_NEAR(area_of(triangles), area, 0.005 * area) << shape;
        EXPECT_GE(triangles.whole, triangles.count());
        for (const auto& color : triangles.colors)
            EXPECT_EQ(color, (std::array<std::uint8_t, 4>{128, 128, 128, 255}));
    }
}

TEST(SurfaceTriangles, OfInstancesStandInTheirPlaces) {
    const auto scene = scene_of(scene_xml(
        camera + "<shape type='shapegroup' id='g'><shape type='sphere'>" + diffuse(0.5) +
        "</shape></shape><shape type='instance'><transform name='to_world'><scale value='2'/><translate x='10'/>"
        "</transform><ref id='g'/></shape>"));
    const SurfaceTriangles triangles = surface_triangles(*scene.scene, 100000);
    ASSERT_GT(triangles.count(), 100u);
    for (std::size_t i = 0; i < triangles.positions.size(); ++i) {
        const Vec3 from_center = point(triangles, i) - scene.scene->bounds().center();
        EXPECT_NEAR(from_center.norm(), 2.f, 1e-4f);
        EXPECT_NEAR(from_center.x() / 2, triangles.normals[i][0] / 127.f, 0.006f);
    }
}

TEST(SurfaceTriangles, SayWhatIsOpaqueAndHowManyAreLeftOut) {
    const auto glass = shipped_scene("cornell-glass.xml", {{}, std::pair{4, 4}});
    const SurfaceTriangles all = surface_triangles(*glass.scene, 100000);
    EXPECT_GT(all.opaque, 0u);
    EXPECT_LT(all.opaque, all.count()) << "glass";
    EXPECT_TRUE(std::any_of(all.colors.begin(), all.colors.end(), [](const auto& c) {
        return c[0] == 255 && c[1] > c[2];  // the lamp
    }));
    const SurfaceTriangles few = surface_triangles(*glass.scene, 100);
    EXPECT_LE(few.count(), 100u);
    EXPECT_GT(few.count(), 60u);
    EXPECT_EQ(few.whole, all.whole);
}

}  // namespace
}  // namespace gib::test::surfaces_test
