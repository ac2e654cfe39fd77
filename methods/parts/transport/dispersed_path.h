#pragma once
// The effect of dispersion on a path from the eye or from a light, and on two paths that are joined. The model of
// strata of wavelengths is described in common/color/dispersion.h.

#include "common/color/dispersion.h"
#include "common/scene/scene.h"

#include <optional>

namespace gib {

/// If the hit's material splits light by wavelength, gives the hit the optical properties for the path's stratum of
/// wavelengths. The first such hit chooses the stratum by `u` and multiplies `beta`, the path's throughput or power,
/// by the weight of the stratum.
inline void disperse(const Scene& scene, float u, SurfaceHit& hit, std::optional<int>& stratum, Color& beta) {
    if (!scene.material_of_shape(hit.shape).is_dispersive()) return;
    if (!stratum) {
        stratum = static_cast<int>(wavelength_strata * u);
        beta *= stratum_weight(*stratum);
    }
    scene.disperse(hit, *stratum);
}

/// Whether paths of these strata have wavelengths in common; an empty stratum stands for all wavelengths.
inline bool can_join(std::optional<int> a, std::optional<int> b) { return !a || !b || *a == *b; }

/// Factor for the product of two paths that can be joined. If both were split, the product has the weight of their
/// stratum twice, so one is divided out; and only pairs of equal strata are counted, one in wavelength_strata, so the
/// rest is multiplied by that number.
inline Color joint_weight(std::optional<int> a, std::optional<int> b) {
    if (!a || !b) return Color::Ones();
    const Color& weight = stratum_weight(*a);
    return (weight > 0.f).select(static_cast<float>(wavelength_strata) / weight, Color::Zero());
}

}  // namespace gib
