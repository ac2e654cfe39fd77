// The form of a scene that POV-Ray takes: units of lamps, the camera, and what cannot be expressed. The last test renders
// with POV-Ray (scripts/packages-povray.txt).

#include "experiments/external/povray_scene.h"

#include "tests/support/csv_reader.h"
#include "tests/support/driver_fixtures.h"
#include "tests/support/input_error.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>
#include <regex>

namespace gib::test::povray_scene_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A grey floor under a lamp of 2 x 1 and radiance 3, 6, 9 at height 4, with a red wall at one side.
const std::string lit_floor =
    "<shape type='rectangle'><transform name='to_world'><scale value='5'/><rotate x='1' angle='-90'/></transform>"
    "<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='0.5'/></bsdf></bsdf></shape>\n"
    "<shape type='rectangle'><transform name='to_world'><scale value='5'/><rotate y='1' angle='90'/>"
    "<translate x='-4'/></transform><bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' "
    "value='0.8,0.2,0.1'/></bsdf></bsdf></shape>\n"
    "<shape type='rectangle'><transform name='to_world'><scale x='1' y='0.5'/><rotate x='1' angle='90'/>"
    "<translate y='4'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>"
    "<emitter type='area'><rgb name='radiance' value='3,6,9'/></emitter></shape>\n";

/// A camera that looks down on the floor, not straight.
std::string sensor_of(int width, int height, const std::string& filter = "box", const std::string& more = "") {
    return "<sensor type='perspective'><float name='fov' value='50'/>" + more +
           "<transform name='to_world'><lookat origin='2,6,8' target='-0.5,1,0' up='0,1,0'/></transform>"
           "<film type='hdrfilm'><integer name='width' value='" +
           std::to_string(width) + "'/><integer name='height' value='" + std::to_string(height) + "'/><rfilter type='" +
           filter + "'/></film></sensor>\n";
}

std::string povray_text(const std::string& xml) {
    TemporaryFolder folder;
    const std::string path = folder.write("s.xml", xml);
    return povray_scene(load_scene(path), scene_places(path, {}));
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
    const std::string plain = povray_text(lit_scene(lit_floor));
    EXPECT_THAT(plain, Not(HasSubstr("target")));
    const std::string text = povray_text(lit_scene(
        lit_floor +
        "<shape type='sphere'><bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' "
        "value='1'/></bsdf></shape><shape type='sphere'><point name='center' x='3' y='1' z='0'/><bsdf type='conductor'>"
        "<string name='material' value='none'/></bsdf></shape>"));
    EXPECT_THAT(text, HasSubstr("interior { ior 1.5 }"));
    EXPECT_THAT(text, HasSubstr("reflection { rgb <1,1,1> }"));
    const std::regex target("target reflection on refraction on");
    EXPECT_EQ(std::distance(std::sregex_iterator(text.begin(), text.end(), target), std::sregex_iterator()), 2);
}

TEST(PovrayScene, WhatCannotBeExpressedIsAnErrorAtItsPlace) {
    const auto error = [](const std::string& body, const std::string& sensor = sensor_of(8, 6)) {
        const std::string what = input_error_of([&] { povray_text(lit_scene(body, sensor)); });
        const std::size_t place = what.find("s.xml");
        return place == std::string::npos ? what : what.substr(place);
    };
    const std::string sphere = "<shape type='sphere'>";
    EXPECT_THAT(error(lit_floor + "\n" + sphere + "\n<bsdf type='roughconductor'/></shape>"),
                HasSubstr("s.xml:7:1: POV-Ray's form of a scene has no such bsdf 'roughconductor'"));
    EXPECT_THAT(error(lit_floor + sphere +
                      "<bsdf type='diffuse'><texture name='reflectance' type='checkerboard'/>"
                      "</bsdf></shape>"),
                HasSubstr("s.xml:5:22: POV-Ray's form of a scene has no such bsdf 'diffuse'"));
    EXPECT_THAT(
        error(lit_floor + sphere + "<bsdf type='conductor'><string name='material' value='Au'/></bsdf></shape>"),
        HasSubstr("no such bsdf 'conductor'"));
    EXPECT_THAT(error(lit_floor + "<shape type='disk'/>"),
                HasSubstr("s.xml:5:1: POV-Ray's form of a scene has no shape 'disk'"));
    EXPECT_THAT(error(lit_floor + sphere + "<emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>"),
                HasSubstr("s.xml:5:22: POV-Ray's form of a scene has area emitters on parallelograms"));
    EXPECT_THAT(error(lit_floor + "<emitter type='constant'/>"),
                HasSubstr("s.xml:5:1: POV-Ray's form of a scene has only the emitters 'area' and 'point'"));
    EXPECT_THAT(error(lit_floor, sensor_of(8, 6, "gaussian")), HasSubstr("has only the rfilter 'box'"));
    EXPECT_THAT(error(lit_floor, sensor_of(8, 6, "box", "<float name='near_clip' value='9'/>")),
                HasSubstr("near_clip"));
    EXPECT_THAT(error(lit_floor + "<shape type='shapegroup' id='g'>" + sphere + "</shape></shape>"),
                HasSubstr("s.xml:5:1: POV-Ray's form of a scene has no 'shapegroup'"));
}

// The direct light of POV-Ray on diffuse polygons is that of `path max_depth=2`: within 1 % in the mean, and within 10 % as a
// relative RMSE. The edges of the lamp make 5 % of it; a mirrored, shifted or two-sided image has more than 100 %.
TEST(PovrayRun, DirectLightAgreesWithPathTracing) {
    if (std::system("command -v povray >/dev/null") != 0) GTEST_SKIP() << "there is no povray";
    TemporaryFolder folder;
    folder.write("floor.xml", lit_scene(lit_floor + "<shape type='sphere'><point name='center' x='1.5' y='0.8' z='1'/>"
                                                    "<float name='radius' value='0.8'/><bsdf type='diffuse'/></shape>",
                                        sensor_of(48, 32)));
    folder.write("e.toml",
                 "scenes = ['floor.xml']\nseeds = 2\n[reference]\nmethod = 'path max_depth=2'\ntarget = '1%'\n"
                 "[[method]]\nname = 'povray'\nscene_format = 'povray'\n"
                 "command = 'povray +I{scene} +O{out} +W{width} +H{height} +WT{threads} +FE -D -GA +A0.0 +AM1 +R4 "
                 "Declare=LampPoints=8'\n");
    const ProgramResult result = run_gibench("run e.toml --threads 1", folder / "");
    ASSERT_EQ(result.code, 0) << result.err;
    const CsvTable table = parse_csv(read_file(folder / "results/e/table.csv"), "table.csv");
    const auto field = [&](const std::string& column) {
        const auto at = std::find(table.columns.begin(), table.columns.end(), column) - table.columns.begin();
        return std::stod(table.rows.at(0).at(static_cast<std::size_t>(at)));
    };
    EXPECT_NEAR(field("energy_excess"), 0, 0.01);
    EXPECT_LT(std::sqrt(field("rel_mse")), 0.1);
    EXPECT_GT(field("peak_rss_mib"), 5);
}

}  // namespace
}  // namespace gib::test::povray_scene_test
