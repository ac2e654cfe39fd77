// Wrong <emitter> elements: each is an error that names the place and what would be right.

#include "common/core/error.h"
#include "tests/support/input_error.h"
#include "tests/support/light_fixtures.h"

#include <gmock/gmock.h>

#include <limits>

namespace gib::test::emitter_error_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string error_of(const std::string& body, const std::string& path = "t.xml") {
    return input_error_of([&] { parse_scene(scene_with(body), path); });
}

/// The <emitter> starts on line 3, its parameters on line 4.
std::string emitter(const std::string& type, const std::string& parameters) {
    return "<shape type='sphere'/>\n<emitter type='" + type + "'>\n" + parameters + "</emitter>";
}

std::string area(const std::string& parameters) {
    return "<shape type='sphere'>\n<emitter type='area'>\n" + parameters + "</emitter></shape>";
}

struct Row {
    std::string body;
    std::string place;  ///< "line:column"
    std::string message;
};

void expect_errors(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
        EXPECT_THAT(error_of(row.body), StartsWith("t.xml:" + row.place + ": ")) << row.body;
        EXPECT_THAT(error_of(row.body), HasSubstr(row.message)) << row.body;
    }
}

std::string number(const std::string& name, const std::string& value) {
    return "<float name='" + name + "' value='" + value + "'/>";
}
std::string to_world(const std::string& operation) {
    return "<transform name='to_world'>" + operation + "</transform>";
}

const std::string squares = "<texture name='texture' type='checkerboard'/>";

TEST(EmitterErrors, Plugins) {
    expect_errors({{emitter("moon", ""), "3:10",
                    "the emitter 'moon' is not supported; supported are: point, spot, projector, directional, "
                    "constant, envmap, sunsky, sky, sun, area"},
                   {emitter("area", ""), "3:1", "must stand in a shape"},
                   {"<shape type='sphere'>\n<emitter type='constant'/></shape>", "3:10", "supported are: area"}});
}

TEST(EmitterErrors, UnknownParametersAndWrongKinds) {
    for (const char* type : {"point", "spot", "directional", "constant"}) {
        expect_errors({{emitter(type, number("power", "1")), "4:1", "does not take a parameter 'power'; it takes: "},
                       {emitter(type, "<medium type='homogeneous'/>"), "4:1", "does not take a <medium>"},
                       {emitter(type, number("sampling_weight", "0")), "4:31", "'sampling_weight' must be above 0"}});
    }
    expect_errors(
        {{area(number("power", "1")), "4:1", "does not take a parameter 'power'; it takes: sampling_weight, radiance"},
         {area(to_world("<scale value='2'/>")), "4:1", "does not take a parameter 'to_world'"},
         {area(number("sampling_weight", "-1")), "4:31", "must be above 0"},
         {emitter("spot", "<string name='cutoff_angle' value='20'/>"), "4:1", "'cutoff_angle' cannot be a <string>"},
         {emitter("spot", "<texture type='checkerboard'/>"), "4:1", "does not take a <texture>"},
         {emitter("directional", "<rgb name='direction' value='1 0 0'/>"), "4:1", "'direction' cannot be a <rgb>"},
         {emitter("constant", to_world("<scale value='2'/>")), "4:1", "does not take a parameter 'to_world'"}});
}

TEST(EmitterErrors, Colours) {
    const std::pair<const char*, const char*> colours[] = {
        {"point", "intensity"}, {"spot", "intensity"}, {"directional", "irradiance"}, {"constant", "radiance"}};
    for (const auto& [type, name] : colours) {
        const std::string rgb = std::string("<rgb name='") + name + "' value='";
        const std::string value = "4:" + std::to_string(14 + std::string(name).size());
        expect_errors({{emitter(type, rgb + "1 -1 1'/>"), value, std::string("'") + name + "' must not be negative"},
                       {emitter(type, rgb + "1 1'/>"), value, "takes one or three numbers, found 2"},
                       {emitter(type, rgb + "1e39'/>"), value, "too large"},
                       {emitter(type, std::string("<texture name='") + name + "' type='checkerboard'/>"), "4:1",
                        "cannot be a <texture>"}});
    }
    const std::string board = "<texture name='radiance' type='checkerboard'>\n";
    expect_errors({{area("<rgb name='radiance' value='-1'/>"), "4:22", "'radiance' must not be negative"},
                   {area(board + "<rgb name='color0' value='-1'/></texture>"), "5:20", "must not be negative"},
                   {area(board + "<rgb name='colour' value='1'/></texture>"), "5:1", "does not take a parameter"},
                   {area("<texture name='radiance' type='wood'/>"), "4:26", "the texture 'wood' is not supported"}});
}

TEST(EmitterErrors, Places) {
    const std::string position = "<point name='position' x='1' y='0' z='0'/>\n";
    const std::string direction = "<vector name='direction' x='1' y='0' z='0'/>\n";
    expect_errors(
        {{emitter("point", position + to_world("<scale value='2'/>")), "5:1", "give either 'position' or 'to_world'"},
         {emitter("point", "<point name='position' x='1e30' y='0' z='0'/>"), "3:1", "too far away"},
         {emitter("spot", to_world("<translate x='1e30'/>")), "3:1", "too far away"},
         {emitter("spot", to_world("<scale x='2'/>")), "4:1", "the to_world of 'spot' must not shear or scale"},
         {emitter("spot", to_world("<matrix value='1 1 0  0 1 0  0 0 1'/>")), "4:1", "must not shear"},
         {emitter("projector", to_world("<scale value='2'/>")), "4:1", "the to_world of 'projector' must not scale or"},
         {emitter("projector", number("fov", "180")), "4:19", "'fov' must be between 0 and 180 degrees, not 180"},
         {emitter("spot", "<point name='position' x='1' y='0' z='0'/>"), "4:1", "does not take"},
         {emitter("directional", direction + to_world("<scale value='2'/>")), "5:1",
          "give either 'direction' or 'to_world'"},
         {emitter("directional", "<vector name='direction' x='0' y='0' z='0'/>"), "4:1", "must not be zero"},
         {emitter("directional", "<vector name='direction' x='0' y='0'/>"), "4:1", "needs the attribute 'z'"}});
}

TEST(EmitterErrors, SpotAngles) {
    expect_errors(
        {{emitter("spot", number("cutoff_angle", "0")), "4:28", "'cutoff_angle' must be between 0.001 and 180, not 0"},
         {emitter("spot", number("cutoff_angle", "1e-5")), "4:28", "'cutoff_angle' must be between 0.001 and 180"},
         {emitter("spot", number("cutoff_angle", "181")), "4:28", "must be between 0.001 and 180, not 181"},
         {emitter("spot", number("cutoff_angle", "nan")), "4:28", "bad number 'nan'"},
         {emitter("spot", number("beam_width", "-1")), "4:26", "'beam_width' must be between 0 and"},
         {emitter("spot", number("beam_width", "20.5")), "4:26", "must be between 0 and 20, not 20.5"},
         {emitter("spot", squares + "\n" + number("cutoff_angle", "90")), "5:28", "below 90, not 90"},
         {emitter("spot", "<rgb name='texture' value='1'/>"), "4:21", "must vary: a <texture>"}});
}

TEST(EmitterErrors, OneEnvironmentAtMost) {
    const TemporaryFolder folder;
    const std::string map = envmap_xml(folder, image_of(2, 3, [](int, int) { return Color(Color::Zero()); }));
    const std::string constant = "<emitter type='constant'/>\n";
    const std::string message = "a scene can have only one environment";
    expect_errors({{"<shape type='sphere'/>\n" + constant + constant, "4:1", message},
                   {"<shape type='sphere'/>\n" + constant + map, "4:1", message},
                   {"<shape type='sphere'/>\n" + map + "\n" + constant, "4:1", message},
                   {constant, "1:1", "the scene is empty"}});
}

TEST(EmitterErrors, Envmaps) {
    const TemporaryFolder folder;
    const std::string name = "<string name='filename' value='map.exr'/>\n";
    const auto error = [&](const std::string& parameters) {
        return error_of(emitter("envmap", parameters), folder / "t.xml");
    };
    EXPECT_THAT(error(""), StartsWith((folder / "t.xml") + ":3:1: 'envmap' needs 'filename'"));
    EXPECT_THAT(error(name), StartsWith((folder / "t.xml") + ":4:1: there is no file 'map.exr'; searched: "));
    folder.write("map.exr", "no image");
    EXPECT_THAT(error(name), StartsWith((folder / "map.exr") + ":1:1: "));
    const auto write = [&](const Color& value) {
        write_exr(
            folder / "map.exr",
            {{{"", image_of(4, 3, [&](int x, int y) { return x == 3 && y == 1 ? value : Color(Color::Ones()); })}},
             {}});
    };
    write(Color(1, -0.5f, 1));
    EXPECT_THAT(error(name), AllOf(StartsWith((folder / "map.exr") + ":1:1: "),
                                   HasSubstr("the pixel in column 3, row 1 is negative: -0.5")));
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), infinity}) {
        write(Color(1, 1, bad));
        EXPECT_THAT(error(name), AllOf(StartsWith((folder / "map.exr") + ":1:1: "), HasSubstr("is not finite")));
    }
    write(Color::Ones());
    const std::string place = (folder / "t.xml") + ":5:";
    EXPECT_EQ(error(name), "no error");
    EXPECT_THAT(error(name + number("scale", "-1")), StartsWith(place + "21: 'scale' must not be negative: -1"));
    EXPECT_THAT(error(name + number("scale", "1e39")), StartsWith(place + "21: bad number"));
    write(Color::Constant(1e30f));
    EXPECT_THAT(error(name + number("scale", "1e20")), StartsWith(place + "21: 'scale' is too large for 'map.exr'"));
    EXPECT_THAT(error(name + to_world("<scale value='2'/>")),
                StartsWith(place + "1: the to_world of 'envmap' must not scale or shear"));
    EXPECT_THAT(error(name + to_world("<matrix value='1 0.5 0  0 1 0  0 0 1'/>")), HasSubstr("must not scale"));
    EXPECT_THAT(error(name + "<rgb name='radiance' value='1'/>"),
                StartsWith(place + "1: emitter 'envmap' does not take a parameter 'radiance'; it takes: "));
    EXPECT_THAT(error(name + number("mis_compensation", "1")), HasSubstr("'mis_compensation' cannot be a <float>"));
}

TEST(EmitterFiles, AreInTheContentHash) {
    const TemporaryFolder folder;
    const auto hash = [&](float value) {
        write_exr(folder / "map.exr", {{{"", image_of(4, 3, [&](int, int) { return Color::Constant(value); })}}, {}});
        return parse_scene(scene_with(emitter("envmap", "<string name='filename' value='map.exr'/>")), folder / "t.xml")
            .content_hash;
    };
    EXPECT_EQ(hash(1), hash(1));
    EXPECT_NE(hash(1), hash(2));
}

TEST(EmitterFiles, OldScenesKeepLoading) {
    const TemporaryFolder folder;
    write_exr(folder / "map.exr", {{{"", image_of(4, 3, noise)}}, {}});
    const std::string weight = number("sampling_weight", "2");
    EXPECT_EQ(error_of(emitter("envmap",
                               "<string name='filename' value='map.exr'/><boolean name='mis_compensation' "
                               "value='true'/>" +
                                   weight),
                       folder / "t.xml"),
              "no error");
    for (const char* type : {"point", "spot", "directional", "constant"})
        EXPECT_EQ(error_of(emitter(type, weight)), "no error");
}

}  // namespace
}  // namespace gib::test::emitter_error_test
