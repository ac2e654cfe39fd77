#pragma once
// What dispersion does to a path, from the eye or from a light, and to two of them that are joined. See
// common/color/dispersion.h.

#include "common/color/dispersion.h"
#include "common/scene/scene.h"

#include <optional>

namespace gib {

/// Makes a hit on a material that splits light what it is to the path's stratum of wavelengths, which the first such
/// hit decides by `u`; from there on `beta`, the path's throughput or power, has the stratum's weight.
inline void disperse(const Scene& scene, float u, SurfaceHit& hit, std::optional<int>& stratum, Color& beta) {
    if (!scene.material_of_shape(hit.shape).is_dispersive()) return;
    if (!stratum) {
        stratum = static_cast<int>(wavelength_strata * u);
        beta *= stratum_weight(*stratum);
    }
    scene.disperse(hit, *stratum);
}

/// Whether paths of these strata carry the same light somewhere.
inline bool can_join(std::optional<int> a, std::optional<int> b) { return !a || !b || *a == *b; }

/// The factor of a product of two paths that can be joined: both have the weight of their stratum, and of pairs of
/// strata only those that are equal are counted.
inline Color joint_weight(std::optional<int> a, std::optional<int> b) {
    if (!a || !b) return Color::Ones();
    const Color& weight = stratum_weight(*a);
    return (weight > 0.f).select(static_cast<float>(wavelength_strata) / weight, Color::Zero());
}

}  // namespace gib
