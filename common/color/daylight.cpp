#include "common/color/daylight.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace gib {

namespace {

/// The cosine to the zenith is limited from below: at 0 exp(B / cos) is 0, as it is here.
constexpr double least_cosine = 0.01;

/// a T + b for Y, x and y.
Colord linear(double turbidity, const Colord& a, const Colord& b) { return turbidity * a + b; }

/// A polynomial of degree 3, highest power first.
double cubic(double x, double a, double b, double c, double d) { return ((a * x + b) * x + c) * x + d; }

/// Luminance [cd/m^2], x and y at the zenith.
Colord zenith_values(double t, double s) {
    const double chi = (4.0 / 9 - t / 120) * (std::numbers::pi - 2 * s);
    const double kilocandelas = (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
    const double x = sqr(t) * cubic(s, 0.00166, -0.00375, 0.00209, 0) +
                     t * cubic(s, -0.02903, 0.06377, -0.03202, 0.00394) + cubic(s, 0.11693, -0.21196, 0.06052, 0.25886);
    const double y = sqr(t) * cubic(s, 0.00275, -0.00610, 0.00317, 0) +
                     t * cubic(s, -0.04214, 0.08970, -0.04153, 0.00516) + cubic(s, 0.15346, -0.26756, 0.06670, 0.26688);
    return {1000 * kilocandelas, x, y};
}

// Tables of the sun's spectrum (Preetham et al. 1999, table 2): 380 to 750 nm in steps of 10 nm.
constexpr double first_wavelength = 380, last_wavelength = 750, wavelength_step = 10;
using SunTable = std::array<double, 38>;

/// Radiance of the sun outside of the atmosphere [W/(m^2 sr nm)].
constexpr SunTable outer_radiance = {
    16559.0, 16233.7, 21127.5, 25888.2, 25829.1, 24232.3, 26760.5, 29658.3, 30545.4, 30057.5, 30663.7, 28830.4, 28712.1,
    27825.0, 27100.6, 27233.6, 26361.3, 25503.8, 25060.2, 25311.6, 25355.9, 25134.2, 24631.5, 24173.2, 23685.3, 23212.1,
    22827.7, 22339.8, 21970.2, 21526.7, 21097.9, 20728.3, 20240.4, 19870.8, 19427.2, 19072.4, 18628.9, 18259.2};
/// Absorption by ozone [1/cm].
constexpr SunTable ozone = {0,     0,     0,     0,     0,     0,     0,     0.003, 0.006, 0.009, 0.014, 0.021, 0.030,
                            0.040, 0.048, 0.063, 0.075, 0.085, 0.103, 0.120, 0.120, 0.115, 0.125, 0.120, 0.105, 0.090,
                            0.079, 0.067, 0.057, 0.048, 0.036, 0.028, 0.023, 0.018, 0.014, 0.011, 0.010, 0.009};
/// Absorption by water vapour [1/cm]; 0 below 690 nm.
constexpr std::size_t first_of_vapour = 31;
constexpr std::array<double, 7> water_vapour = {0.016, 0.024, 0.0125, 1, 0.87, 0.061, 0.001};

double vapour_at(std::size_t i) { return i < first_of_vapour ? 0 : water_vapour[i - first_of_vapour]; }

double optical_mass(double sun_theta) {
    const double degrees = sun_theta * 180 / std::numbers::pi;
    return 1 / (std::cos(sun_theta) + 0.15 * std::pow(93.885 - degrees, -1.253));
}

}  // namespace

ClearSky::ClearSky(double t, double sun_theta)
    : a_(linear(t, {0.1787, -0.0193, -0.0167}, {-1.4630, -0.2592, -0.2608})),
      b_(linear(t, {-0.3554, -0.0665, -0.0950}, {0.4275, 0.0008, 0.0092})),
      c_(linear(t, {-0.0227, -0.0004, -0.0079}, {5.3251, 0.2125, 0.2102})),
      d_(linear(t, {0.1206, -0.0641, -0.0441}, {-2.5771, -0.8989, -1.6537})),
      e_(linear(t, {-0.0670, -0.0033, -0.0109}, {0.3703, 0.0452, 0.0529})),
      scale_(zenith_values(t, sun_theta) / perez(1, sun_theta)) {}

Colord ClearSky::perez(double cos_theta, double gamma) const {
    const Colord horizon = 1 + a_ * (b_ / std::max(cos_theta, least_cosine)).exp();
    return horizon * (1 + c_ * (d_ * gamma).exp() + e_ * sqr(std::cos(gamma)));
}

Colord ClearSky::luminance_and_chromaticity(double cos_theta, double gamma) const {
    return scale_ * perez(cos_theta, gamma);
}

Colord ClearSky::radiance(double cos_theta, double gamma) const {
    const Colord v = luminance_and_chromaticity(cos_theta, gamma);
    const double x = v[1], y = v[2];
    return rgb_of_xyz(v[0] / (luminance_per_radiance * y) * Colord(x, y, 1 - x - y)).max(0.0);
}

double sun_spectral_radiance(double wavelength, double turbidity, double sun_theta) {
    if (!(wavelength >= first_wavelength && wavelength <= last_wavelength)) return 0;
    const double place = (wavelength - first_wavelength) / wavelength_step;
    const std::size_t i = std::min(static_cast<std::size_t>(place), outer_radiance.size() - 2);
    const auto between = [&](double a, double b) { return std::lerp(a, b, place - static_cast<double>(i)); };
    const double m = optical_mass(sun_theta), micrometres = 1e-3 * wavelength;
    const double beta = 0.04608 * turbidity - 0.04586;
    const double scattered = 0.008735 * std::pow(micrometres, -4.08) + beta * std::pow(micrometres, -1.3);
    constexpr double ozone_cm = 0.35, water_cm = 2;
    const double absorbed = ozone_cm * between(ozone[i], ozone[i + 1]);
    const double vapour = water_cm * m * between(vapour_at(i), vapour_at(i + 1));
    return between(outer_radiance[i], outer_radiance[i + 1]) * std::exp(-m * (scattered + absorbed)) *
           std::exp(-0.2385 * vapour / std::pow(1 + 20.07 * vapour, 0.45));
}

Colord sun_radiance(double turbidity, double sun_theta) {
    const auto spectrum = [&](double wavelength) { return sun_spectral_radiance(wavelength, turbidity, sun_theta); };
    return rgb_of_spectrum(spectrum, Illuminant::none).max(0.0);
}

}  // namespace gib
