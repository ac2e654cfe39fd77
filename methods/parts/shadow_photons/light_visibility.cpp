#include "methods/parts/shadow_photons/light_visibility.h"

#include "common/core/parallel.h"
#include "methods/parts/density/surface_disc.h"
#include "methods/parts/transport/direct_light.h"

#include <algorithm>

namespace gib {

namespace {

/// Least probability `rest` of a choice among all lights.
constexpr double least_rest = 0.05;
/// A light with a smaller probability than this in a region is left to the choice among all lights, as random numbers
/// of 24 bits resolve smaller probabilities too coarsely.
constexpr double least_probability = 0x1p-16;

/// Surfaces with fewer photons than this for each light share one group for each side; all lights stay open there.
constexpr std::size_t own_photons_per_light = 8;

/// The shadow photons of one surface or, in the first groups, of all small surfaces of one side.
struct SurfacePhotons {
    std::uint64_t surface = 0;
    std::vector<ShadowPhoton> photons;
};

/// Groups the photons by surface. The first side_count groups hold the photons of small surfaces, by side; then
/// follows one group for each other surface, in the order of its first photon. Within a group
/// the photons keep their order.
std::vector<SurfacePhotons> by_surface(const std::vector<ShadowPhoton>& photons, std::size_t lights) {
    std::unordered_map<std::uint64_t, std::uint32_t> group_of;
    std::vector<std::size_t> counts;
    for (const ShadowPhoton& photon : photons) {
        const auto [group, is_new] = group_of.emplace(photon.surface, static_cast<std::uint32_t>(counts.size()));
        if (is_new) counts.push_back(0);
        ++counts[group->second];
    }
    std::vector<SurfacePhotons> surfaces(side_count);
    std::vector<std::uint32_t> place(counts.size(), 0);
    for (const ShadowPhoton& photon : photons) {
        const std::uint32_t group = group_of.at(photon.surface);
        if (counts[group] < own_photons_per_light * lights) {
            surfaces[SurfaceSide::side_of_key(photon.surface)].photons.push_back(photon);
            continue;
        }
        if (place[group] == 0) {
            place[group] = static_cast<std::uint32_t>(surfaces.size());
            surfaces.push_back({photon.surface, {}});
            surfaces.back().photons.reserve(counts[group]);
        }
        surfaces[place[group]].photons.push_back(photon);
    }
    return surfaces;
}

}  // namespace

LightVisibility::LightVisibility(const Scene& scene, const std::vector<ShadowPhoton>& photons,
                                 const ShadowPhotonSettings& settings)
    : scene_(scene), skips_(settings.use == Shadows::skip), words_((scene.lights().size() + 63) / 64) {
    std::vector<SurfacePhotons> surfaces = by_surface(photons, scene.lights().size());
    std::vector<std::unique_ptr<VisibilityRegion>> regions(surfaces.size());
    std::vector<double> power_per_photon(surfaces.size());
    parallel_blocks(surfaces.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
        for (const ShadowPhoton& photon : surfaces[i].photons)
            power_per_photon[i] += static_cast<double>(photon.power) / static_cast<double>(surfaces[i].photons.size());
        // Small surfaces of one group may see different lights, so no verdict holds for all of them.
        const std::uint32_t agreeing = i < side_count ? never_agreeing : settings.agreeing;
        regions[i] = build_visibility_regions(std::move(surfaces[i].photons), agreeing);
    });
    shared_roots_.fill(no_root);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (!regions[i]) continue;
        const auto root = static_cast<std::uint32_t>(nodes_.size());
        if (i < side_count) shared_roots_[i] = root;
        else roots_.emplace(surfaces[i].surface, root);
        nodes_.emplace_back();
        append(*regions[i], root, power_per_photon[i]);
        regions[i].reset();
    }
}

/// Copies the tree below `from` to node `to`.
void LightVisibility::append(const VisibilityRegion& from, std::uint32_t to, double power_per_photon) {
    if (from.is_leaf()) {
        nodes_[to] = {0.f, leaf, static_cast<std::uint32_t>(regions_.size())};
        regions_.push_back(append_lights(from, power_per_photon));
        return;
    }
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[to] = {from.split, from.axis, child};
    append(*from.below, child, power_per_photon);
    append(*from.above, child + 1, power_per_photon);
}

/// Makes the list of lights of a leaf, with the probabilities of choosing them.
LightVisibility::Region LightVisibility::append_lights(const VisibilityRegion& from, double power_per_photon) {
    dark_.resize(dark_.size() + words_);
    std::uint64_t* const dark = dark_.data() + regions_.size() * words_;
    // With `skip` a dark light is taken to add nothing, so it is not listed.
    const auto is_listed = [&](const LightEvidence& light) { return !skips_ || light.verdict != LightVerdict::dark; };
    double expected = 0;
    for (const LightEvidence& light : from.lights) {
        if (light.verdict == LightVerdict::dark) dark[light.light / 64] |= std::uint64_t{1} << (light.light % 64);
        if (is_listed(light)) expected += light.expected();
    }
    const auto is_chosen = [&](const LightEvidence& light) {
        return light.expected() > 0 && light.expected() >= least_probability * expected;
    };
    double chosen = 0;
    for (const LightEvidence& light : from.lights)
        if (is_listed(light) && is_chosen(light)) chosen += light.expected();

    Region region{static_cast<std::uint32_t>(entries_.size()), 0, 1.f};
    const std::size_t unknown_lights = scene_.lights().size() - from.lights.size();
    double begin = 0;
    for (const LightEvidence& light : from.lights) {
        if (!is_listed(light)) continue;
        Entry entry{
            .light = light.light, .verdict = light.verdict, .begin = static_cast<float>(begin), .probability = 0.f};
        if (is_chosen(light)) {
            begin = std::min(1.0, begin + light.expected() / chosen);
            entry.probability = static_cast<float>(begin) - entry.begin;
        }
        entries_.push_back(entry);
        ++region.count;
    }
    if (skips_ || !(chosen > 0)) return region;
    // A light without a photon on the whole surface is expected to add as much as half a photon would.
    const double unknown = 0.5 * power_per_photon * static_cast<double>(unknown_lights) * from.share;
    region.rest = static_cast<float>(std::max(least_rest, unknown / (expected + unknown)));
    return region;
}

/// The region at `hit` on the side of wo; no_region if no photon lies on that surface.
std::uint32_t LightVisibility::region_at(const SurfaceHit& hit, const Vec3& wo) const {
    const SurfaceSide surface(hit, wo);
    const auto own = roots_.find(surface.key());
    std::uint32_t node = own != roots_.end() ? own->second : shared_roots_[surface.side];
    if (node == no_root) return no_region;
    while (nodes_[node].axis != leaf) {
        const Node& at = nodes_[node];
        node = at.child + (hit.p[at.axis] < at.split ? 0 : 1);
    }
    return nodes_[node].child;
}

/// The light's entry in the region; null if it is not listed.
const LightVisibility::Entry* LightVisibility::entry_of(const Region& region, std::uint32_t light) const {
    const Entry* const begin = entries_.data() + region.first;
    const Entry* const end = begin + region.count;
    const Entry* const found =
        std::lower_bound(begin, end, light, [](const Entry& entry, std::uint32_t l) { return entry.light < l; });
    return found != end && found->light == light ? found : nullptr;
}

LightVerdict LightVisibility::verdict_in(std::uint32_t region, std::uint32_t light) const {
    if (region == no_region) return LightVerdict::open;
    if (is_dark(region, light)) return LightVerdict::dark;
    const Entry* const entry = entry_of(regions_[region], light);
    return entry ? entry->verdict : LightVerdict::open;
}

float LightVisibility::probability_in(std::uint32_t region, const LitPoint& at, std::uint32_t light) const {
    const float by_scene = scene_.light_tree().probability(at, light);
    if (region == no_region || skips_) return by_scene;
    const Entry* const entry = entry_of(regions_[region], light);
    const float rest = regions_[region].rest;
    return rest * by_scene + (entry ? (1.f - rest) * entry->probability : 0.f);
}

LightVerdict LightVisibility::verdict(const SurfaceHit& hit, const Vec3& wo, std::uint32_t light) const {
    return verdict_in(region_at(hit, wo), light);
}

float LightVisibility::probability(const SurfaceHit& hit, const Vec3& wo, std::uint32_t light) const {
    return probability_in(region_at(hit, wo), hit.lit_for(wo), light);
}

std::optional<LightVisibility::Choice> LightVisibility::choose(const SurfaceHit& hit, const Vec3& wo, float u) const {
    const std::uint32_t at = region_at(hit, wo);
    const LitPoint lit = hit.lit_for(wo);
    const float by_region = at == no_region || skips_ ? 0.f : 1.f - regions_[at].rest;
    if (u < by_region) {
        const Region& region = regions_[at];
        const Entry* const first = entries_.data() + region.first;
        const float v = u / by_region;
        const Entry* found = std::upper_bound(first, first + region.count, v,
                                              [](float x, const Entry& entry) { return x < entry.begin; }) -
                             1;
        // Rounding may lead past the last interval, to entries of probability 0.
        while (found->probability == 0.f)
            --found;
        return Choice{found->light, probability_in(at, lit, found->light), found->verdict};
    }
    const float v = std::min((u - by_region) / (1.f - by_region), 1.f - unit_roundoff);
    const auto choice = scene_.light_tree().choose(lit, v);
    if (!choice) return std::nullopt;
    return Choice{choice->light, probability_in(at, lit, choice->light), verdict_in(at, choice->light)};
}

Color LightVisibility::sample_direct_light(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo,
                                           const VertexNumbers& u) const {
    const auto choice = choose(hit, wo, u.light_choice());
    if (!choice || (skips_ && choice->verdict == LightVerdict::dark)) return Color::Zero();
    auto light = sample_light(scene_.lights()[choice->light], scene_.shapes(), hit.p, u.light_position());
    if (!light) return Color::Zero();
    light->pdf_w *= choice->probability;
    // An interpolated normal may let in light from behind the surface. The photons of this side say nothing about
    // that light, so a ray tests it.
    const bool is_lit = skips_ && choice->verdict == LightVerdict::lit && light->wi.dot(normal_towards(hit, wo)) > 0.f;
    const auto visibility = is_lit ? ShadowRay::skipped : ShadowRay::traced;
    return direct_light_of(rays, hit, hit.shading.to_local(wo), *light, visibility, Lobes::diffuse).diffuse;
}

}  // namespace gib
