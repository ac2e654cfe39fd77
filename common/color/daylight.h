#pragma once
// Colours of daylight: the radiance of a clear sky and of the sun's disc. Sources: Hosek and Wilkie 2012, "An Analytic
// Model for Full Spectral Sky-Dome Radiance" (SIGGRAPH 2012), for the sky; Preetham, Shirley and Smits 1999, "A
// Practical Analytic Model for Daylight" (SIGGRAPH 99), for the sun.

#include "common/color/cie.h"

#include <array>

namespace gib {

/// The turbidities for which there are coefficients of the sky: 1 is air without aerosols, 3 a clear day, 10 a hazy
/// one.
inline constexpr double least_turbidity = 1, largest_turbidity = 10;

/// Luminance [cd/m^2] of a radiance whose y is 1 W/(m^2 sr nm) as rgb_of_spectrum() normalises it: 683 lm/W times the
/// integral of the observer's y [nm].
inline constexpr double luminance_per_radiance = 683 * observer_y_integral;

/// The radiance of a clear sky. Hosek and Wilkie give the coefficients for linear RGB with sRGB's primaries.
/// Each channel is the radiance L_M times F of the angle theta between direction and zenith and of the angle gamma
/// between direction and sun, the paper's extension of Perez's formula,
///     F(theta, gamma) = (1 + A exp(B / (cos theta + 0.01)))
///                       (C + D exp(E gamma) + F cos^2 gamma + G chi(H, gamma) + I cos^(1/2) theta),
///     chi(g, alpha) = (1 + cos^2 alpha) / (1 + g^2 - 2 g cos alpha)^(3/2).
/// A to I and L_M are linear in the turbidity and in the albedo of the ground, and Bezier curves of degree 5 in
/// x = (elevation of the sun / (pi / 2))^(1/3).
class ClearSky {
public:
    /// `turbidity` lies in [least_turbidity, largest_turbidity], `albedo` of the ground in [0, 1], `sun_theta` [rad],
    /// the sun's angle to the zenith, in [0, pi / 2].
    ClearSky(double turbidity, const Colord& albedo, double sun_theta);

    /// Linear RGB [W/(m^2 sr nm)], as rgb_of_spectrum() normalises it, in a direction with this cosine to the zenith at
    /// the angle gamma [rad] to the sun. A cosine below 0 counts as 0, the horizon. The radiance is 0 where F is
    /// negative, which happens for turbidities of 6 to 8 opposite to a sun above 85 degrees.
    Colord radiance(double cos_theta, double gamma) const;

private:
    std::array<Colord, 9> parameters_;  ///< in the order of the published coefficients: A to G, I, H
    Colord mean_;                       ///< L_M [W/(m^2 sr nm)]
};

/// Spectral radiance [W/(m^2 sr nm)] of the sun's disc at a wavelength [nm] on the ground: that outside of the
/// atmosphere, dimmed by Rayleigh scattering, by aerosols (Angstrom's formula with the exponent 1.3 and the turbidity
/// 0.04608 T - 0.04586), by 0.35 cm of ozone and by 2 cm of water vapour (Preetham et al., appendix). Scattering and
/// ozone are exponential in the relative optical mass
///     m = 1 / (cos theta_s + 0.15 (93.885 - theta_s in degrees)^-1.253).
/// The mixed gases there absorb above 759 nm only; here all is 0 beyond the table, which has 380 to 750 nm.
double sun_spectral_radiance(double wavelength, double turbidity, double sun_theta);

/// The colour of that spectrum [W/(m^2 sr nm)], the mean over the disc: linear RGB with sRGB's primaries.
Colord sun_radiance(double turbidity, double sun_theta);

/// The sun's diameter as seen from the earth [degrees], which both versions of Mitsuba take.
inline constexpr double sun_diameter = 0.5358;

}  // namespace gib
