// Tests of the emitters sunsky, sky and sun: their radiance in space, their units and their errors.

#include "common/color/daylight.h"
#include "common/core/error.h"
#include "common/scene/scene.h"
#include "tests/support/input_error.h"
#include "tests/support/light_fixtures.h"

#include <gmock/gmock.h>

namespace gib::test::daylight_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double degree = std::numbers::pi / 180;
const std::string ball = shape("sphere") + "\n";

std::string number(const std::string& name, double value) { return number(name, std::to_string(value)); }
std::string sun_at(double x, double y, double z) {
    return "<vector name='sun_direction' value='" + std::to_string(x) + " " + std::to_string(y) + " " +
           std::to_string(z) + "'/>";
}
std::string emitter(const std::string& type, const std::string& parameters) { return emitter(type, "\n", parameters); }
LoadedScene lit_by(const std::string& type, const std::string& parameters) {
    return load(ball + emitter(type, parameters));
}
std::string error_of(const std::string& type, const std::string& parameters) {
    return input_error_of([&] { parse_scene(scene_with(ball + emitter(type, parameters)), "t.xml"); });
}

/// The unit vector at these angles [degrees] to the zenith z and, from x to y, in azimuth.
Vec3 direction_at(double theta, double azimuth) {
    const double t = theta * degree, p = azimuth * degree;
    return Vec3d(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)).cast<float>();
}

double angle(const Vec3& a, const Vec3& b) {
    return std::atan2(a.cross(b).cast<double>().norm(), a.cast<double>().dot(b.cast<double>()));
}

TEST(DaylightEmitters, ASkyHasTheFormulasRadianceAndIsBlackBelowTheHorizon) {
    const Vec3 sun = direction_at(55, 200);
    const std::string parameters = number("turbidity", 4) + sun_at(sun.x(), sun.y(), sun.z());
    const LoadedScene scene = lit_by("sky", parameters + number("scale", 2));
    const ClearSky sky(4, 55 * degree);
    for (double theta : {0.0, 20.0, 50.0, 80.0, 89.0})
        for (double azimuth : {3.0, 100.0, 190.0, 310.0}) {
            const Vec3 w = direction_at(theta, azimuth);
            const Colord expected = 2 * sky.radiance(std::cos(theta * degree), angle(w, sun));
            const Color found = scene.scene->environment_radiance(w);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(found[c] / expected[c], 1, 0.005) << theta << ' ' << azimuth;
        }
    for (double theta : {90.01, 100.0, 180.0})
        EXPECT_TRUE(is_black(scene.scene->environment_radiance(direction_at(theta, 20)))) << theta;
}

// The sky of a scene with y upwards: to_world turns it, and sun_direction stays in world space.
TEST(DaylightEmitters, ToWorldTurnsTheSkyButNotTheSunsDirection) {
    const std::string y_up = to_world(rotate('x', -90));
    const LoadedScene turned = lit_by("sunsky", y_up + sun_at(1, 2, 0.5)),
                      straight = lit_by("sunsky", sun_at(1, -0.5, 2));
    for (double theta : {10.0, 70.0, 120.0})
        for (double azimuth : {0.0, 130.0, 250.0}) {
            const Vec3 w = direction_at(theta, azimuth);
            const Color a = turned.scene->environment_radiance(Vec3(w.x(), w.z(), -w.y())),
                        b = straight.scene->environment_radiance(w);
            EXPECT_LE((a - b).abs().maxCoeff(), 1e-3f * b.maxCoeff()) << theta << ' ' << azimuth;
        }
    EXPECT_GT(turned.scene->environment_radiance(Vec3(1, 2, 0.5f).normalized())[0], 100.f) << "the sun";
}

TEST(DaylightEmitters, TheSunIsADiscOfItsRadianceWhateverItsSize) {
    const Vec3 sun = direction_at(40, 30);
    const std::string place = sun_at(sun.x(), sun.y(), sun.z());
    const Colord radiance = sun_radiance(3, 40 * degree);
    const Frame around(sun);
    const auto at = [&](const LoadedScene& scene, double degrees) {
        return scene.scene->environment_radiance(around.to_world(direction_at(degrees, 77)));
    };
    const LoadedScene plain = lit_by("sun", place);
    EXPECT_NEAR(at(plain, 0.26)[1] / radiance[1], 1, 1e-4);
    EXPECT_EQ(at(plain, 0.275)[1], 0.f);
    const double true_solid_angle = 2 * std::numbers::pi * (1 - std::cos(0.5 * sun_diameter * degree));
    for (const std::string& size : {number("sun_aperture", 10 * sun_diameter), number("sun_radius_scale", 10)}) {
        const LoadedScene wide = lit_by("sun", place + size);
        EXPECT_GT(at(wide, 2.6)[1], 0.f);
        EXPECT_EQ(at(wide, 2.75)[1], 0.f);
        for (const LoadedScene* scene : {&plain, &wide}) {
            const Colord power = power_of(scene->scene->lights()[0]);
            const double per_area = std::get<MappedEnvironment>(scene->scene->lights()[0]).scene.area();
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(power[c] / (per_area * radiance[c] * true_solid_angle), 1, 1e-4);
        }
    }
    // A radius of 0 makes parallel light of the same irradiance.
    const LoadedScene parallel = lit_by("sunsky", place + number("sun_radius_scale", 0));
    ASSERT_EQ(parallel.scene->lights().size(), 2u);
    const auto& light = std::get<DirectionalLight>(parallel.scene->lights()[0]);
    EXPECT_LT((light.direction + sun).norm(), 1e-5f);
    EXPECT_NEAR(light.irradiance[1] / (radiance[1] * true_solid_angle), 1, 1e-4);
    EXPECT_EQ(lit_by("sun", place + number("sun_radius_scale", 0)).scene->lights().size(), 1u);
}

// A disc that reaches below the horizon ends there, and so does its power.
TEST(DaylightEmitters, TheHorizonCutsTheSun) {
    const LoadedScene low = lit_by("sun", sun_at(1, 0, 0) + number("sun_aperture", 60)),
                      high = lit_by("sun", sun_at(1, 0, 1) + number("sun_aperture", 60));
    const auto share_of_disc = [](const LoadedScene& scene, const Vec3& inside) {
        const Light& light = scene.scene->lights()[0];
        const double disc = 2 * std::numbers::pi * (1 - std::cos(30 * degree));
        return power_of(light)[0] / std::get<MappedEnvironment>(light).scene.area() / disc /
               static_cast<double>(environment_radiance(light, inside)[0]);
    };
    EXPECT_NEAR(share_of_disc(high, Vec3(1, 0, 1).normalized()), 1, 1e-3);
    EXPECT_NEAR(share_of_disc(low, Vec3(1, 0, 0.1f).normalized()), 0.5, 0.01);
    EXPECT_TRUE(is_black(low.scene->environment_radiance(Vec3(1, 0, -0.01f).normalized())));
}

TEST(DaylightEmitters, ScalesMultiplySunAndSky) {
    const Vec3 sun = direction_at(40, 30), away = direction_at(40, 210);
    const std::string place = sun_at(sun.x(), sun.y(), sun.z());
    const auto radiance = [&](const std::string& type, const std::string& scales, const Vec3& w) {
        return static_cast<double>(lit_by(type, place + scales).scene->environment_radiance(w)[1]);
    };
    const double sky = radiance("sky", "", away), disc = radiance("sun", "", sun);
    EXPECT_NEAR(radiance("sunsky", "", away) / sky, 1, 1e-5);
    EXPECT_NEAR(radiance("sunsky", number("sky_scale", 3), away) / sky, 3, 1e-5);
    EXPECT_NEAR(radiance("sunsky", number("sky_scale", 0) + number("sun_scale", 0.5), sun) / disc, 0.5, 1e-5);
    EXPECT_NEAR(radiance("sunsky", number("sky_scale", 0) + number("scale", 0.5), sun) / disc, 0.5, 1e-5);
    EXPECT_EQ(radiance("sunsky", number("sky_scale", 0), away), 0.0);
    EXPECT_NEAR(radiance("sun", number("scale", 2), sun) / disc, 2, 1e-5);
}

// The sky at theta / stretch is seen at theta; the sun moves down with it.
TEST(DaylightEmitters, StretchReachesBelowTheHorizon) {
    const Vec3 sun = direction_at(30, 0);
    const std::string place = sun_at(sun.x(), sun.y(), sun.z());
    const LoadedScene plain = lit_by("sky", place), stretched = lit_by("sunsky", place + number("stretch", 1.5));
    for (double theta : {0.0, 30.0, 80.0}) {
        const Color a = plain.scene->environment_radiance(direction_at(theta, 140)),
                    b = stretched.scene->environment_radiance(direction_at(1.5 * theta, 140));
        EXPECT_LE((a - b).abs().maxCoeff(), 1e-3f * a.maxCoeff()) << theta;
    }
    EXPECT_TRUE(is_black(stretched.scene->environment_radiance(direction_at(136, 140))));
    EXPECT_GT(stretched.scene->environment_radiance(direction_at(45, 0))[0], 100.f);
}

// In Mitsuba 3's frame north is x, so the sun of Tokyo stands at -x at noon and at +y, in the west, at 15:00.
TEST(DaylightEmitters, TheTimePlacesTheSun) {
    const auto sun_of = [](const std::string& parameters) {
        const LoadedScene scene = lit_by("sunsky", parameters + number("sun_radius_scale", 0));
        return Vec3(-std::get<DirectionalLight>(scene.scene->lights()[0]).direction);
    };
    const Vec3 noon = sun_of(number("hour", 11) + number("minute", 47));
    EXPECT_LT(noon.x(), 0.f);
    EXPECT_NEAR(noon.y(), 0.f, 0.02f);
    EXPECT_NEAR(std::asin(noon.z()) / degree, 90 - 35.69 + 22.2, 0.3);
    EXPECT_GT(sun_of("").y(), 0.5f);
    EXPECT_LT(sun_of(number("hour", 8)).y(), -0.5f);
}

TEST(DaylightEmitters, WarnOfWhatDiffersFromMitsuba) {
    const std::string day = sun_at(0, 0, 1);
    EXPECT_THAT(lit_by("sunsky", day).warnings,
                testing::ElementsAre(HasSubstr("test.xml:3:1: the sky is that of Preetham, Shirley and Smits 1999")));
    EXPECT_THAT(lit_by("sky", day + number("turbidity", 1.5)).warnings,
                testing::Contains(HasSubstr("a 'turbidity' of 1.5 is read as 2")));
    EXPECT_TRUE(lit_by("sun", day).warnings.empty());
    const LoadedScene night = lit_by("sunsky", number("hour", 23));
    EXPECT_THAT(night.warnings, testing::Contains(HasSubstr("the sun is below the horizon, so that all is black")));
    EXPECT_FALSE(night.scene->has_light());
}

TEST(DaylightEmitters, Errors) {
    EXPECT_EQ(error_of("sunsky", rgb("albedo", 0.2) + integer("resolution", 64)), "no error");
    const auto expect = [](const std::string& type, const std::string& parameters, const std::string& message) {
        EXPECT_THAT(error_of(type, parameters), StartsWith("t.xml:4:")) << parameters;
        EXPECT_THAT(error_of(type, parameters), HasSubstr(message)) << parameters;
    };
    expect("sky", number("turbidity", 0.5), "'turbidity' must be between 1 and 10");
    expect("sky", rgb("albedo", 1.2), "'albedo'");
    expect("sky", number("hour", 25), "'hour' must be between 0 and 24");
    expect("sky", integer("month", 2) + integer("day", 30), "month 2 of 2010 has no day 30");
    expect("sky", number("hour", 5) + sun_at(1, 0, 0), "give either");
    expect("sky", sun_at(0, 0, 0), "'sun_direction' must not be zero");
    expect("sky", number("sun_scale", 1), "does not take a parameter 'sun_scale'");
    expect("sun", number("sky_scale", 1), "does not take a parameter 'sky_scale'");
    expect("sun", number("sun_radius_scale", 1e-3), "it must be 0, or between 0.01 and 180");
    expect("sunsky", number("stretch", 3), "'stretch' must be between 1 and 2");
    expect("sunsky", to_world(scale(2, 1, 1)), "must not scale or shear");
    EXPECT_THAT(error_of("sunsky", number("sun_scale", 1e38)), HasSubstr("t.xml:3:1: the light is too bright"));
    EXPECT_THAT(input_error_of([&] { load(ball + emitter("sky", "") + emitter("constant")); }),
                HasSubstr("only one environment"));
}

}  // namespace
}  // namespace gib::test::daylight_test
