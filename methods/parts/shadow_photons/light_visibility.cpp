#include "methods/parts/shadow_photons/light_visibility.h"

#include "common/core/parallel.h"
#include "methods/parts/transport/direct_light.h"

#include <algorithm>

namespace gib {

namespace {

/// Least probability `rest` of a choice among all lights.
constexpr double least_rest = 0.05;
/// A light with a smaller probability than this in a region is left to the choice among all lights, as random numbers
/// of 24 bits resolve smaller probabilities too coarsely.
constexpr double least_probability = 0x1p-16;

/// Surfaces with fewer photons than this for each light share one tree for each side; all lights stay open there.
constexpr std::size_t own_photons_per_light = 8;

/// The photons from which the tree of a surface, or of all small surfaces of one side, is built.
struct Surface {
    std::vector<ShadowPhoton> photons;
    std::uint32_t agreeing;
    std::unique_ptr<VisibilityRegion>& root;
};

/// The evidence about a light that the photons of a region hold; null if the light has no photons there.
const LightEvidence* evidence_in(const VisibilityRegion* region, std::uint32_t light) {
    if (!region) return nullptr;
    const auto found = std::lower_bound(region->lights.begin(), region->lights.end(), light,
                                        [](const LightEvidence& e, std::uint32_t l) { return e.light < l; });
    return found != region->lights.end() && found->light == light ? &*found : nullptr;
}

}  // namespace

LightVisibility::LightVisibility(const Scene& scene, const std::vector<ShadowPhoton>& photons) : scene_(scene) {
    std::unordered_map<std::uint64_t, std::vector<ShadowPhoton>> by_surface;
    for (const ShadowPhoton& photon : photons)
        by_surface[photon.surface].push_back(photon);
    const auto is_small = [&](const auto& surface) {
        return surface.second.size() < own_photons_per_light * scene.lights().size();
    };
    std::array<std::vector<ShadowPhoton>, side_count> of_small;
    for (const ShadowPhoton& photon : photons)
        if (is_small(*by_surface.find(photon.surface)))
            of_small[SurfaceSide::side_of_key(photon.surface)].push_back(photon);
    std::vector<Surface> surfaces;
    // Small surfaces of one side may see different lights, so no verdict holds for all of them.
    for (std::size_t side = 0; side < side_count; ++side)
        surfaces.push_back({std::move(of_small[side]), never_agreeing, small_surfaces_[side]});
    for (auto& surface : by_surface)
        if (!is_small(surface))
            surfaces.push_back({std::move(surface.second), agreeing_photons, surfaces_[surface.first]});
    parallel_blocks(surfaces.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
        Surface& surface = surfaces[i];
        double power_per_photon = 0;
        for (const ShadowPhoton& photon : surface.photons)
            power_per_photon += static_cast<double>(photon.power) / static_cast<double>(surface.photons.size());
        surface.root = build_visibility_regions(std::move(surface.photons), surface.agreeing);
        if (surface.root) prepare_choice(*surface.root, power_per_photon);
    });
}

/// Gives the lights of the leaves their intervals in the choice of a light.
void LightVisibility::prepare_choice(VisibilityRegion& region, double power_per_photon) const {
    if (!region.is_leaf()) {
        prepare_choice(*region.below, power_per_photon);
        prepare_choice(*region.above, power_per_photon);
        return;
    }
    double expected = 0, chosen = 0;
    for (const LightEvidence& light : region.lights)
        expected += light.expected();
    const auto is_chosen = [&](const LightEvidence& light) {
        return light.expected() > 0 && light.expected() >= least_probability * expected;
    };
    for (const LightEvidence& light : region.lights)
        if (is_chosen(light)) chosen += light.expected();
    if (!(chosen > 0)) return;
    double begin = 0;
    for (LightEvidence& light : region.lights) {
        light.begin = static_cast<float>(begin);
        if (!is_chosen(light)) continue;
        begin = std::min(1.0, begin + light.expected() / chosen);
        light.probability = static_cast<float>(begin) - light.begin;
    }
    // A light without a photon on the whole surface is expected to add as much as half a photon would.
    const auto unknown_lights = static_cast<double>(scene_.lights().size() - region.lights.size());
    const double unknown = 0.5 * power_per_photon * unknown_lights * region.share;
    region.rest = static_cast<float>(std::max(least_rest, unknown / (expected + unknown)));
}

/// The region at `hit` on the side of wo; null if no photon lies on that surface.
const VisibilityRegion* LightVisibility::region_at(const SurfaceHit& hit, const Vec3& wo) const {
    const SurfaceSide surface(hit, wo);
    const auto own = surfaces_.find(surface.key());
    const VisibilityRegion* at = own != surfaces_.end() ? own->second.get() : small_surfaces_[surface.side].get();
    while (at && !at->is_leaf())
        at = (hit.p[at->axis] < at->split ? at->below : at->above).get();
    return at;
}

float LightVisibility::probability_in(const VisibilityRegion* region, const LitPoint& at, std::uint32_t light) const {
    const float by_scene = scene_.light_tree().probability(at, light);
    if (!region) return by_scene;
    const LightEvidence* const evidence = evidence_in(region, light);
    return region->rest * by_scene + (evidence ? (1.f - region->rest) * evidence->probability : 0.f);
}

float LightVisibility::probability(const SurfaceHit& hit, const Vec3& wo, std::uint32_t light) const {
    return probability_in(region_at(hit, wo), hit.lit_for(wo), light);
}

std::optional<LightVisibility::Choice> LightVisibility::choose(const SurfaceHit& hit, const Vec3& wo, float u) const {
    const VisibilityRegion* const region = region_at(hit, wo);
    const LitPoint lit = hit.lit_for(wo);
    const float by_region = region ? 1.f - region->rest : 0.f;
    if (u < by_region) {
        auto found = std::upper_bound(region->lights.begin(), region->lights.end(), u / by_region,
                                      [](float x, const LightEvidence& light) { return x < light.begin; }) -
                     1;
        // Rounding may lead past the last interval, to lights of probability 0.
        while (found->probability == 0.f)
            --found;
        return Choice{found->light, probability_in(region, lit, found->light)};
    }
    const float v = std::min((u - by_region) / (1.f - by_region), 1.f - unit_roundoff);
    const auto choice = scene_.light_tree().choose(lit, v);
    if (!choice) return std::nullopt;
    return Choice{choice->light, probability_in(region, lit, choice->light)};
}

Color LightVisibility::sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo,
                                           const VertexNumbers& u) const {
    const auto choice = choose(hit, wo, u.light_choice());
    if (!choice) return Color::Zero();
    auto light = sample_light(scene_.lights()[choice->light], scene_.shapes(), hit.p, u.light_position());
    if (!light) return Color::Zero();
    light->pdf_w *= choice->probability;
    return direct_light_of(rays, hit, hit.shading.to_local(wo), *light, Lobes::diffuse).diffuse;
}

}  // namespace gib
