// Lights at infinity and spots in every method; the registry is walked, no method is named.

#include "common/color/daylight.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/scene_fixtures.h"

namespace gib::environment_test {
namespace {

using test::box_film;
using test::envmap_xml;
using test::image_of;
using test::mean_of;
using test::render;
using test::scene_xml;
using test::TemporaryFolder;

constexpr double pi_d = std::numbers::pi;

class EveryMethodUnderTheSky : public testing::TestWithParam<std::string> {
protected:
    const MethodDescription& method() const { return find_method(GetParam()); }
    bool simulates_sky() const { return method().simulates.has(Effect::environment_light); }
};

INSTANTIATE_TEST_SUITE_P(Registry, EveryMethodUnderTheSky, testing::ValuesIn(names_of_comparable_methods()),
                         [](const auto& name) { return name.param; });

/// Looks along +z from (0, 0, -4); the ball below fills the middle of the image.
const std::string sensor =
    "<sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'><translate "
    "z='-4'/></transform>" +
    box_film(32) + "</sensor>";
const std::string constant_sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";

std::string ball(const std::string& bsdf) { return "<shape type='sphere'>" + bsdf + "</shape>"; }

// A convex diffuse body of albedo rho under a sky of radiance L has the radiance rho L,
// whatever its shape. With rho = 1 it vanishes.
TEST_P(EveryMethodUnderTheSky, AConvexDiffuseBodyScattersTheSkysRadiance) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!simulates_sky()) GTEST_SKIP();
    const TemporaryFolder folder;
    const std::string label = method().name + " max_depth=3";  // a convex ball does not light itself
    for (const std::string& sky :
         {constant_sky, envmap_xml(folder, image_of(5, 4, [](int, int) { return Color(Color::Ones()); }))}) {
        const auto scene = test::scene_of(scene_xml(sensor + sky + ball(test::diffuse(1))));
        const auto image = render(scene, label, 64);
        EXPECT_NEAR(mean_of(image.total()).mean(), 1.0, 0.006);
        if (image[Component::caustic]) {
            EXPECT_EQ(mean_of(*image[Component::caustic]).sum(), 0.0);
        }
        // The four pixels in the middle show the ball alone.
        for (const std::size_t pixel : {15u * 32 + 15, 15u * 32 + 16, 16u * 32 + 15, 16u * 32 + 16}) {
            EXPECT_EQ(image[Component::emission]->at(pixel)[0], 0.f);
            EXPECT_NEAR(image[Component::direct]->at(pixel)[0], 1.f, 0.3f);
        }
        EXPECT_EQ(image[Component::emission]->at(0)[0], 1.f) << "the sky itself";
    }
}

// Lossless bodies under a sky of radiance 1 all have radiance 1, also where one is seen in or through another.
TEST_P(EveryMethodUnderTheSky, LosslessBodiesVanish) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!simulates_sky() || !method().simulates.has(Effect::caustics)) GTEST_SKIP();
    const std::string glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    const std::string floor =
        "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='3'/><translate "
        "y='-1.05'/></transform>" +
        test::diffuse(1) + "</shape>";
    const std::string mirror =
        "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='-60'/><translate x='2' "
        "z='1'/></transform>"
        "<bsdf type='twosided'><bsdf type='conductor'/></bsdf></shape>";
    const auto scene = test::scene_of(scene_xml(sensor + constant_sky + ball(glass) + floor + mirror));
    const auto image = render(scene, method().name, method().unbiased ? 128 : 8);
    // Estimates from photon maps are blurred over edges, but right in the mean.
    EXPECT_NEAR(mean_of(image.total()).mean(), 1.0, method().unbiased ? 0.006 : 0.02);
    EXPECT_GT(mean_of(*image[Component::caustic]).mean(), 0.01);
}

// Light that comes from the sky by a specular chain alone is emission: E S* L.
TEST_P(EveryMethodUnderTheSky, TheSkyInAMirrorIsEmission) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!simulates_sky() || !method().simulates.has(Effect::specular_reflection)) GTEST_SKIP();
    const auto scene = test::scene_of(scene_xml(sensor + constant_sky + ball("<bsdf type='conductor'/>")));
    const auto image = render(scene, method().name, 4);
    for (std::size_t i = 0; i < image.total().pixels(); ++i)
        EXPECT_NEAR(image[Component::emission]->at(i)[0], 1.f, 1e-4f);
    EXPECT_EQ(mean_of(*render(scene, method().name + " max_depth=1", 4)[Component::emission]).minCoeff() < 1.0, true)
        << "the mirror's edge is the second one";
}

/// A floor of reflectance 0.5 at the origin, seen from above, with `light` over it.
LoadedScene floor_under(const std::string& light) {
    return test::scene_of(
        scene_xml("<sensor type='orthographic'><transform name='to_world'><scale value='0.001'/><lookat origin='0,0,1' "
                  "target='0,0,0' up='0,1,0'/></transform>" +
                  box_film(8) + "</sensor><shape type='rectangle'>" + test::diffuse(0.5) + "</shape>" + light));
}

double floor_radiance(const MethodDescription& method, const std::string& light, std::uint32_t passes) {
    return mean_of(*render(floor_under(light), method.name + " max_depth=2", passes)[Component::direct])[1];
}

TEST_P(EveryMethodUnderTheSky, DirectLightFollowsTheClosedForms) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!method().simulates.has(Effect::direct_light)) GTEST_SKIP();
    // E cos(theta) rho / pi with cos = 0.8.
    EXPECT_NEAR(floor_radiance(method(),
                               "<emitter type='directional'><vector name='direction' x='3' y='0' z='-4'/><rgb "
                               "name='irradiance' value='2'/></emitter>",
                               1),
                2 * 0.8 * 0.5 / pi_d, 1e-5);
    // A spot at height 2 looks 14 degrees past the origin: the fall-off from 8 to 20 degrees has reached a half.
    const std::string aim = "<rotate x='1' angle='14'/><rotate x='1' angle='180'/><translate z='2'/>";
    EXPECT_NEAR(floor_radiance(method(),
                               "<emitter type='spot'><rgb name='intensity' value='3'/><float name='cutoff_angle' "
                               "value='20'/><float name='beam_width' value='8'/><transform name='to_world'>" +
                                   aim + "</transform></emitter>",
                               1),
                3 * 0.5 / 4 * 0.5 / pi_d, 1e-4);
    EXPECT_EQ(floor_radiance(method(), "<emitter type='directional'/>", 1), 0.0) << "from below, on a two-sided floor";
}

// The map has a sun and a black half. Light sampling and bsdf sampling together give
// the integral of L cos over the hemisphere.
TEST_P(EveryMethodUnderTheSky, AMapsIrradianceIsThatOfItsHemisphere) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!simulates_sky()) GTEST_SKIP();
    const TemporaryFolder folder;
    const Image image = image_of(16, 9, [](int x, int y) {
        return x < 6 ? Color(Color::Zero()) : Color((x == 9 && y == 3 ? 200.f : 1.f) * test::noise(x, y));
    });
    const std::string sky =
        envmap_xml(folder, image, "<transform name='to_world'><rotate x='1' angle='70'/></transform>");
    const auto scene = floor_under(sky);
    const double E = test::sphere_integral(90, 180, 4, [&](const Vec3& w) {
        return static_cast<double>(scene.scene->environment_radiance(w)[1] * std::max(w.z(), 0.f));
    });
    // 64 pixels x 1024 samples, whose deviation is below 3 times their mean: standard error 1.2 %.
    EXPECT_NEAR(floor_radiance(method(), sky, 1024) / (0.5 * E / pi_d), 1, 0.03);
}

// The floor's irradiance is the integral of Preetham's formula over the sky, times the cosine, and that of the sun's
// disc. The sun's part is exact at its centre, since its radius of 0.27 degrees changes the mean cosine by 1e-5.
TEST_P(EveryMethodUnderTheSky, DaylightsIrradianceIsThatOfItsFormula) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!simulates_sky()) GTEST_SKIP();
    const Vec3 sun = Vec3(1, 2, 2).normalized();  // the cosine to the zenith is 2 / 3
    const double sun_theta = std::acos(2.0 / 3);
    const ClearSky sky(3, sun_theta);
    const double E_sky = test::sphere_integral(180, 360, 2, [&](const Vec3& w) {
        if (!(w.z() > 0)) return 0.0;
        const double gamma = std::atan2(static_cast<double>(w.cross(sun).norm()), static_cast<double>(w.dot(sun)));
        return sky.radiance(static_cast<double>(w.z()), gamma)[1] * static_cast<double>(w.z());
    });
    const double E_sun =
        sun_radiance(3, sun_theta)[1] * 2 * pi_d * (1 - std::cos(0.5 * sun_diameter * pi_d / 180)) * 2 / 3;
    EXPECT_GT(E_sun, E_sky);
    const auto radiance = [&](const std::string& type) {
        return floor_radiance(
            method(), "<emitter type='" + type + "'><vector name='sun_direction' value='1 2 2'/></emitter>", 256);
    };
    // 64 pixels x 256 samples, whose deviation is below their mean: standard error 0.8 %. The table's error is 0.3 %.
    EXPECT_NEAR(radiance("sky") / (0.5 * E_sky / pi_d), 1, 0.03);
    EXPECT_NEAR(radiance("sun") / (0.5 * E_sun / pi_d), 1, 0.01);
    EXPECT_NEAR(radiance("sunsky") / (0.5 * (E_sky + E_sun) / pi_d), 1, 0.03);
}

// A plate hides lights at infinity from the floor, as it hides near ones.
TEST_P(EveryMethodUnderTheSky, PlatesHideLightsAtInfinity) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!method().simulates.has(Effect::direct_light)) GTEST_SKIP();
    const std::string plate =
        "<shape type='rectangle'><transform name='to_world'><scale value='0.5'/><translate z='2'/></transform>" +
        test::diffuse(0) + "</shape>";
    const std::string sun = "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/></emitter>";
    EXPECT_EQ(floor_radiance(method(), plate + sun, 4), 0.0);
    const std::string beside =
        "<shape type='rectangle'><transform name='to_world'><scale value='0.5'/><translate x='2' z='2'/>"
        "</transform>" +
        test::diffuse(0) + "</shape>";
    EXPECT_NEAR(floor_radiance(method(), beside + sun, 4), 0.5 / pi_d, 1e-5);
}

}  // namespace
}  // namespace gib::environment_test
