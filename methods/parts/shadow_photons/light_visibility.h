#pragma once
// The visibility map: shadow photons say which lights are seen around a point, and one of these is sampled.
//
// Choice of a light. It is mixed with the choice P_scene of the light tree, so that every light that shines has a chance:
//     P(l) = (1 - rest) w_l / sum of w + rest P_scene(l),
// where w_l is the irradiance that the light is expected to add in the region around the point (LightEvidence::expected). `rest`
// is at least 5 %. It is larger where lights have no photon on the surface: it is at least the share that these lights
// would have with half a photon each.
//
// Estimate. One sample of direct light is f Le V cos(theta) / (P(l) pdf_w), with the light's own density pdf_w and the visibility
// V, which a ray finds. It is unbiased whatever the photons say, as P(l) > 0 for every light that shines.
//
// Surfaces are distinguished by shape and by the coordinate axis that is nearest to their normal. Surfaces with fewer
// than 8 photons for each light share one tree, in which all lights stay open.

#include "common/sampling/sampler.h"
#include "methods/parts/shadow_photons/visibility_regions.h"
#include "methods/parts/transport/ray_queries.h"

#include <unordered_map>

namespace gib {

class LightVisibility {
public:
    /// A light that was chosen, with the probability of the choice.
    struct Choice {
        std::uint32_t light;
        float probability;
    };

    /// `photons` must come from trace_shadow_photons(), sorted by light. The scene must outlive this.
    LightVisibility(const Scene& scene, const std::vector<ShadowPhoton>& photons);

    /// The probability with which choose() returns the light.
    float probability(const SurfaceHit& hit, const Vec3& wo, std::uint32_t light) const;
    /// Chooses a light by u in [0, 1). Empty if none of the lights can reach the point.
    std::optional<Choice> choose(const SurfaceHit& hit, const Vec3& wo, float u) const;

    /// One sample of the radiance [W/(sr m^2)] that the diffuse lobes at `hit` scatter towards wo straight from a
    /// light, as gib::sample_direct_light estimates it by light sampling only. Not for materials that transmit light,
    /// as the photons of one side say nothing about light from the other side.
    Color sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) const;

private:
    void prepare_choice(VisibilityRegion& region, double power_per_photon) const;
    const VisibilityRegion* region_at(const SurfaceHit& hit, const Vec3& wo) const;
    float probability_in(const VisibilityRegion* region, const LitPoint& at, std::uint32_t light) const;

    const Scene& scene_;
    std::unordered_map<std::uint64_t, std::unique_ptr<VisibilityRegion>> surfaces_;  ///< by SurfaceSide::key()
    std::array<std::unique_ptr<VisibilityRegion>, side_count> small_surfaces_;       ///< by side; null: no photon
};

}  // namespace gib
