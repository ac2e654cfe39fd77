#pragma once
// Regions of the visibility map: a tree over the shadow photons of a surface, in whose leaves
// the same lights are seen.
//
// A region in which some light is still open, or whose photons resolve finer parts, is split at the median of the
// longest axis of its photons. A verdict of a region holds in all its parts, so a light's verdict comes from the
// largest region in which the photons of the light agree.

#include "methods/parts/shadow_photons/shadow_photons.h"

#include <memory>
#include <vector>

namespace gib {

/// Whether a light is seen from a region.
enum class LightVerdict : std::uint32_t {
    open,  ///< it is seen from a part of the region, or it has too few photons to decide
    lit,   ///< it is seen from all of the region
    dark   ///< it is seen from nowhere in the region
};

/// The evidence that the photons of one light give about it in a region.
struct LightEvidence {
    std::uint32_t light;
    LightVerdict verdict = LightVerdict::open;
    std::uint32_t photons = 0;
    /// Power that would arrive in the region if nothing stood in the way, estimated as (n U + 8 U') / (n + 8), where
    /// U is the power of the light's n photons here and U' is the power to expect from the light's
    /// share in the larger region.
    double unoccluded = 0;
    /// Share of that power which arrives: the mean (n v + 1) / (n + 2) of the posterior for a uniform prior, where v
    /// is the share of the photons' power that arrives. With fewer than 8 photons the larger region's value is used.
    double visible = 0.5;
    /// The light's interval of [0, 1) in the choice of a light by these photons.
    float begin = 0.f, probability = 0.f;

    /// Irradiance that the light is expected to add in the region, on a scale that is common to all lights.
    double expected() const { return verdict == LightVerdict::lit ? unoccluded : unoccluded * visible; }
};

/// A node of the tree. Its photons lie below or above the split; a leaf has no children.
struct VisibilityRegion {
    std::vector<LightEvidence> lights;  ///< by light, those with a photon in the root; empty in inner nodes
    double share = 1;                   ///< share of the root's unoccluded power that belongs to this region
    float rest = 1.f;                   ///< probability of a choice among all lights; in leaves
    float split = 0.f;                  ///< below: p[axis] < split
    std::uint32_t axis = 0;
    std::unique_ptr<VisibilityRegion> below, above;

    bool is_leaf() const { return !below; }
};

/// Number of a light's photons that must agree before they are believed.
inline constexpr std::uint32_t agreeing_photons = 32;
/// A value of `agreeing` that no region reaches, so that all lights stay open.
inline constexpr std::uint32_t never_agreeing = ~0u;

/// Builds the tree, the same for any number of threads. `photons` must be sorted by light. Null if there are none.
std::unique_ptr<VisibilityRegion> build_visibility_regions(std::vector<ShadowPhoton> photons, std::uint32_t agreeing);

}  // namespace gib
