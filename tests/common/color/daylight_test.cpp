// Tests of the colours of daylight against the formulas of Preetham, Shirley and Smits 1999.

#include "common/color/daylight.h"

#include <gtest/gtest.h>

#include <numbers>

namespace gib::test::daylight_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

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

}  // namespace
}  // namespace gib::test::daylight_test
