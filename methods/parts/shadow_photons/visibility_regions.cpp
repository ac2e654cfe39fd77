#include "methods/parts/shadow_photons/visibility_regions.h"

#include "common/core/parallel.h"

#include <algorithm>
#include <iterator>
#include <span>

namespace gib {

namespace {

/// The shares of lights in the larger region count as much as this number of photons in a part of it.
constexpr double prior_photons = 8;
/// With fewer photons of a light than this, the visible share of the light is taken from the larger region.
constexpr std::uint32_t telling_photons = 8;
/// A region is split if it has twice this number of photons for each light that is not dark: its parts resolve better
/// how much each light adds.
constexpr std::size_t photons_per_light = 32;
/// Regions of at most this number of photons are built by one task.
constexpr std::size_t parallel_photons = 1 << 15;

/// Sums over the photons of one light in a region.
struct Counts {
    std::uint32_t photons = 0;
    double power = 0, seen = 0;
    bool all_direct = true, all_shadow = true;
};

/// Combines the photons of a light with the evidence from the larger region (null at the root). `part` is the share
/// of the larger region's unoccluded power that belongs to this region.
LightEvidence evidence(std::uint32_t light, const Counts& counts, const LightEvidence* larger, double part,
                       std::uint32_t agreeing) {
    LightEvidence e{light};
    const double n = counts.photons;
    e.photons = counts.photons;
    e.unoccluded =
        larger ? (n * counts.power + prior_photons * part * larger->unoccluded) / (n + prior_photons) : counts.power;
    if (larger && counts.photons < telling_photons) e.visible = larger->visible;
    else if (counts.power > 0) e.visible = (n * counts.seen / counts.power + 1) / (n + 2);
    if (larger && larger->verdict != LightVerdict::open) {
        e.verdict = larger->verdict;
    } else if (counts.photons >= agreeing) {
        if (counts.all_direct) e.verdict = LightVerdict::lit;
        else if (counts.all_shadow) e.verdict = LightVerdict::dark;
    }
    return e;
}

class RegionBuilder {
public:
    RegionBuilder(std::uint32_t agreeing) : agreeing_(agreeing) {}

    /// Builds the tree over `photons`, which are sorted by light. `scratch` has the same length; `larger`
    /// is null at the root.
    std::unique_ptr<VisibilityRegion> build(std::span<ShadowPhoton> photons, std::span<ShadowPhoton> scratch,
                                            const VisibilityRegion* larger) const {
        auto region = std::make_unique<VisibilityRegion>();
        weigh(photons, larger, *region);
        if (!is_worth_splitting(*region) || !choose_split(photons, *region)) return region;
        const auto is_below = [&](const ShadowPhoton& photon) { return photon.p[region->axis] < region->split; };
        const std::size_t below = stable_split(photons, scratch, is_below);
        if (below == 0 || below == photons.size()) return region;

        const auto build_below = [&] {
            region->below = build(photons.first(below), scratch.first(below), region.get());
        };
        const auto build_above = [&] {
            region->above = build(photons.subspan(below), scratch.subspan(below), region.get());
        };
        if (photons.size() > parallel_photons) {
            parallel_pair(build_below, build_above);
        } else {
            build_below();
            build_above();
        }
        region->lights = {};
        return region;
    }

private:
    /// Fills in the evidence about each light of the larger region or, at the root, about each
    /// light that has a photon.
    void weigh(std::span<const ShadowPhoton> photons, const VisibilityRegion* larger, VisibilityRegion& region) const {
        double power = 0, all = 0;
        for (const ShadowPhoton& photon : photons)
            power += static_cast<double>(photon.power);
        if (larger)
            for (const LightEvidence& light : larger->lights)
                all += light.unoccluded;
        const double part = all > 0 ? power / all : 0;
        region.share = larger ? larger->share * part : 1;

        auto photon = photons.begin();
        const auto counts_of = [&](std::uint32_t light) {
            Counts counts;
            for (; photon != photons.end() && photon->light == light; ++photon) {
                ++counts.photons;
                counts.power += static_cast<double>(photon->power);
                counts.seen += static_cast<double>(photon->power) * static_cast<double>(photon->visibility);
                counts.all_direct &= photon->visibility == 1.f;
                counts.all_shadow &= photon->visibility == 0.f;
            }
            return counts;
        };
        if (larger) {
            region.lights.reserve(larger->lights.size());
            for (const LightEvidence& light : larger->lights)
                region.lights.push_back(evidence(light.light, counts_of(light.light), &light, part, agreeing_));
        } else {
            while (photon != photons.end()) {
                const std::uint32_t light = photon->light;
                region.lights.push_back(evidence(light, counts_of(light), nullptr, 1, agreeing_));
            }
        }
    }

    /// A split pays if an open light may be settled in a part, or if the lights have photons enough to be resolved.
    bool is_worth_splitting(const VisibilityRegion& region) const {
        std::size_t lights = 0, photons = 0;
        for (const LightEvidence& light : region.lights) {
            if (light.verdict == LightVerdict::dark) continue;
            if (light.verdict == LightVerdict::open && light.photons / 2 >= agreeing_) return true;
            ++lights;
            photons += light.photons;
        }
        return lights > 0 && photons >= 2 * photons_per_light * lights;
    }

    /// Splits at the median of the photons along the longest axis of their box; false if all lie at one place.
    static bool choose_split(std::span<const ShadowPhoton> photons, VisibilityRegion& region) {
        Bounds bounds;
        for (const ShadowPhoton& photon : photons)
            bounds.add(photon.p);
        Eigen::Index axis = 0;
        const Vec3 extent = bounds.upper - bounds.lower;
        if (!(extent.maxCoeff(&axis) > 0.f)) return false;
        region.axis = static_cast<std::uint32_t>(axis);
        std::vector<float> coordinates(photons.size());
        std::transform(photons.begin(), photons.end(), coordinates.begin(),
                       [&](const ShadowPhoton& photon) { return photon.p[axis]; });
        const auto middle = coordinates.begin() + static_cast<std::ptrdiff_t>(coordinates.size() / 2);
        std::nth_element(coordinates.begin(), middle, coordinates.end());
        region.split = *middle;
        return true;
    }

    /// Moves the photons below the split before the others and returns their number. Both parts keep their order.
    template <typename IsBelow>
    static std::size_t stable_split(std::span<ShadowPhoton> photons, std::span<ShadowPhoton> scratch,
                                    const IsBelow& is_below) {
        std::size_t below = 0, above = 0;
        for (const ShadowPhoton& photon : photons)
            if (is_below(photon)) photons[below++] = photon;
            else scratch[above++] = photon;
        std::copy_n(scratch.begin(), above, photons.begin() + static_cast<std::ptrdiff_t>(below));
        return below;
    }

    std::uint32_t agreeing_;
};

}  // namespace

std::unique_ptr<VisibilityRegion> build_visibility_regions(std::vector<ShadowPhoton> photons, std::uint32_t agreeing) {
    if (photons.empty()) return nullptr;
    std::vector<ShadowPhoton> scratch(photons.size());
    return RegionBuilder(agreeing).build(photons, scratch, nullptr);
}

}  // namespace gib
