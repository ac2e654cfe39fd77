// Light tracing and bidirectional path tracing against path tracing: whichever techniques make the paths, every
// component has the same mean. And Helmholtz reciprocity of both.

#include "tests/support/lit_rooms.h"
#include "tests/support/same_means.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

namespace gib::test::bidirectional_test {
namespace {

using namespace lit_rooms;

const std::vector<std::string> three_methods = {"path", "bidirectional", "light_tracer"};
/// Without light tracing, which finds no specular surfaces.
const std::vector<std::string> for_specular = {"path", "bidirectional"};

TEST(Techniques, AgreeUnderLamps) {
    expect_same_means(room_xml({.light = lamp}), three_methods);
    expect_same_means(room_xml({.light = shining_ball}), three_methods);
}
TEST(Techniques, AgreeUnderDeltaLights) {
    for (const auto& light : {lit_rooms::point, spot, sun})
        expect_same_means(room_xml({.light = light, .ball = diffuse_ball}), three_methods);
}
TEST(Techniques, AgreeUnderTheSky) { expect_same_means(room_xml({.light = sky + lamp}), three_methods); }
// The camera's rays end at the far clip distance, inside the room; the sky beyond is seen nevertheless.
TEST(Techniques, AgreeAboutTheSkyBeyondTheFarClipDistance) {
    expect_same_means(
        room_xml({.light = sky, .sensor_more = number("far_clip", 4.5), .glossy_wall = "", .ball = diffuse_ball}),
        three_methods);
}
std::string daylight(const std::string& type, const std::string& sun_direction) {
    return emitter(type, value_element("vector", "sun_direction", sun_direction), to_world(rotate('x', -90)));
}
TEST(Techniques, AgreeInDaylight) {
    for (const std::string type : {"sun", "sky", "sunsky"})
        expect_same_means(room_xml({.light = daylight(type, "-1 2 -1"), .glossy_wall = "", .ball = diffuse_ball}),
                          three_methods);
}
// A mirror behind the camera reflects the sun onto the floor. No method sees the mirror itself, so that none lacks a path.
TEST(Techniques, AgreeInDaylightFromAMirror) {
    const std::string mirror = shape("rectangle", to_world(scale(3, 4, 1), translate(0, 1, -4)), bsdf("conductor"));
    const std::string xml =
        room_xml({.light = daylight("sunsky", "0.3 1.5 1"), .more = mirror, .glossy_wall = "", .ball = diffuse_ball});
    EXPECT_GT(mean_of(*render(scene_of(xml), "bidirectional", 16)[Component::caustic]).minCoeff(), 0.005);
    expect_same_means(xml, three_methods);
}
TEST(Techniques, AgreeInFog) { expect_same_means(room_xml({.light = lamp, .more = fog}), three_methods); }
// The light lies on an edge of the medium's box, where a way meets one face and then the other, again and again.
TEST(Techniques, EndAtALightOnTheEdgeOfAMedium) {
    for (const auto& label : three_methods)
        EXPECT_GT(mean_of(render(room({.light = lit_rooms::point, .more = fog}), label, 16).total()).sum(), 0) << label;
}
TEST(Techniques, AgreeBehindAMask) { expect_same_means(room_xml({.light = lamp, .more = grate}), three_methods); }
TEST(Techniques, AgreeForEveryCameraAndFilter) {
    const std::string lens = number("aperture_radius", 0.2) + number("focus_distance", 2) + number("near_clip", 0.3) +
                             number("far_clip", 4.5);
    expect_same_means(room_xml({.light = lamp, .sensor = "thinlens", .sensor_more = lens, .filter = "gaussian"}),
                      three_methods);
    expect_same_means(room_xml({.light = lamp, .sensor = "orthographic", .filter = "tent"}), three_methods);
}
TEST(Techniques, AgreeOnMixedAndSpecularSurfaces) {
    for (const auto& ball : {plastic_ball, glass_ball})
        expect_same_means(room_xml({.light = lamp, .ball = ball}), for_specular);
}
// An octahedron whose interpolated normals lean by up to 55 degrees.
TEST(Techniques, AgreeOnSmoothShadedFaces) {
    const TemporaryFolder folder;
    std::string obj;
    for (const std::string corner : {"1 0 0", "-1 0 0", "0 1 0", "0 -1 0", "0 0 1", "0 0 -1"})
        obj += "v " + corner + "\nvn " + corner + "\n";
    for (const std::string face : {"1//1 3//3 5//5", "3//3 2//2 5//5", "2//2 4//4 5//5", "4//4 1//1 5//5",
                                   "3//3 1//1 6//6", "2//2 3//3 6//6", "4//4 2//2 6//6", "1//1 4//4 6//6"})
        obj += "f " + face + "\n";
    const std::string file =
        text("filename", folder.write("octahedron.obj", obj)) + to_world(scale(0.6), translate(0.6, -0.2, -0.6));
    expect_same_means(room_xml({.light = lamp, .more = shape("obj", file, bsdf("diffuse"))}), three_methods);
    expect_same_means(room_xml({.light = lamp, .more = shape("obj", file, bsdf("dielectric"))}), for_specular);
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
        return mean_of(*render(scene, label, 64)[Component::caustic]).sum();
    };
    EXPECT_EQ(caustic("path"), 0);
    EXPECT_GT(caustic("light_tracer"), 0.01);
    EXPECT_GT(caustic("bidirectional"), 0.01);
}

// Helmholtz reciprocity (Veach 1997, sections 3.7.5 and 6.3): light that goes from plate A over an object to plate B is as
// much as goes from B to A. The two plates are alike; one of them emits, and the camera, close before the other, sees
// it whole.

/// Steps that place a plate, a square from -1 to 1 which shines along +z.
const std::string plate_a = scale(0.5) + rotate('y', 90) + translate(-1.5, 0.4, 0);
const std::string plate_b = scale(0.5) + rotate('x', 20) + translate(0, 0.3, -1.4);

/// The object between the plates: a tilted sheet and a ball behind it, of one material.
LoadedScene plates_around(const std::string& material, const std::string& lamp_plate, const std::string& seen) {
    // The camera looks along -z of the plate, from just in front of it; its own film spans -1 to 1.
    return Scene(
               element("sensor", "orthographic", to_world(scale(-1, 1, -1), translate(0, 0, 0.002), seen), box_film(4)))
        .add(shape("rectangle", to_world(lamp_plate), one_sided("0.5"), area_light(10)))
        .add(shape("rectangle", to_world(seen), one_sided("0.5")))
        .add(shape("rectangle", to_world(scale(0.8), rotate('y', -140)), material))
        .sphere(0.6, 0.1, 1, 0.5, material)
        .load();
}

Moments radiance(const LoadedScene& scene, const std::string& method) {
    Moments moments;
    for (std::uint64_t seed = 1; seed <= 16; ++seed)
        moments.add(mean_of(render(scene, method, 1024, seed).total())[1]);
    return moments;
}

struct NamedBsdf {
    const char* name;
    std::string xml;
};
void PrintTo(const NamedBsdf& bsdf, std::ostream* out) { *out << bsdf.name; }

class Reciprocity : public testing::TestWithParam<NamedBsdf> {};

TEST_P(Reciprocity, HoldsForLampAndSensor) {
    const std::string& material = GetParam().xml;
    const LoadedScene from_a = plates_around(material, plate_a, plate_b),
                      from_b = plates_around(material, plate_b, plate_a);
    for (const std::string method : {"bidirectional", "path"}) {
        const Moments there = radiance(from_a, method), back = radiance(from_b, method);
        ASSERT_GT(there.mean(), 0);
        // A chance of 1e-4 for each method and material by Student's t of 30 degrees of freedom.
        EXPECT_NEAR(there.mean(), back.mean(), 4.5 * std::hypot(there.standard_error(), back.standard_error()))
            << method;
    }
}

INSTANTIATE_TEST_SUITE_P(
    Materials, Reciprocity,
    testing::Values(NamedBsdf{"diffuse", bsdf("twosided", bsdf("diffuse"))},
                    NamedBsdf{"roughconductor", bsdf("twosided", bsdf("roughconductor", number("alpha", 0.2)))},
                    NamedBsdf{"conductor", bsdf("twosided", bsdf("conductor"))},
                    NamedBsdf{"dielectric", bsdf("dielectric")}, NamedBsdf{"thindielectric", bsdf("thindielectric")},
                    NamedBsdf{"roughdielectric", bsdf("roughdielectric", number("alpha", 0.3))},
                    NamedBsdf{"plastic", bsdf("twosided", bsdf("plastic"))},
                    NamedBsdf{"roughplastic", bsdf("twosided", bsdf("roughplastic", number("alpha", 0.2)))},
                    NamedBsdf{"phong", bsdf("twosided", bsdf("phong", number("exponent", 20)))},
                    NamedBsdf{"mask", bsdf("mask", number("opacity", 0.6), bsdf("twosided", bsdf("diffuse")))}),
    [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace gib::test::bidirectional_test
