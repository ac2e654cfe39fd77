// Tests of surfaces in the same place, of which a scene accepts some, lifts lamps off others and refuses the rest.

#include "common/scene/coincident_shapes.h"

#include "tests/support/input_error.h"
#include "tests/support/scene_text.h"

#include <gmock/gmock.h>

namespace gib::test::coincident_shapes_test {
namespace {

using ::testing::HasSubstr;

std::string sphere(const std::string& bsdf) { return shape("sphere", bsdf) + "\n"; }
std::string glass(const std::string& parameters) { return bsdf("dielectric", number("int_ior", 1.5), parameters); }
const std::string diffuse = bsdf("diffuse");
std::string blend(const std::string& first, const std::string& second) {
    return bsdf("blendbsdf", number("weight", 0.5), first, second);
}
std::string masked(const std::string& nested) { return bsdf("mask", number("opacity", 0.5), nested); }
/// The error of a scene with two spheres in one place.
std::string error_of(const std::string& bsdf, const std::string& other_bsdf) {
    return input_error_of([&] { load(sphere(bsdf) + sphere(other_bsdf)); });
}

TEST(CoincidentShapes, InterfacesThatRefractAlikeAreSeenAsOne) {
    const std::string water = bsdf("dielectric", number("int_ior", 1.33));
    for (const auto& [a, b] : std::vector<std::pair<std::string, std::string>>{
             {glass(""), glass("")}, {glass(""), diffuse}, {diffuse, diffuse}, {blend(glass(""), diffuse), glass("")}})
        EXPECT_EQ(error_of(a, b), "no error") << a << b;
    EXPECT_EQ(input_error_of([&] { load(shape("sphere", center(9, 0, 0), water) + sphere(glass(""))); }), "no error")
        << "apart";
}

TEST(CoincidentShapes, InterfacesThatRefractOtherwiseAreRefused) {
    const std::string water = bsdf("dielectric", number("int_ior", 1.33));
    const std::string rough = bsdf("roughdielectric", number("int_ior", 1.33));
    const std::string dispersive = glass(number("cauchy_b", 0.01));
    for (const auto& [a, b] : std::vector<std::pair<std::string, std::string>>{{glass(""), water},
                                                                               {glass(""), rough},
                                                                               {glass(""), dispersive},
                                                                               {blend(diffuse, glass("")), water},
                                                                               {blend(water, glass("")), water},
                                                                               {masked(water), glass("")}})
        EXPECT_THAT(error_of(a, b),
                    HasSubstr("test.xml:3:1: this surface lies exactly in the place of the one at line 2, "
                              "which refracts otherwise"))
            << a << b;
}

TEST(CoincidentShapes, GroupsAreLookedInto) {
    const std::string water = bsdf("dielectric", number("int_ior", 1.33));
    const auto group = [&](const std::string& other) {
        return with_id("shape", "shapegroup", "g", "\n", sphere(glass("")), sphere(other)) +
               shape("instance", reference("g"));
    };
    EXPECT_EQ(input_error_of([&] { load(group(glass(""))); }), "no error");
    EXPECT_THAT(input_error_of([&] { load(group(water)); }), HasSubstr("test.xml:4:1: this surface lies exactly"));
}

const std::string emitter = area_light(1);

TEST(CoincidentShapes, CurvedLampsInOtherSurfacesAreRefused) {
    EXPECT_THAT(error_of(emitter, diffuse),
                HasSubstr("test.xml:2:1: this lamp lies exactly in the place of the surface at line 3: which of them"));
    EXPECT_THAT(error_of(diffuse, emitter),
                HasSubstr("test.xml:3:1: this lamp lies exactly in the place of the surface at line 2: which of them"));
}

TEST(CoincidentShapes, LampsMayStandOnSurfaces) {
    const std::string cube = "<shape type='cube'>";
    const std::string above = to_world(translate(0, 0, 2));
    EXPECT_EQ(input_error_of([&] { load(cube + "</shape>" + cube + above + emitter + "</shape>"); }), "no error");
    EXPECT_THAT(input_error_of([&] { load(cube + "</shape>" + cube + emitter + "</shape>"); }),
                HasSubstr("this lamp lies exactly in the place of the surface"));
}

std::string placed(const std::string& type, const std::string& operations, const std::string& inside) {
    return shape(type, to_world(operations), inside);
}

// A flat lamp in the plane of a wall, of the wall's size or smaller, at any angle and place, is lifted off the wall
// so that rays find it, but by less than 1e-5 of the scene's size.
TEST(CoincidentShapes, FlatLampsAreLiftedOffOtherSurfaces) {
    for (const std::string place : {"", "<rotate x='1' y='2' z='3' angle='50'/>", translate(7, 8, 9),
                                    "<rotate x='1' y='2' z='3' angle='50'/>" + translate(700, -800, 900), scale(1e-6)})
        for (const std::string kind : {"rectangle", "disk"})
            for (const std::string size : {scale(0.2) + translate(0.3, 0.1, 0), ""}) {
                const LoadedScene loaded =
                    load(placed("rectangle", place, diffuse) + placed(kind, size + place, emitter) +
                         placed("rectangle", translate(3, 0, -1) + place, diffuse));
                const Scene& scene = *loaded.scene;
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
    for (const std::string wall : {rotate('y', 90) + translate(1, 0, 0), translate(0, 0, 0.01)}) {
        const LoadedScene loaded = load(placed("rectangle", "", emitter) + placed("rectangle", wall, diffuse));
        const auto& lamp = std::get<Mesh>(loaded.scene->shapes()[0]);
        const auto& other = std::get<Mesh>(loaded.scene->shapes()[1]);
        const float lowest = std::min(other.vertex(0).z(), other.vertex(2).z());
        EXPECT_NEAR(lamp.vertex(0).z() - lowest, wall.find("0.01") == std::string::npos ? 1.f : -0.01f, 1e-9f) << wall;
    }
}

// Where two cubes of glass touch, a path meets only one of the two faces, so that its
// medium behind them is undefined.
TEST(CoincidentShapes, InterfacesThatFaceEachOtherAreRefused) {
    for (const std::string axis : {"x", "y", "z"}) {
        const auto beside = [&](const std::string& by, const std::string& inside) {
            return placed("cube", "<translate " + axis + "='" + by + "'/>", inside);
        };
        EXPECT_THAT(input_error_of([&] { load(beside("0", glass("")) + "\n" + beside("2", glass(""))); }),
                    HasSubstr("test.xml:3:1: this surface lies exactly in the place of the one at line 2, which faces "
                              "the other way"))
            << axis;
        EXPECT_EQ(input_error_of([&] { load(beside("0", glass("")) + beside("2.001", glass(""))); }), "no error");
        EXPECT_EQ(input_error_of([&] { load(beside("0", glass("")) + beside("2", diffuse)); }), "no error");
    }
}

TEST(CoincidentShapes, BoundariesOfDifferentMediaAreRefused) {
    const auto fog = [](const std::string& density) {
        return bsdf("null") + named("medium", "interior", "homogeneous", rgb("sigma_t", density), rgb("albedo", 0.5));
    };
    EXPECT_THAT(error_of(fog("1"), glass("")), HasSubstr("which refracts otherwise"));
    EXPECT_THAT(error_of(fog("1"), fog("2")), HasSubstr("which bounds another medium"));
    EXPECT_EQ(error_of(fog("1"), diffuse), "no error");
}

TEST(CoincidentShapes, LampsAreRefusedInOneFileAndInTwo) {
    const std::string lamp = shape("sphere", area_light(1));
    EXPECT_THAT(input_error_of([&] { load(lamp + "\n" + lamp); }),
                HasSubstr("test.xml:3:1: this lamp lies exactly in the place of the one at line 2"));
    const TemporaryFolder folder;
    const std::string part = folder.write("part.xml", "<scene>\n\n" + lamp + "</scene>");
    const std::string text = scene_with("<include filename='part.xml'/>" + lamp);
    EXPECT_THAT(input_error_of([&] { parse_scene(text, folder / "main.xml"); }),
                HasSubstr("main.xml:2:31: this lamp lies exactly in the place of the one at " + part + ":3:"));
}

/// The error of a lamp with the corners (-1, -1), (1, -1), (1, 1), (-1, 1), the centre and (0, -1) of a square.
std::string error_of_lamp(const std::string& faces) {
    const TemporaryFolder folder;
    folder.write("lamp.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 0\nv 0 -1 0\n" + faces);
    return input_error_of(
        [&] { parse_scene(scene_with(shape("obj", filename("lamp.obj"), emitter)), folder / "main.xml"); });
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
