#pragma once
// What shadow photons say about the lights at a point, and direct light sampled by it.
//
// At a point a light is `lit` if the photons of the largest region around it in which they agree (visibility_regions.h),
// at least `agreeing` of them, have all come straight from it; `dark` if all are shadow photons; else `open`, as
// close to the edges of its shadows.
//
// The choice of a light is mixed with light_choice(), so that every light that shines has a chance:
//     P(l) = (1 - rest) w_l / sum of w + rest P_scene(l),
// w_l what the light is expected to add to the irradiance of the region (LightEvidence::expected). `rest` is at least
// 5 %, and as much as lights of which the surface has no photon would have if half a photon of each lay there.
//
// One sample of direct light is f Le V cos(theta) / (P(l) pdf_w), with the light's own density pdf_w.
//  - guide: V is found by a ray. Unbiased whatever the photons say, as P(l) > 0 for every light that shines.
//  - skip, both: V is 1 for a lit light and 0 for a dark one. Biased: if a share v of a light is seen from a region, its
//    n photons all say `lit` with probability v^n and `dark` with (1 - v)^n, were they independent; then (1 - v) E is
//    reflected too much, or v E too little. The mean of either is below E / (e n). More photons shrink the regions where
//    that happens, to the edges of shadows; more `agreeing` ones make it rarer.
//  - skip: P(l) = P_scene(l). both: w is 0 for a dark light, and `rest` at least 1 %, or 0 where every light has
//  photons.
//
// Surfaces are told apart by shape and by the axis next to their normal; those with fewer than 8 photons for each
// light are looked at together, and nothing is settled there.

#include "common/sampling/sampler.h"
#include "methods/parts/transport/ray_queries.h"
#include "methods/photon_mapper/visibility_regions.h"

#include <unordered_map>

namespace gib {

class LightVisibility {
public:
    struct Choice {
        std::uint32_t light;
        float probability;
        LightVerdict verdict;
    };

    /// `photons` as trace_shadow_photons() returns them. The scene must outlive this.
    LightVisibility(const Scene& scene, const std::vector<ShadowPhoton>& photons, const ShadowPhotonSettings& settings);

    std::size_t regions() const { return regions_.size(); }
    /// What the map keeps [bytes].
    std::size_t memory() const;

    /// On the side of `hit` from which wo looks at it.
    LightVerdict verdict(const SurfaceHit& hit, const Vec3& wo, std::uint32_t light) const;
    /// The probability with which choose() returns the light.
    float probability(const SurfaceHit& hit, const Vec3& wo, std::uint32_t light) const;
    /// Of a light by u in [0, 1). One that is dark may be returned.
    Choice choose(const SurfaceHit& hit, const Vec3& wo, float u) const;

    /// One sample of the radiance [W/(sr m^2)] that the diffuse lobes at `hit` scatter towards wo straight from a
    /// light, like gib::sample_direct_light by light sampling only. Not for materials that light passes through:
    /// nothing is known of what arrives from behind.
    Color sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) const;

private:
    /// A light that may be chosen.
    struct Entry {
        std::uint32_t light;
        LightVerdict verdict;
        float begin;  ///< of its interval of [0, 1) in the region's choice
        float probability;
    };
    struct Region {
        std::uint32_t first = 0, count = 0;  ///< entries
        float rest = 1.f;                    ///< probability of a choice among all lights
    };
    struct Node {
        float split;
        std::uint32_t axis;   ///< 3: a leaf
        std::uint32_t child;  ///< the lower one, the other behind it; of a leaf the number of its region
    };
    static constexpr std::uint32_t leaf = 3, no_region = ~0u, no_root = ~0u;

    void append(const VisibilityRegion& from, std::uint32_t to, double power_per_photon);
    Region append_lights(const VisibilityRegion& from, double power_per_photon);

    std::uint32_t region_at(const SurfaceHit& hit, const Vec3& wo) const;
    bool is_dark(std::uint32_t region, std::uint32_t light) const {
        return (dark_[region * words_ + light / 64] >> (light % 64) & 1) != 0;
    }
    const Entry* entry_of(const Region& region, std::uint32_t light) const;
    LightVerdict verdict_in(std::uint32_t region, std::uint32_t light) const;
    float probability_in(std::uint32_t region, std::uint32_t light) const;

    const Scene& scene_;
    DiscreteDistribution choice_;  ///< that of Scene::sample_light
    bool skips_, guides_;
    std::unordered_map<std::uint64_t, std::uint32_t> roots_;  ///< nodes, by surface
    std::array<std::uint32_t, side_count> shared_roots_;      ///< of all other surfaces, by side; or no_root
    std::vector<Node> nodes_;
    std::vector<Region> regions_;
    std::vector<Entry> entries_;       ///< region after region, by light
    std::size_t words_;                ///< of 64 lights
    std::vector<std::uint64_t> dark_;  ///< words_ of each region
};

}  // namespace gib
