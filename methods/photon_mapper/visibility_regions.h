#pragma once
// Cells of surfaces by which lights are seen from them: a tree over the shadow photons of a surface.
//
// A region with too much to tell is split at the median of the longest axis of its photons. What one region has settled
// about a light stays settled in its parts, so that a light's verdict comes from the largest region in which its
// photons agree.

#include "methods/photon_mapper/shadow_photons.h"

#include <memory>
#include <vector>

namespace gib {

/// Whether a light is seen from a region.
enum class LightVerdict : std::uint32_t {
    open,  ///< from a part of it, or its photons are too few to tell
    lit,   ///< from all of it
    dark   ///< from nowhere
};

/// What the photons of one light say in a region.
struct LightEvidence {
    std::uint32_t light;
    LightVerdict verdict = LightVerdict::open;
    std::uint32_t photons = 0;
    /// Power that would arrive in the region if nothing stood in the way: with n photons (n U + 8 U') / (n + 8), where U
    /// is their power and U' what the light's share in the larger region lets expect.
    double unoccluded = 0;
    /// The share of it that arrives: the mean (n v + 1) / (n + 2) of a posterior, where v is the photons' share; with
    /// fewer than 8 photons the larger region's.
    double visible = 0.5;

    /// What the light is expected to add to the irradiance of the region, on a scale that all lights share.
    double expected() const { return verdict == LightVerdict::lit ? unoccluded : unoccluded * visible; }
};

struct VisibilityRegion {
    std::vector<LightEvidence> lights;  ///< those of which a photon lies in the root, by light; empty but in leaves
    double share = 1;                   ///< of the root's power that would arrive here
    float split = 0.f;                  ///< below: p[axis] < split
    std::uint32_t axis = 0;
    std::unique_ptr<VisibilityRegion> below, above;

    bool is_leaf() const { return !below; }
};

/// So many photons never lie in a region: all lights stay open.
inline constexpr std::uint32_t never_agreeing = ~0u;

/// Null if there are no photons. `photons` are sorted by light. The same for any number of
/// threads.
std::unique_ptr<VisibilityRegion> build_visibility_regions(std::vector<ShadowPhoton> photons, std::uint32_t agreeing);

}  // namespace gib
