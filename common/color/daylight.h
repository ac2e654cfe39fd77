#pragma once
// Colours of daylight: the radiance of a clear sky and of the sun's disc. Source: Preetham, Shirley and Smits 1999, "A
// Practical Analytic Model for Daylight" (SIGGRAPH 99).

#include "common/color/cie.h"

namespace gib {

/// The turbidities for which the sky's formula holds: 2 is a very clear day, 10 a hazy one. Below 2 the zenith's
/// luminance falls to 0.
inline constexpr double least_turbidity = 2, largest_turbidity = 10;

/// Luminance [cd/m^2] of a radiance whose y is 1 W/(m^2 sr nm) as rgb_of_spectrum() normalises it: 683 lm/W times the
/// integral of the observer's y [nm].
inline constexpr double luminance_per_radiance = 683 * observer_y_integral;

/// The radiance of a clear sky. Luminance and the chromaticities x and y each are Perez's function F of the angle
/// theta between direction and zenith and of the angle gamma between direction and sun,
///     F(theta, gamma) = (1 + A exp(B / cos theta)) (1 + C exp(D gamma) + E cos^2 gamma),
/// times their value at the zenith over F(0, theta_s), where theta_s is the sun's angle to the zenith. A to E are
/// linear in the turbidity; the values at the zenith are given by the turbidity and theta_s (the paper's appendix).
class ClearSky {
public:
    /// `turbidity` lies in [least_turbidity, largest_turbidity], `sun_theta` [rad] in [0, pi / 2].
    ClearSky(double turbidity, double sun_theta);

    /// Luminance [cd/m^2] and chromaticities x and y in a direction with this cosine >= 0 to the zenith at the angle
    /// gamma [rad] to the sun.
    Colord luminance_and_chromaticity(double cos_theta, double gamma) const;
    /// Linear RGB with sRGB's primaries [W/(m^2 sr nm)]; colours that RGB cannot hold are clamped to 0.
    Colord radiance(double cos_theta, double gamma) const;

private:
    Colord perez(double cos_theta, double gamma) const;

    Colord a_, b_, c_, d_, e_;  ///< coefficients A to E of Perez's formula, for Y, x and y
    Colord scale_;              ///< values at the zenith over F(0, theta_s)
};

/// Spectral radiance [W/(m^2 sr nm)] of the sun's disc at a wavelength [nm] on the ground: that outside of the
/// atmosphere, dimmed by Rayleigh scattering, by aerosols (Angstrom's formula with the exponent 1.3 and the turbidity
/// 0.04608 T - 0.04586), by 0.35 cm of ozone and by 2 cm of water vapour (the paper's appendix). Scattering and ozone
/// are exponential in the relative optical mass m = 1 / (cos theta_s + 0.15 (93.885 - theta_s in degrees)^-1.253). The
/// mixed gases of the paper absorb above 759 nm only; here all is 0 beyond the table, which has 380 to 750 nm.
double sun_spectral_radiance(double wavelength, double turbidity, double sun_theta);

/// The colour of that spectrum [W/(m^2 sr nm)], the mean over the disc: linear RGB with sRGB's primaries.
Colord sun_radiance(double turbidity, double sun_theta);

/// The sun's diameter as seen from the earth [degrees], which both versions of Mitsuba take.
inline constexpr double sun_diameter = 0.5358;

}  // namespace gib
