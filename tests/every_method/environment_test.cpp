// Lights at infinity and spots in every method; the registry is walked, no method is named.

#include "common/color/daylight.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/methods_under_test.h"

namespace gib::environment_test {
namespace {

using namespace test;

constexpr double pi_d = std::numbers::pi;

class EveryMethodUnderTheSky : public OfAMethod {};
INSTANTIATE_TEST_SUITE_P(Registry, EveryMethodUnderTheSky, testing::ValuesIn(methods_that_sample_pixels()),
                         name_of_method);

/// Looks along +z from (0, 0, -4); the ball below fills the middle of the image.
const std::string sensor = camera(40, to_world(translate(0, 0, -4)), box_film(32));
const std::string constant_sky = constant_light(1);

std::string ball(const std::string& material) { return shape("sphere", material); }
LoadedScene seen(const std::string& things) { return test::Scene(sensor, things).load(); }

// A convex diffuse body of albedo rho under a sky of radiance L has the radiance rho L,
// whatever its shape. With rho = 1 it vanishes.
TEST_P(EveryMethodUnderTheSky, AConvexDiffuseBodyScattersTheSkysRadiance) {
    const TemporaryFolder folder;
    for (const std::string& sky :
         {constant_sky, envmap_xml(folder, image_of(5, 4, [](int, int) { return Color(Color::Ones()); }))}) {
        const auto image = rendered(seen(sky + ball(diffuse(1))), 64, "max_depth=3");  // a ball does not light itself
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
    if (!method().simulates(Effect::caustics)) GTEST_SKIP();
    const bool unbiased = method().description->unbiased;
    const auto image = rendered(
        seen(constant_sky + ball(bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1))) +
             shape("rectangle", to_world(rotate('x', -90), scale(3), translate(0, -1.05, 0)), diffuse(1)) +
             shape("rectangle", to_world(rotate('y', -60), translate(2, 0, 1)), bsdf("twosided", bsdf("conductor")))),
        unbiased ? 128 : 8);
    // Estimates from photon maps are blurred over edges, but right in the mean.
    EXPECT_NEAR(mean_of(image.total()).mean(), 1.0, unbiased ? 0.006 : 0.02);
    EXPECT_GT(mean_of(*image[Component::caustic]).mean(), 0.01);
}

// Light that comes from the sky by a specular chain alone is emission: E S* L.
TEST_P(EveryMethodUnderTheSky, TheSkyInAMirrorIsEmission) {
    if (!method().simulates(Effect::specular_reflection)) GTEST_SKIP();
    const auto scene = seen(constant_sky + ball(bsdf("conductor")));
    const auto image = rendered(scene, 4);
    for (std::size_t i = 0; i < image.total().pixels(); ++i)
        EXPECT_NEAR(image[Component::emission]->at(i)[0], 1.f, 1e-4f);
    EXPECT_LT(mean_of(*rendered(scene, 4, "max_depth=1")[Component::emission]).minCoeff(), 1.0)
        << "the mirror's edge is the second one";
}

/// A floor of reflectance 0.5 at the origin, seen from above, with `light` over it.
LoadedScene floor_under(const std::string& light) {
    return test::Scene(
               element("sensor", "orthographic", to_world(scale(0.001), look_at("0, 0, 1", "0, 0, 0")), box_film(8)),
               shape("rectangle", diffuse(0.5)), light)
        .load();
}
double floor_radiance(const MethodUnderTest& method, const std::string& light, std::uint32_t passes) {
    return mean_of(*render(floor_under(light), method.label + " max_depth=2", passes)[Component::direct])[1];
}
std::string sun_along(double x, double y, double z) { return emitter("directional", vector("direction", x, y, z)); }

TEST_P(EveryMethodUnderTheSky, DirectLightFollowsTheClosedForms) {
    // E cos(theta) rho / pi with cos = 0.8.
    EXPECT_NEAR(
        floor_radiance(method(), emitter("directional", vector("direction", 3, 0, -4), rgb("irradiance", 2)), 1),
        2 * 0.8 * 0.5 / pi_d, 1e-5);
    // A spot at height 2 looks 14 degrees past the origin: the fall-off from 8 to 20 degrees has reached a half.
    EXPECT_NEAR(floor_radiance(method(),
                               emitter("spot", rgb("intensity", 3), number("cutoff_angle", 20), number("beam_width", 8),
                                       to_world(rotate('x', 14), rotate('x', 180), translate(0, 0, 2))),
                               1),
                3 * 0.5 / 4 * 0.5 / pi_d, 1e-4);
    EXPECT_EQ(floor_radiance(method(), emitter("directional"), 1), 0.0) << "from below, on a two-sided floor";
}

// The map has a sun and a black half. Light sampling and bsdf sampling together give
// the integral of L cos over the hemisphere.
TEST_P(EveryMethodUnderTheSky, AMapsIrradianceIsThatOfItsHemisphere) {
    const TemporaryFolder folder;
    const Image image = image_of(16, 9, [](int x, int y) {
        return x < 6 ? Color(Color::Zero()) : Color((x == 9 && y == 3 ? 200.f : 1.f) * noise(x, y));
    });
    const std::string sky =
        envmap_xml(folder, image, "<transform name='to_world'><rotate x='1' angle='70'/></transform>");
    const auto scene = floor_under(sky);
    const double E = sphere_integral(90, 180, 4, [&](const Vec3& w) {
        return static_cast<double>(scene.scene->environment_radiance(w)[1] * std::max(w.z(), 0.f));
    });
    // 64 pixels x 1024 samples, whose deviation is below 3 times their mean: standard error 1.2 %.
    EXPECT_NEAR(floor_radiance(method(), sky, 1024) / (0.5 * E / pi_d), 1, 0.03);
}

// The floor's irradiance is the integral of the sky's formula over its directions, times the cosine, and that of the
// sun's disc. The sun's part is exact at its centre, since its radius of 0.27 degrees changes the mean cosine by 1e-5.
TEST_P(EveryMethodUnderTheSky, DaylightsIrradianceIsThatOfItsFormula) {
    const Vec3 sun = Vec3(1, 2, 2).normalized();  // the cosine to the zenith is 2 / 3
    const double sun_theta = std::acos(2.0 / 3);
    const ClearSky sky(3, Colord::Constant(0.3f), sun_theta);  // the albedo that a sky has unless it is given
    const double E_sky = sphere_integral(180, 360, 2, [&](const Vec3& w) {
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
    const auto plate_at = [](double x) {
        return shape("rectangle", to_world(scale(0.5), translate(x, 0, 2)), diffuse(0));
    };
    const std::string sun = sun_along(0, 0, -1);
    EXPECT_EQ(floor_radiance(method(), plate_at(0) + sun, 4), 0.0);
    EXPECT_NEAR(floor_radiance(method(), plate_at(2) + sun, 4), 0.5 / pi_d, 1e-5);
}

// No light comes from infinity through a medium without a boundary, in the channels that it absorbs.
class EveryMethodInFog : public OfAMethod {};
INSTANTIATE_TEST_SUITE_P(Registry, EveryMethodInFog, testing::ValuesIn(methods_under_test(Work::small)),
                         name_of_method);

TEST_P(EveryMethodInFog, SeesNoLightAtInfinityIfItHasNoBoundary) {
    if (!method().simulates(Effect::participating_media)) GTEST_SKIP();
    const std::string fog = "<medium type='homogeneous' id='fog'>" + rgb("sigma_a", "0.5, 0, 0.5") + "</medium>",
                      wall_and_floor = shape("rectangle", to_world(rotate('y', 180))) +
                                       shape("rectangle", to_world(rotate('x', -90), translate(0, -1, -1)));
    for (const std::string& light : {constant_sky, sun_along(0.3, -0.5, 1)}) {
        const auto scene = test::Scene(fog, camera(40, to_world(translate(0, 0, -4)), reference("fog"), box_film(8)),
                                       wall_and_floor, light)
                               .load();
        const Colord found = mean_of(rendered(scene, 4).total());
        EXPECT_EQ(found[0], 0);
        EXPECT_GT(found[1], 0.05);
        EXPECT_EQ(found[2], 0);
    }
}

}  // namespace
}  // namespace gib::environment_test
