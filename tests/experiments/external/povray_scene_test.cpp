// The form of a scene that POV-Ray takes: units of lamps, the camera, and what cannot be expressed. The last test renders
// with POV-Ray (scripts/packages-povray.txt).

#include "experiments/external/povray_scene.h"

#include "tests/support/csv_reader.h"
#include "tests/support/driver_fixtures.h"
#include "tests/support/input_error.h"

#include <numbers>
#include <regex>

namespace gib::test::povray_scene_test {
namespace {

/// A grey floor under a lamp of 2 x 1 and radiance 3, 6, 9 at height 4, with a red wall at one side; a line each.
const std::string lit_floor = shape("rectangle", to_world(scale(5), rotate('x', -90)), diffuse(0.5)) + "\n" +
                              shape("rectangle", to_world(scale(5), rotate('y', 90), translate(-4, 0, 0)),
                                    bsdf("twosided", one_sided("0.8,0.2,0.1"))) +
                              "\n" +
                              shape("rectangle", to_world(scale(1, 0.5, 1), rotate('x', 90), translate(0, 4, 0)),
                                    one_sided("0"), area_light("3,6,9")) +
                              "\n";

/// A camera that looks down on the floor, not straight.
std::string sensor_of(int width, int height, const std::string& filter = "box", const std::string& more = "") {
    return camera(50, more, to_world(look_at("2,6,8", "-0.5,1,0")),
                  element("film", "hdrfilm", integer("width", width), integer("height", height),
                          element("rfilter", filter))) +
           "\n";
}

std::string povray_text(const std::string& xml) {
    TemporaryFolder folder;
    const std::string path = folder.write("s.xml", xml);
    return povray_scene(load_scene(path), path, {});
}

std::string lit_scene(const std::string& body, const std::string& sensor = sensor_of(8, 6)) {
    return scene_xml(sensor + body);
}

/// The numbers between angle brackets behind `name`.
Vec3d vector_after(const std::string& text, const std::string& name) {
    std::smatch found;
    EXPECT_TRUE(std::regex_search(text, found, std::regex(name + R"( <([^,>]+),([^,>]+),([^,>]+)>)"))) << name;
    return {std::stod(found[1]), std::stod(found[2]), std::stod(found[3])};
}

// C = Le A / (2 pi d0^2) (povray_scene.h), with d0 = fade_distance.
TEST(PovrayScene, LampsHaveTheColorOfTheirRadianceAndArea) {
    const std::string text = povray_text(lit_scene(lit_floor));
    std::smatch found;
    ASSERT_TRUE(std::regex_search(text, found, std::regex("fade_distance ([^ ]+) fade_power 2")));
    const double d0 = std::stod(found[1]), expected = 3 * 2 / (2 * std::numbers::pi * d0 * d0);
    const Vec3d color = vector_after(text, "color rgb");
    EXPECT_NEAR(color[0], expected, 1e-5 * expected);
    EXPECT_NEAR(color[2], 3 * expected, 3e-5 * expected);
    EXPECT_THAT(text, HasSubstr("spotlight"));
    const Vec3d axis = vector_after(text, "area_light");
    EXPECT_NEAR(axis.norm(), axis.cwiseAbs()[0] > 1.5 ? 2 : 1, 1e-5);
}

TEST(PovrayScene, TheCameraHasTheRaysOfTheSensor) {
    const std::string xml = lit_scene(lit_floor, sensor_of(8, 6));
    const std::string text = povray_text(xml);
    const Vec3d direction = vector_after(text, "direction"), right = vector_after(text, "right"),
                up = vector_after(text, "up");
    const LoadedScene loaded = parse_scene(xml, "s.xml");
    for (const auto& [x, y] : {std::pair(0, 0), {7, 0}, {3, 4}, {6, 5}}) {
        const Ray ray = loaded.scene->sensor().generate_ray(x, y, Vec2(0.5f, 0.5f));
        const Vec3d ours = ray.d.cast<double>().normalized();
        const Vec3d theirs = (direction + ((x + 0.5) / 8 - 0.5) * right + (0.5 - (y + 0.5) / 6) * up).normalized();
        EXPECT_LT((ours - theirs).norm(), 1e-5) << x << " " << y;
        EXPECT_LT((vector_after(text, "location") - ray.o.cast<double>()).norm(), 1e-4);
    }
}

TEST(PovrayScene, GlassAndMirrorsAreAimedAt) {
    EXPECT_THAT(povray_text(lit_scene(lit_floor)), Not(HasSubstr("target")));
    const std::string text = povray_text(
        lit_scene(lit_floor + shape("sphere", bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1))) +
                  shape("sphere", center(3, 1, 0), bsdf("conductor", test::text("material", "none")))));
    EXPECT_THAT(text, HasSubstr("interior { ior 1.5 }"));
    EXPECT_THAT(text, HasSubstr("reflection { rgb <1,1,1> }"));
    const std::regex target("target reflection on refraction on");
    EXPECT_EQ(std::distance(std::sregex_iterator(text.begin(), text.end(), target), std::sregex_iterator()), 2);
}

TEST(PovrayScene, WhatCannotBeExpressedIsAnErrorAtItsPlace) {
    const std::string form = ": POV-Ray's form of a scene has ", near_clip = number("near_clip", 9);
    const std::vector<std::array<std::string, 3>> cases = {
        // elements, the sensor, the error
        {"\n<shape type='sphere'>\n<bsdf type='roughconductor'/></shape>", "",
         "s.xml:7:1" + form + "no such bsdf 'roughconductor'"},
        {shape("sphere", bsdf("diffuse", "<texture name='reflectance' type='checkerboard'/>")), "",
         "s.xml:5:22" + form + "no such bsdf 'diffuse'"},
        {shape("sphere", bsdf("conductor", test::text("material", "Au"))), "", "no such bsdf 'conductor'"},
        {"<shape type='disk'/>", "", "s.xml:5:1" + form + "no shape 'disk'"},
        {shape("sphere", area_light(1)), "", "s.xml:5:22" + form + "area emitters on parallelograms"},
        {emitter("constant"), "", "s.xml:5:1" + form + "only the emitters 'area' and 'point'"},
        {"", sensor_of(8, 6, "gaussian"), "has only the rfilter 'box'"},
        {"", sensor_of(8, 6, "box", near_clip), "near_clip"},
        {"<shape type='shapegroup' id='g'>" + shape("sphere") + "</shape>", "",
         "s.xml:5:1" + form + "no 'shapegroup'"}};
    for (const auto& [body, sensor, error] : cases)
        EXPECT_THAT(
            input_error_in(
                "s.xml", [&] { povray_text(lit_scene(lit_floor + body, sensor.empty() ? sensor_of(8, 6) : sensor)); }),
            HasSubstr(error));
}

// The direct light of POV-Ray on diffuse polygons is that of `path max_depth=2`: within 1 % in the mean, and within 10 % as a
// relative RMSE. The edges of the lamp make 5 % of it; a mirrored, shifted or two-sided image has more than 100 %.
TEST(PovrayRun, DirectLightAgreesWithPathTracing) {
    if (std::system("command -v povray >/dev/null") != 0) GTEST_SKIP() << "there is no povray";
    TemporaryFolder folder;
    folder.write("floor.xml", lit_scene(lit_floor + shape("sphere", center(1.5, 0.8, 1), radius(0.8), bsdf("diffuse")),
                                        sensor_of(48, 32)));
    folder.write("e.toml",
                 "scenes = ['floor.xml']\nseeds = 2\n[reference]\nmethod = 'path max_depth=2'\ntarget = '1%'\n"
                 "[[method]]\nname = 'povray'\nscene_format = 'povray'\n"
                 "command = 'povray +I{scene} +O{out} +W{width} +H{height} +WT{threads} +FE -D -GA +A0.0 +AM1 +R4 "
                 "Declare=LampPoints=8'\n");
    ASSERT_THAT(run_gibench("run e.toml --threads 1", folder / ""), exits(0));
    const CsvTable table = parse_csv(read_file(folder / "results/e/table.csv"), "table.csv");
    const auto field = [&](const std::string& column) { return std::stod(field_of(table, column)); };
    EXPECT_NEAR(field("energy_excess"), 0, 0.01);
    EXPECT_LT(std::sqrt(field("rel_mse")), 0.1);
    EXPECT_GT(field("peak_rss_mib"), 5);
}

}  // namespace
}  // namespace gib::test::povray_scene_test
