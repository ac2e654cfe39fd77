#pragma once
// The phase function of a medium. Directions point away from the point: light comes from wi and leaves along wo.

#include "common/core/math.h"

namespace gib {

/// Henyey and Greenstein 1941, "Diffuse radiation in the galaxy":
///     p(wo, wi) = (1 - g^2) / (4 pi (1 + g^2 + 2 g wo.wi)^1.5)   [1/sr]
/// It is isotropic for g = 0. Or that of particles much smaller than the wavelength (Rayleigh 1871; unpolarised light):
///     p(wo, wi) = 3 / (16 pi) (1 + (wo.wi)^2)   [1/sr]
/// Both integrate to 1 over either direction and are sampled exactly, so that their samples have weight 1.
struct PhaseFunction {
    enum class Model { henyey_greenstein, rayleigh };

    float g = 0.f;  ///< mean cosine of the scattering angle, -1 < g < 1; above 0 light is scattered forwards
    Model model = Model::henyey_greenstein;     ///< `rayleigh` has a mean cosine of 0 and does not use g
    static constexpr float largest_g = 0.999f;  ///< beyond it the peak is too narrow for directions in float

    float value(const Vec3& wo, const Vec3& wi) const;
    /// A direction with density value(wo, wi) [1/sr].
    Vec3 sample(const Vec3& wo, const Vec2& u) const;
};

}  // namespace gib
