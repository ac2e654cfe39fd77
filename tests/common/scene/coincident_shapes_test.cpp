// Tests of surfaces in the same place, of which a scene accepts some, lifts lamps off others and refuses the rest.

#include "common/scene/coincident_shapes.h"

#include "tests/support/scene_errors.h"

namespace gib::test::coincident_shapes_test {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

std::string sphere(const std::string& material) { return shape("sphere", material) + "\n"; }
const std::string crown = glass(1.5), water = glass(1.33), grey = bsdf("diffuse"), glow = area_light(1);
std::string blend(const std::string& first, const std::string& second) {
    return bsdf("blendbsdf", number("weight", 0.5), first, second);
}
/// The error of a scene with two spheres in one place, on the lines 2 and 3.
std::string error_of(const std::string& material, const std::string& other) {
    return scene_error(sphere(material) + sphere(other));
}

TEST(CoincidentShapes, InterfacesThatRefractAlikeAreSeenAsOne) {
    for (const auto& [a, b] : Pairs{{crown, crown}, {crown, grey}, {grey, grey}, {blend(crown, grey), crown}})
        EXPECT_EQ(error_of(a, b), "no error") << a << b;
    EXPECT_EQ(scene_error(shape("sphere", center(9, 0, 0), water) + sphere(crown)), "no error") << "apart";
}

TEST(CoincidentShapes, InterfacesThatRefractOtherwiseAreRefused) {
    const std::string rough = bsdf("roughdielectric", number("int_ior", 1.33));
    const std::string dispersive = bsdf("dielectric", number("int_ior", 1.5), number("cauchy_b", 0.01));
    const std::string masked = bsdf("mask", number("opacity", 0.5), water);
    for (const auto& [a, b] : Pairs{{crown, water},
                                    {crown, rough},
                                    {crown, dispersive},
                                    {blend(grey, crown), water},
                                    {blend(water, crown), water},
                                    {masked, crown}})
        EXPECT_THAT(error_of(a, b), HasSubstr("t.xml:3:1: this surface lies exactly in the place of the one at line 2, "
                                              "which refracts otherwise"))
            << a << b;
}

TEST(CoincidentShapes, GroupsAreLookedInto) {
    const auto group = [&](const std::string& other) {
        return with_id("shape", "shapegroup", "g", "\n", sphere(crown), sphere(other)) +
               shape("instance", reference("g"));
    };
    EXPECT_EQ(scene_error(group(crown)), "no error");
    expect_errors({{group(water), "4:1", "this surface lies exactly"}});
}

TEST(CoincidentShapes, CurvedLampsInOtherSurfacesAreRefused) {
    const std::string message = "this lamp lies exactly in the place of the surface at line ";
    expect_errors({{sphere(glow) + sphere(grey), "2:1", message + "3: which of them"},
                   {sphere(grey) + sphere(glow), "3:1", message + "2: which of them"}});
}

TEST(CoincidentShapes, LampsMayStandOnSurfaces) {
    EXPECT_EQ(scene_error(shape("cube") + shape("cube", to_world(translate(0, 0, 2)), glow)), "no error");
    EXPECT_THAT(scene_error(shape("cube") + shape("cube", glow)),
                HasSubstr("this lamp lies exactly in the place of the surface"));
}

std::string placed(const std::string& type, const std::string& operations, const std::string& inside) {
    return shape(type, to_world(operations), inside);
}

// A flat lamp in the plane of a wall, of the wall's size or smaller, at any angle and place, is lifted off the wall
// so that rays find it, but by less than 1e-5 of the scene's size.
TEST(CoincidentShapes, FlatLampsAreLiftedOffOtherSurfaces) {
    const std::string turn = "<rotate x='1' y='2' z='3' angle='50'/>";
    for (const std::string& place :
         {std::string(), turn, translate(7, 8, 9), turn + translate(700, -800, 900), scale(1e-6)})
        for (const std::string kind : {"rectangle", "disk"})
            for (const std::string& size : {scale(0.2) + translate(0.3, 0.1, 0), std::string()}) {
                const LoadedScene loaded = load(placed("rectangle", place, grey) + placed(kind, size + place, glow) +
                                                placed("rectangle", translate(3, 0, -1) + place, grey));
                const auto& scene = *loaded.scene;
                const Shape& lamp = scene.shapes()[1];
                const auto* disk = std::get_if<Disk>(&lamp);
                const Frame frame(disk ? disk->normal
                                       : Vec3(std::get<Mesh>(lamp).normal_of(0).stableNormalized().cast<float>()));
                const Vec3 middle = bounds_of(lamp).center();
                const float diameter = bounds_of(lamp).diagonal();
                const Vec3 in_wall = std::get<Mesh>(scene.shapes()[0]).vertex(0);
                EXPECT_NEAR((middle - in_wall).dot(frame.n) / scene.diagonal(), 0, 1e-5) << place << kind << size;
                for (std::uint32_t i = 0; i < 1000; ++i) {
                    const Sampler u(PointSet::independent, 1, i, 0);
                    const Vec2 aside = u.get_2d(0);
                    const Vec3 from = middle + diameter * frame.to_world(Vec3(aside.x(), aside.y(), 0.5f));
                    const auto light = scene.sample_light(from, 0.5f, u.get_2d(2));
                    ASSERT_TRUE(light);
                    const auto hit = scene.intersect({from, light->wi});
                    ASSERT_TRUE(hit);
                    EXPECT_TRUE(hit->emitter) << place << kind << size;
                }
            }
}

// A lamp that only touches a wall with its edge, or is 0.01 away from it, is not moved.
TEST(CoincidentShapes, OtherLampsStayWhereTheyAre) {
    for (const auto& [wall, above] :
         {std::pair(rotate('y', 90) + translate(1, 0, 0), 1.f), std::pair(translate(0, 0, 0.01), -0.01f)}) {
        const LoadedScene loaded = load(placed("rectangle", "", glow) + placed("rectangle", wall, grey));
        const auto& lamp = std::get<Mesh>(loaded.scene->shapes()[0]);
        const auto& other = std::get<Mesh>(loaded.scene->shapes()[1]);
        const float lowest = std::min(other.vertex(0).z(), other.vertex(2).z());
        EXPECT_NEAR(lamp.vertex(0).z() - lowest, above, 1e-9f) << wall;
    }
}

// Where two cubes of glass touch, a path meets only one of the two faces, so that its
// medium behind them is undefined.
TEST(CoincidentShapes, InterfacesThatFaceEachOtherAreRefused) {
    for (const std::string axis : {"x", "y", "z"}) {
        const auto beside = [&](const std::string& by, const std::string& inside) {
            return placed("cube", "<translate " + axis + "='" + by + "'/>", inside);
        };
        expect_errors({{beside("0", crown) + "\n" + beside("2", crown), "3:1",
                        "this surface lies exactly in the place of the one at line 2, which faces the other way"}});
        EXPECT_EQ(scene_error(beside("0", crown) + beside("2.001", crown)), "no error");
        EXPECT_EQ(scene_error(beside("0", crown) + beside("2", grey)), "no error");
    }
}

TEST(CoincidentShapes, BoundariesOfDifferentMediaAreRefused) {
    const auto fog = [](double density) {
        return bsdf("null") + named("medium", "interior", "homogeneous", rgb("sigma_t", density), rgb("albedo", 0.5));
    };
    EXPECT_THAT(error_of(fog(1), crown), HasSubstr("which refracts otherwise"));
    EXPECT_THAT(error_of(fog(1), fog(2)), HasSubstr("which bounds another medium"));
    EXPECT_EQ(error_of(fog(1), grey), "no error");
}

TEST(CoincidentShapes, LampsAreRefusedInOneFileAndInTwo) {
    const std::string lamp = shape("sphere", glow);
    expect_errors({{lamp + "\n" + lamp, "3:1", "this lamp lies exactly in the place of the one at line 2"}});
    const TemporaryFolder folder;
    const std::string part = folder.write("part.xml", "<scene>\n\n" + lamp + "</scene>");
    EXPECT_THAT(scene_error("<include filename='part.xml'/>" + lamp, folder / "main.xml"),
                HasSubstr("main.xml:2:31: this lamp lies exactly in the place of the one at " + part + ":3:"));
}

/// The error of a lamp with the corners (-1, -1), (1, -1), (1, 1), (-1, 1), the centre and (0, -1) of a square.
std::string error_of_lamp(const std::string& faces) {
    const TemporaryFolder folder;
    folder.write("lamp.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 0\nv 0 -1 0\n" + faces);
    return scene_error(shape("obj", filename("lamp.obj"), glow), folder / "main.xml");
}

TEST(CoincidentShapes, FansAboutAnInnerPointAreNoLampTwice) {
    // Two neighbours make a triangle with the centre in the middle of a side, or a quadrilateral that is not convex.
    EXPECT_EQ(error_of_lamp("f 5 2 1\nf 5 1 4\nf 5 4 3\nf 5 3 2\n"), "no error");
    EXPECT_EQ(error_of_lamp("f 5 4 6\nf 5 6 3\nf 5 3 4\n"), "no error");
}

TEST(CoincidentShapes, TrianglesWithoutAreaAreNoLampTwice) {
    EXPECT_EQ(error_of_lamp("f 1 2 3\nf 1 1 2\nf 1 1 2\nf 1 6 2\nf 1 6 2\n"), "no error");
    EXPECT_THAT(error_of_lamp("f 1 2 3\nf 1 1 2\nf 3 1 2\n"), HasSubstr("this lamp has a triangle twice"));
    // Both halves along the other diagonal.
    EXPECT_THAT(error_of_lamp("f 1 2 3 4\nf 2 3 4\n"), HasSubstr("this lamp has a triangle twice"));
}

}  // namespace
}  // namespace gib::test::coincident_shapes_test
