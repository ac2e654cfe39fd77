#pragma once
// A clear layer over another material: light is refracted on its way in and out. The reflection of its surface is a layer
// of its own (Material's Coating).

#include "common/materials/plastic.h"

namespace gib {

/// Mitsuba 0.6's `coating` and `roughcoating` without what their surfaces reflect. With w' the refracted direction, T the
/// share of light that the surface transmits, a the absorption and f' the material inside,
///     f(wo, wi) = f'(wo', wi') T(wo) T(wi) exp(-a (1 / |cos wo'| + 1 / |cos wi'|)) / eta^2
/// Light that the surface reflects back inside is lost, so that a coat darkens what it covers. Directions on either side
/// of the surface are refracted alike.
struct Coat {
    float eta = 1.f;                         ///< index of the coat / index outside
    Color absorption = Color::Zero();        ///< absorption coefficient times thickness: optical depth straight through
    std::shared_ptr<const RoughCoat> rough;  ///< T of a rough surface; null: it is smooth, and T = 1 - F

    /// The direction inside of light from w outside; its cosine is 0 where all light is reflected.
    Vec3 refracted(const Vec3& w) const;
    /// The direction outside of light from w inside; empty at total internal reflection.
    std::optional<Vec3> leaving(const Vec3& w) const;
    /// The share of light from w outside that arrives below the coat along `inside`, or the other way round.
    Color transmittance(const Vec3& w, const Vec3& inside) const;
};

}  // namespace gib
