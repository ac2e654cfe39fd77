// Tests of daylight: the course of the sun over a day and a year, the sky against values of its authors' program (Hosek
// and Wilkie 2012), the sun against the formulas of Preetham, Shirley and Smits 1999, and the emitters sunsky, sky and
// sun: their radiance in space, units and errors.

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

double luminance_of(const Colord& radiance) {
    return (Colord(0.212671, 0.715160, 0.072169) * radiance).sum() * luminance_per_radiance;
}

// Radiance [W/(m^2 sr)] to 10 digits from the authors' own program, release 1.4a: at the zenith, 0.9 degrees above the
// horizon at 90 degrees to the sun, at 0.02 rad from the sun at its height, and at 45 degrees on the other side. The
// three skies are a clear day, a low sun in haze above bright ground, and the corner of the domain.
TEST(Daylight, TheSkyHasTheRadianceOfItsAuthorsProgram) {
    struct Probe {
        double cos_theta, gamma;
        Colord radiance;
    };
    struct Sky {
        double turbidity, albedo, elevation;
        std::vector<Probe> probes;
    };
    const std::vector<Sky> skies = {
        {3,
         0.1,
         41.34,
         {{1, 8.492772140e-01, {2.106288222, 3.705107844, 7.529882321}},
          {1.570731731e-02, 1.570796327, {11.44671805, 14.64196195, 15.75246998}},
          {6.605259884e-01, 0.02, {19.57413890, 21.48955019, 23.46139991}},
          {7.071067812e-01, 2.356194490, {2.775733580, 5.208588035, 10.08280216}}}},
        {6.4,
         0.35,
         8,
         {{1, 1.431169987, {1.226093933, 1.953442031, 2.902180205}},
          {1.570731731e-02, 1.570796327, {4.930690242, 4.051640846, 2.548814235}},
          {1.391731010e-01, 0.02, {127.5508363, 81.65285245, 29.08050545}},
          {7.071067812e-01, 2.356194490, {2.456423394, 3.547881710, 4.593837072}}}},
        {1,
         0,
         89.9,
         {{1, 1.745329252e-03, {2.411591853, 6.383705304, 9.836067376}},
          {1.570731731e-02, 1.570796327, {10.38521413, 16.23359432, 17.88283919}},
          {9.999984769e-01, 0.02, {2.352974444, 6.202017652, 9.816296318}},
          {7.071067812e-01, 2.356194490, {1.376119801, 4.231696370, 9.614013445}}}},
    };
    for (const Sky& s : skies) {
        const ClearSky sky(s.turbidity, Colord::Constant(s.albedo), (90 - s.elevation) * degree);
        for (const Probe& probe : s.probes) {
            const Colord ratio = sky.radiance(probe.cos_theta, probe.gamma) * observer_y_integral / probe.radiance;
            EXPECT_LE((ratio - 1).abs().maxCoeff(), 1e-9) << s.turbidity << ' ' << probe.gamma;
        }
    }
}

// The colour of the ground tints the sky: the radiance of each channel grows with the albedo of this channel alone.
TEST(Daylight, TheGroundsAlbedoActsOnItsChannel) {
    for (double turbidity : {1.0, 2.5, 4.0, 9.0, 10.0}) {
        const double sun = 40 * degree;
        const ClearSky dark(turbidity, Colord(0, 0, 0), sun), green(turbidity, Colord(0, 0.8, 0), sun),
            bright(turbidity, Colord(0.8, 0.8, 0.8), sun);
        const Colord d = dark.radiance(0.7, 1.2), g = green.radiance(0.7, 1.2), b = bright.radiance(0.7, 1.2);
        EXPECT_EQ(g[0], d[0]);
        EXPECT_EQ(g[1], b[1]);
        EXPECT_EQ(g[2], d[2]);
        EXPECT_GT((b / d).minCoeff(), 1.05) << turbidity;
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
    EXPECT_GT(luminance_of(high) * solid_angle, 60e3);
    EXPECT_LT(luminance_of(high) * solid_angle, 110e3);
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
    const LoadedScene scene =
        lit_by("sky", number("turbidity", 4) + rgb("albedo", "0.1 0.5 0.9") + sun_at(sun) + number("scale", 2));
    const ClearSky sky(4, Colord(0.1f, 0.5f, 0.9f), 55 * degree);
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
    for (double aside : {20.0, 90.0, 170.0}) {
        const Color left = scene.scene->environment_radiance(direction_at(60, 200 - aside)),
                    right = scene.scene->environment_radiance(direction_at(60, 200 + aside));
        EXPECT_LE((left / right - 1).abs().maxCoeff(), 0.001f) << aside << " degrees to the left and right of the sun";
    }
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

// The radiance of the horizon goes on below it, times 3 x^2 - 2 x^3, where x falls from 1 at the horizon to 0 at the
// nadir.
TEST(DaylightEmitters, ExtendFadesTheHorizonToTheNadir) {
    const Vec3 sun = direction_at(30, 0);
    const LoadedScene plain = lit_by("sky", sun_at(sun)), extended = lit_by("sky", sun_at(sun) + flag("extend", true));
    const auto at = [](const LoadedScene& scene, double theta) {
        return scene.scene->environment_radiance(direction_at(theta, 140));
    };
    for (double theta : {0.0, 30.0, 80.0, 89.0})
        EXPECT_LE((at(extended, theta) / at(plain, theta) - 1).abs().maxCoeff(), 1e-3f) << theta;
    const Color horizon = at(plain, 90);
    EXPECT_GT(horizon.minCoeff(), 0.f);
    EXPECT_LE((at(extended, 135) / horizon - 0.5f).abs().maxCoeff(), 1e-3f);
    EXPECT_LE((at(extended, 112.5) / horizon - 0.84375f).abs().maxCoeff(), 1e-3f);
    EXPECT_TRUE(is_black(at(extended, 180)));
    EXPECT_TRUE(is_black(at(plain, 135)));
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

}  // namespace
}  // namespace gib::test::daylight_test
