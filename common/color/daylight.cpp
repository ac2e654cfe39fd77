#include "common/color/daylight.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace gib {

namespace {

/// The published coefficients: for each channel, for the albedos 0 and 1 and the turbidities 1 to 10, control_values
/// of all parameters; then as many of the radiance.
constexpr double coefficients[] = {
#include "common/color/hosek_wilkie.inc"
};
constexpr std::size_t control_values = 6, parameters = 9, turbidities = 10;
constexpr std::size_t sets_of_channel = 2 * turbidities * control_values;
static_assert(std::size(coefficients) == 3 * sets_of_channel * (parameters + 1));

/// The weights of the control values at the sun's elevation: Bernstein's polynomials of degree 5.
std::array<double, control_values> bernstein(double sun_theta) {
    const double x = std::cbrt(std::max(1 - sun_theta / (0.5 * std::numbers::pi), 0.0)), y = 1 - x;
    return {std::pow(y, 5),         5 * x * std::pow(y, 4), 10 * sqr(x) * std::pow(y, 3), 10 * std::pow(x, 3) * sqr(y),
            5 * std::pow(x, 4) * y, std::pow(x, 5)};
}

/// A quantity whose control values stand `stride` apart from `first` on, linear in turbidity and albedo.
double interpolated(const double* first, std::size_t stride, double turbidity, double albedo,
                    const std::array<double, control_values>& weights) {
    const std::size_t below = std::min(static_cast<std::size_t>(turbidity), turbidities - 1);
    const double above = turbidity - static_cast<double>(below);
    double sum = 0;
    for (const std::size_t bright : {0, 1})
        for (const std::size_t hazy : {0, 1})
            for (std::size_t i = 0; i < control_values; ++i) {
                const std::size_t set = (bright * turbidities + below - 1 + hazy) * control_values + i;
                sum += (bright ? albedo : 1 - albedo) * (hazy ? above : 1 - above) * weights[i] * first[set * stride];
            }
    return sum;
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

ClearSky::ClearSky(double turbidity, const Colord& albedo, double sun_theta) {
    const auto weights = bernstein(sun_theta);
    for (int channel = 0; channel < 3; ++channel) {
        const double* first = coefficients + static_cast<std::size_t>(channel) * sets_of_channel * (parameters + 1);
        for (std::size_t i = 0; i < parameters; ++i)
            parameters_[i][channel] = interpolated(first + i, parameters, turbidity, albedo[channel], weights);
        mean_[channel] = interpolated(first + sets_of_channel * parameters, 1, turbidity, albedo[channel], weights) /
                         observer_y_integral;
    }
}

Colord ClearSky::radiance(double cos_theta, double gamma) const {
    const auto& [a, b, c, d, e, f, g, i, h] = parameters_;
    const double cosine = std::max(cos_theta, 0.0), cos_gamma = std::cos(gamma);
    const Colord chi = (1 + sqr(cos_gamma)) / (1 + h * h - 2 * cos_gamma * h).pow(1.5);
    const Colord horizon = 1 + a * (b / (cosine + 0.01)).exp();
    return (mean_ * horizon * (c + d * (e * gamma).exp() + f * sqr(cos_gamma) + g * chi + i * std::sqrt(cosine)))
        .max(0.0);
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
