// Tests of daylight: the course of the sun over a day and a year, the colours of sky and sun against the formulas of
// Preetham, Shirley and Smits 1999, and the emitters sunsky, sky and sun: their radiance in space, units and errors.

#include "common/color/daylight.h"
#include "common/lights/sun_position.h"
#include "common/scene/scene.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/scene_errors.h"

#include <numbers>

namespace gib::test::daylight_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// The highest sun of a day, from one minute to the next.
struct Noon {
    double elevation = -90, azimuth = 0, hour = 0;  ///< [degrees], local time
};
Noon noon_of(TimeAndPlace at) {
    Noon noon;
    for (int minute = 0; minute < 24 * 60; ++minute) {
        at.hour = minute / 60;
        at.minute = minute % 60;
        const SunAngles sun = sun_position(at);
        const double elevation = 90 - sun.theta / degree;
        if (elevation > noon.elevation) noon = {elevation, sun.azimuth / degree, minute / 60.0};
    }
    return noon;
}

// On the solstices the sun stands over the latitudes 23.44 and -23.44 degrees, on the equinoxes over the equator. The
// tolerance is the change of its declination within half a day.
TEST(SunPosition, NoonOfSolsticesAndEquinoxes) {
    TimeAndPlace at{.year = 2010, .month = 6, .day = 21, .timezone = 0, .latitude = 51.4779, .longitude = 0};
    EXPECT_NEAR(noon_of(at).elevation, 90 - 51.4779 + 23.44, 0.01);
    EXPECT_NEAR(std::abs(noon_of(at).azimuth), 180, 1) << "in the south";
    at.latitude = -35;
    EXPECT_NEAR(noon_of(at).elevation, 90 - 35 - 23.44, 0.01);
    EXPECT_NEAR(noon_of(at).azimuth, 0, 1) << "in the north";
    at.month = 12;
    EXPECT_NEAR(noon_of(at).elevation, 90 - 35 + 23.44, 0.01);
    at = {.year = 2010, .month = 3, .day = 20, .timezone = 0, .latitude = 0, .longitude = 0};
    EXPECT_NEAR(noon_of(at).elevation, 90, 0.25);
}

// The sun is early by 16.4 minutes on 3 November and late by 14.2 on 11 February (the equation of time), and 4 minutes
// later for each degree to the west of the meridian of the time zone.
TEST(SunPosition, NoonFollowsTheEquationOfTimeAndTheLongitude) {
    TimeAndPlace at{.year = 2010, .month = 11, .day = 3, .timezone = 0, .latitude = 40, .longitude = 0};
    EXPECT_NEAR(60 * (noon_of(at).hour - 12), -16.4, 1);
    at.month = 2, at.day = 11;
    EXPECT_NEAR(60 * (noon_of(at).hour - 12), 14.2, 1);
    at.longitude = -10;
    EXPECT_NEAR(60 * (noon_of(at).hour - 12), 14.2 + 40, 1);
    at.timezone = -1;
    EXPECT_NEAR(60 * (noon_of(at).hour - 12), 14.2 + 40 - 60, 1);
}

TEST(SunPosition, RisesInTheEastAndSetsInTheWest) {
    TimeAndPlace at{.year = 2010, .month = 3, .day = 20, .hour = 6.13, .timezone = 0, .latitude = 30, .longitude = 0};
    EXPECT_NEAR(sun_position(at).azimuth / degree, 90, 1);
    EXPECT_NEAR(sun_position(at).theta / degree, 90, 1);
    at.hour = 18.13;
    EXPECT_NEAR(std::fmod(sun_position(at).azimuth / degree + 360, 360), 270, 1);
    EXPECT_NEAR(sun_position(at).theta / degree, 90, 1);
}

TEST(SunPosition, KnowsTheCalendar) {
    EXPECT_TRUE(is_date({.year = 2012, .month = 2, .day = 29}));
    EXPECT_FALSE(is_date({.year = 2010, .month = 2, .day = 29}));
    EXPECT_FALSE(is_date({.month = 4, .day = 31}));
}

struct Zenith {
    double turbidity, sun_degrees;
    double kilocandelas, x, y;
};

// The values are the paper's polynomials, computed by a script of their own.
TEST(Daylight, TheZenithHasThePolynomialsValues) {
    for (const Zenith& z : {Zenith{3, 0, 29.477313, 0.270680, 0.282360}, Zenith{2, 45, 4.469642, 0.240952, 0.243722},
                            Zenith{3, 45, 7.320358, 0.245678, 0.251476}, Zenith{6, 60, 9.585270, 0.265468, 0.281789},
                            Zenith{10, 80, 4.760601, 0.306356, 0.331475}}) {
        const double theta = z.sun_degrees * degree;
        const Colord v = ClearSky(z.turbidity, theta).luminance_and_chromaticity(1, theta);
        EXPECT_NEAR(v[0], 1000 * z.kilocandelas, 0.01) << z.turbidity;
        EXPECT_NEAR(v[1], z.x, 1e-6) << z.turbidity;
        EXPECT_NEAR(v[2], z.y, 1e-6) << z.turbidity;
    }
}

// For the turbidity 4, Perez's luminance has A = -0.7482, B = -0.9941, C = 5.2343, D = -2.0947, E = 0.1023.
TEST(Daylight, LuminanceFollowsPerez) {
    const auto perez = [](double theta, double gamma) {
        return (1 - 0.7482 * std::exp(-0.9941 / std::cos(theta))) *
               (1 + 5.2343 * std::exp(-2.0947 * gamma) + 0.1023 * sqr(std::cos(gamma)));
    };
    const double sun = 50 * degree;
    const ClearSky sky(4, sun);
    const double zenith = sky.luminance_and_chromaticity(1, sun)[0];
    for (double theta : {0.0, 30.0, 60.0, 85.0})
        for (double gamma : {0.0, 20.0, 90.0, 130.0})
            EXPECT_NEAR(sky.luminance_and_chromaticity(std::cos(theta * degree), gamma * degree)[0] / zenith,
                        perez(theta * degree, gamma * degree) / perez(0, sun), 1e-6)
                << theta << ' ' << gamma;
    EXPECT_NEAR(sky.luminance_and_chromaticity(0, sun)[0] / zenith, perez(1.57, sun) / perez(0, sun), 1e-6)
        << "horizon";
}

// Luminance in the unit of radiance is 683 lm/W times the integral of y. A clear sky is blue.
TEST(Daylight, RadianceHasTheLuminance) {
    for (double turbidity : {2.0, 3.0, 8.0})
        for (double sun : {10.0, 70.0}) {
            const ClearSky sky(turbidity, sun * degree);
            for (double gamma : {5.0, 60.0}) {
                const Colord rgb = sky.radiance(0.7, gamma * degree);
                EXPECT_GT(rgb.minCoeff(), 0);
                const double y = 0.212671 * rgb[0] + 0.715160 * rgb[1] + 0.072169 * rgb[2];
                EXPECT_NEAR(y * luminance_per_radiance / sky.luminance_and_chromaticity(0.7, gamma * degree)[0], 1,
                            1e-5);
            }
            if (turbidity <= 3) {
                EXPECT_GT(sky.radiance(0.7, 60 * degree)[2], 1.2 * sky.radiance(0.7, 60 * degree)[0]);
            }
        }
}

// ln(L) is linear in the optical mass where water vapour does not absorb (Beer and Lambert); at mass 0 it is the
// table's radiance outside of the atmosphere, and the slope is that of scattering and ozone.
TEST(Daylight, TheSunIsDimmedAlongTheWayThroughTheAir) {
    const auto mass = [](double degrees) {
        return 1 / (std::cos(degrees * degree) + 0.15 * std::pow(93.885 - degrees, -1.253));
    };
    struct Row {
        double wavelength, outside, ozone;
    };
    for (const Row& row : {Row{400, 21127.5, 0}, Row{550, 25503.8, 0.085}, Row{600, 24631.5, 0.125},
                           Row{555, 0.5 * (25503.8 + 25060.2), 0.094}}) {
        const double high = std::log(sun_spectral_radiance(row.wavelength, 3, 20 * degree)),
                     low = std::log(sun_spectral_radiance(row.wavelength, 3, 80 * degree));
        const double slope = (low - high) / (mass(80) - mass(20)), micrometres = row.wavelength / 1000;
        EXPECT_NEAR(-slope,
                    0.008735 * std::pow(micrometres, -4.08) + (0.04608 * 3 - 0.04586) * std::pow(micrometres, -1.3) +
                        0.35 * row.ozone,
                    1e-9);
        EXPECT_NEAR(std::exp(high - slope * mass(20)) / row.outside, 1, 1e-9) << row.wavelength;
    }
    const double dry = sun_spectral_radiance(700, 3, 0), wet = sun_spectral_radiance(720, 3, 0);
    EXPECT_LT(wet, 0.92 * dry) << "water vapour";
    EXPECT_EQ(sun_spectral_radiance(379, 3, 0), 0);
    EXPECT_EQ(sun_spectral_radiance(751, 3, 0), 0);
}

// The illuminance of the sun on a plane across its rays is 60 to 110 klx when it is high on a clear day; the low sun is
// red.
TEST(Daylight, TheSunHasTheIlluminanceOfADay) {
    const double solid_angle = 2 * std::numbers::pi * (1 - std::cos(0.5 * sun_diameter * degree));
    const Colord high = sun_radiance(3, 20 * degree), low = sun_radiance(3, 87 * degree);
    const double y = 0.212671 * high[0] + 0.715160 * high[1] + 0.072169 * high[2];
    EXPECT_GT(y * luminance_per_radiance * solid_angle, 60e3);
    EXPECT_LT(y * luminance_per_radiance * solid_angle, 110e3);
    EXPECT_GT(low[0] / low[2], 2 * high[0] / high[2]);
}

const std::string ball = shape("sphere") + "\n";

std::string sun_at(double x, double y, double z) {
    return "<vector name='sun_direction' value='" + std::to_string(x) + " " + std::to_string(y) + " " +
           std::to_string(z) + "'/>";
}
std::string sun_at(const Vec3& w) { return sun_at(w.x(), w.y(), w.z()); }
LoadedScene lit_by(const std::string& type, const std::string& parameters) {
    return load(ball + emitter(type, "\n", parameters));
}
std::string error_of(const std::string& type, const std::string& parameters) {
    return scene_error(ball + emitter(type, "\n", parameters));
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
    const LoadedScene scene = lit_by("sky", number("turbidity", 4) + sun_at(sun) + number("scale", 2));
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
    const std::string place = sun_at(sun);
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
    const auto radiance = [&](const std::string& type, const std::string& scales, const Vec3& w) {
        return static_cast<double>(lit_by(type, sun_at(sun) + scales).scene->environment_radiance(w)[1]);
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
    const LoadedScene plain = lit_by("sky", sun_at(sun)),
                      stretched = lit_by("sunsky", sun_at(sun) + number("stretch", 1.5));
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
    const std::tuple<std::string, std::string, std::string> rows[] = {
        {"sky", number("turbidity", 0.5), "'turbidity' must be between 1 and 10"},
        {"sky", rgb("albedo", 1.2), "'albedo'"},
        {"sky", number("hour", 25), "'hour' must be between 0 and 24"},
        {"sky", integer("month", 2) + integer("day", 30), "month 2 of 2010 has no day 30"},
        {"sky", number("hour", 5) + sun_at(1, 0, 0), "give either"},
        {"sky", sun_at(0, 0, 0), "'sun_direction' must not be zero"},
        {"sky", number("sun_scale", 1), "does not take a parameter 'sun_scale'"},
        {"sun", number("sky_scale", 1), "does not take a parameter 'sky_scale'"},
        {"sun", number("sun_radius_scale", 1e-3), "it must be 0, or between 0.01 and 180"},
        {"sunsky", number("stretch", 3), "'stretch' must be between 1 and 2"},
        {"sunsky", to_world(scale(2, 1, 1)), "must not scale or shear"}};
    for (const auto& [type, parameters, message] : rows)
        EXPECT_THAT(error_of(type, parameters), AllOf(StartsWith("t.xml:4:"), HasSubstr(message))) << parameters;
    EXPECT_THAT(error_of("sunsky", number("sun_scale", 1e38)), HasSubstr("t.xml:3:1: the light is too bright"));
    EXPECT_THAT(input_error_of([&] { load(ball + emitter("sky") + emitter("constant")); }),
                HasSubstr("only one environment"));
}

}  // namespace
}  // namespace gib::test::daylight_test
