// Light tracing and bidirectional path tracing against path tracing: whichever techniques make the paths, every
// component has the same mean.

#include "tests/support/lit_rooms.h"
#include "tests/support/same_means.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

namespace gib::bidirectional_test {
namespace {

using namespace test::lit_rooms;
using test::expect_same_means;
using test::room;
using test::RoomOptions;

const std::vector<std::string> all_methods = {"path",
                                              "bidirectional",
                                              "light_tracer",
                                              "bidirectional connections=off",
                                              "bidirectional camera=off",
                                              "bidirectional light_sampling=off",
                                              "bidirectional light_sampling=off connections=off camera=off"};
/// Without a technique that finds delta lights by itself.
const std::vector<std::string> for_delta_lights = {"path",
                                                   "bidirectional",
                                                   "light_tracer",
                                                   "bidirectional connections=off",
                                                   "bidirectional camera=off",
                                                   "bidirectional light_sampling=off"};

TEST(Techniques, AgreeUnderLamps) {
    expect_same_means(room({.light = lamp}), all_methods);
    expect_same_means(room({.light = shining_ball}), all_methods);
}
TEST(Techniques, AgreeUnderDeltaLights) {
    for (const auto& light : {point, spot, sun})
        expect_same_means(room({.light = light, .ball = "<bsdf type='diffuse'/>"}), for_delta_lights);
}
TEST(Techniques, AgreeUnderTheSky) { expect_same_means(room({.light = sky + lamp}), all_methods); }
// The camera's rays end at the far clip distance, inside the room; the sky beyond is seen nevertheless.
TEST(Techniques, AgreeAboutTheSkyBeyondTheFarClipDistance) {
    const auto scene = room({.light = sky,
                             .sensor_more = "<float name='far_clip' value='4.5'/>",
                             .glossy_wall = "",
                             .ball = "<bsdf type='diffuse'/>"});
    expect_same_means(scene, {"path", "bidirectional", "light_tracer"});
}
TEST(Techniques, AgreeInDaylight) {
    for (const std::string type : {"sun", "sky", "sunsky"}) {
        const std::string daylight = "<emitter type='" + type +
                                     "'><vector name='sun_direction' value='-1 2 -1'/><transform "
                                     "name='to_world'><rotate x='1' angle='-90'/></transform></emitter>";
        expect_same_means(room({.light = daylight, .glossy_wall = "", .ball = "<bsdf type='diffuse'/>"}),
                          {"path", "bidirectional", "light_tracer"});
    }
}
// A mirror behind the camera reflects the sun onto the floor. No method sees the mirror itself, so that none lacks a path.
TEST(Techniques, AgreeInDaylightFromAMirror) {
    const std::string daylight =
        "<emitter type='sunsky'><vector name='sun_direction' value='0.3 1.5 1'/><transform name='to_world'><rotate "
        "x='1' angle='-90'/></transform></emitter>";
    const std::string mirror =
        "<shape type='rectangle'><transform name='to_world'><scale x='3' y='4'/><translate y='1' z='-4'/></transform>"
        "<bsdf type='conductor'/></shape>";
    const auto scene = room({.light = daylight, .more = mirror, .glossy_wall = "", .ball = "<bsdf type='diffuse'/>"});
    EXPECT_GT(test::mean_of(*test::render(scene, "bidirectional", 16)[Component::caustic]).minCoeff(), 0.01);
    expect_same_means(scene, {"path", "bidirectional", "light_tracer"});
}
TEST(Techniques, AgreeInFog) { expect_same_means(room({.light = lamp, .more = fog}), all_methods); }
// The light lies on an edge of the medium's box, where a way meets one face and then the other, again and again.
TEST(Techniques, EndAtALightOnTheEdgeOfAMedium) {
    for (const std::string label : {"path", "bidirectional", "light_tracer"})
        EXPECT_GT(test::mean_of(test::render(room({.light = point, .more = fog}), label, 16).total()).sum(), 0)
            << label;
}
TEST(Techniques, AgreeBehindAMask) { expect_same_means(room({.light = lamp, .more = grate}), all_methods); }
TEST(Techniques, AgreeForEveryCameraAndFilter) {
    const std::string lens =
        "<float name='aperture_radius' value='0.2'/><float name='focus_distance' value='2'/>"
        "<float name='near_clip' value='0.3'/><float name='far_clip' value='4.5'/>";
    expect_same_means(room({.light = lamp, .sensor = "thinlens", .sensor_more = lens, .filter = "gaussian"}),
                      {"path", "bidirectional", "light_tracer"});
    expect_same_means(room({.light = lamp, .sensor = "orthographic", .filter = "tent"}),
                      {"path", "bidirectional", "light_tracer"});
}
TEST(Techniques, AgreeOnMixedAndSpecularSurfaces) {
    for (const auto& ball : {plastic_ball, glass_ball})
        expect_same_means(
            room({.light = lamp, .ball = ball}),
            {"path", "bidirectional", "bidirectional light_sampling=off", "bidirectional connections=off"});
}
// An octahedron whose interpolated normals lean by up to 55 degrees.
TEST(Techniques, AgreeOnSmoothShadedFaces) {
    const test::TemporaryFolder folder;
    std::string obj;
    for (const std::string corner : {"1 0 0", "-1 0 0", "0 1 0", "0 -1 0", "0 0 1", "0 0 -1"})
        obj += "v " + corner + "\nvn " + corner + "\n";
    for (const std::string face : {"1//1 3//3 5//5", "3//3 2//2 5//5", "2//2 4//4 5//5", "4//4 1//1 5//5",
                                   "3//3 1//1 6//6", "2//2 3//3 6//6", "4//4 2//2 6//6", "1//1 4//4 6//6"})
        obj += "f " + face + "\n";
    const std::string file = folder.write("octahedron.obj", obj);
    const auto smooth = [&](const std::string& bsdf) {
        return "<shape type='obj'><string name='filename' value='" + file +
               "'/><transform name='to_world'><scale value='0.6'/><translate x='0.6' y='-0.2' z='-0.6'/></transform>" +
               bsdf + "</shape>";
    };
    expect_same_means(room({.light = lamp, .more = smooth("<bsdf type='diffuse'/>")}), all_methods);
    expect_same_means(room({.light = lamp, .more = smooth("<bsdf type='dielectric'/>")}),
                      {"path", "bidirectional", "bidirectional light_sampling=off", "bidirectional connections=off"});
}
// Light from a point through glass: path tracing leaves the caustic black and says so, light tracing makes it.
TEST(Plans, NameTheCausticsThatAreMissing) {
    const auto scene = room({.light = sun, .glossy_wall = "", .ball = glass_ball});
    const auto plan_of = [&](const std::string& name) {
        return ConfiguredMethod(MethodLabel::parse(name)).create({})->plan(*scene.scene);
    };
    EXPECT_TRUE(plan_of("path").missing.has(Effect::caustics));
    EXPECT_EQ(incomplete_components(plan_of("path"), MethodLabel::parse("path spp=4")),
              "'path spp=4' leaves out light of the components: caustic, indirect");
    EXPECT_FALSE(plan_of("bidirectional").missing.has(Effect::caustics));
    EXPECT_EQ(plan_of("light_tracer").unresolved.size(), all_components.size());
    const auto caustic = [&](const std::string& label) {
        return test::mean_of(*test::render(scene, label, 64)[Component::caustic]).sum();
    };
    EXPECT_EQ(caustic("path"), 0);
    EXPECT_GT(caustic("light_tracer"), 0.01);
    EXPECT_GT(caustic("bidirectional"), 0.01);
}

}  // namespace
}  // namespace gib::bidirectional_test
