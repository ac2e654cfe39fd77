// Wrong <emitter> elements: each is an error that names the place and what would be right.

#include "tests/support/light_fixtures.h"
#include "tests/support/scene_errors.h"

#include <limits>

namespace gib::test::emitter_error_test {
namespace {

/// A scene of an emitter, which starts on line 3, and its parameters on line 4. An area emitter stands in the shape.
std::string lit_by(const std::string& type, const std::string& parameters) {
    const std::string light = emitter(type, "\n", parameters);
    return type == "area" ? shape("sphere", "\n", light) : shape("sphere") + "\n" + light;
}

void expect_errors(const std::string& type, const std::vector<ExpectedError>& rows) {
    SCOPED_TRACE(type);
    test::expect_errors(rows, [&](const std::string& parameters) { return scene_error(lit_by(type, parameters)); });
}

std::string matrix(const std::string& values) { return to_world("<matrix value='" + values + "'/>"); }

TEST(EmitterErrors, Places) {
    const std::string twice = to_world(scale(2));
    expect_errors("point", {{point("position", 1, 0, 0) + "\n" + twice, "5:1", "give either 'position' or 'to_world'"},
                            {point("position", 1e30, 0, 0), "3:1", "too far away"}});
    expect_errors("spot", {{to_world(translate(1e30, 0, 0)), "3:1", "too far away"},
                           {to_world(scale(2, 1, 1)), "4:1", "the to_world of 'spot' must not shear or scale"},
                           {matrix("1 1 0  0 1 0  0 0 1"), "4:1", "must not shear"},
                           {point("position", 1, 0, 0), "4:1", "does not take"}});
    expect_errors("projector", {{twice, "4:1", "the to_world of 'projector' must not scale or"},
                                {number("fov", 180), "4:19", "'fov' must be between 0 and 180 degrees, not 180"}});
    expect_errors("directional",
                  {{vector("direction", 1, 0, 0) + "\n" + twice, "5:1", "give either 'direction' or 'to_world'"},
                   {vector("direction", 0, 0, 0), "4:1", "must not be zero"},
                   {"<vector name='direction' x='0' y='0'/>", "4:1", "needs the attribute 'z'"}});
}

TEST(EmitterErrors, SpotAngles) {
    expect_errors("spot", {{number("cutoff_angle", 0), "4:28", "'cutoff_angle' must be between 0.001 and 180, not 0"},
                           {number("cutoff_angle", 1e-5), "4:28", "'cutoff_angle' must be between 0.001 and 180"},
                           {number("beam_width", -1), "4:26", "'beam_width' must be between 0 and"},
                           {number("beam_width", 20.5), "4:26", "must be between 0 and 20, not 20.5"},
                           {named("texture", "texture", "checkerboard") + "\n" + number("cutoff_angle", 90), "5:28",
                            "below 90, not 90"},
                           {rgb("texture", 1), "4:21", "must vary: a <texture>"}});
}

TEST(EmitterErrors, OneEnvironmentAtMost) {
    const TemporaryFolder folder;
    const std::string map = envmap_xml(folder, image_of(2, 3, [](int, int) { return Color(Color::Zero()); }));
    const std::string ball = shape("sphere") + "\n", constant = emitter("constant") + "\n",
                      message = "a scene can have only one environment";
    test::expect_errors({{ball + constant + constant, "4:1", message},
                         {ball + constant + map, "4:1", message},
                         {ball + map + "\n" + constant, "4:1", message},
                         {constant, "1:1", "the scene is empty"}});
}

TEST(EmitterErrors, Envmaps) {
    const TemporaryFolder folder;
    const std::string scene = folder / "t.xml", map = folder / "map.exr", name = filename("map.exr") + "\n";
    const auto error = [&](const std::string& parameters) { return scene_error(lit_by("envmap", parameters), scene); };
    test::expect_errors(
        {{"", "3:1", "'envmap' needs 'filename'"}, {name, "4:1", "there is no file 'map.exr'; searched: "}}, error,
        scene);
    folder.write("map.exr", "no image");
    EXPECT_THAT(error(name), StartsWith(map + ":1:1: "));
    const auto write = [&](const Color& value) {
        const auto texel = [&](int x, int y) { return x == 3 && y == 1 ? value : Color(Color::Ones()); };
        write_exr(map, {{{"", image_of(4, 3, texel)}}, {}});
    };
    write(Color(1, -0.5f, 1));
    EXPECT_THAT(error(name),
                AllOf(StartsWith(map + ":1:1: "), HasSubstr("the pixel in column 3, row 1 is negative: -0.5")));
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), infinity}) {
        write(Color(1, 1, bad));
        EXPECT_THAT(error(name), AllOf(StartsWith(map + ":1:1: "), HasSubstr("is not finite")));
    }
    write(Color::Ones());
    EXPECT_EQ(error(name), "no error");
    test::expect_errors({{name + number("scale", -1), "5:21", "'scale' must not be negative: -1"},
                         {name + to_world(scale(2)), "5:1", "the to_world of 'envmap' must not scale or shear"},
                         {name + matrix("1 0.5 0  0 1 0  0 0 1"), "5:1", "must not scale"}},
                        error, scene);
    write(Color::Constant(1e30f));
    EXPECT_THAT(error(name + number("scale", 1e20)), StartsWith(scene + ":5:21: 'scale' is too large for 'map.exr'"));
}

TEST(EmitterFiles, AreInTheContentHash) {
    const TemporaryFolder folder;
    const auto hash = [&](float value) {
        const std::string map = envmap_xml(folder, image_of(4, 3, [&](int, int) { return Color::Constant(value); }));
        return load(shape("sphere") + map).content_hash;
    };
    EXPECT_EQ(hash(1), hash(1));
    EXPECT_NE(hash(1), hash(2));
}

}  // namespace
}  // namespace gib::test::emitter_error_test
