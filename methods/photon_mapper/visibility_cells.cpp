#include "methods/photon_mapper/visibility_cells.h"

#include "common/core/parallel.h"

#include <algorithm>
#include <iterator>
#include <span>

namespace gib {

namespace {

/// As many photons the larger cell's shares of lights are worth in a part of it.
constexpr double prior_photons = 8;
/// Fewer photons of a light do not tell what is seen of it better than those of the larger cell.
constexpr std::uint32_t telling_photons = 8;
/// A cell with this many photons for each light that is not dark is split to tell better what each adds.
constexpr std::size_t photons_per_light = 32;
/// Smaller cells are built by one task.
constexpr std::size_t parallel_photons = 1 << 15;

/// The photons of one light in a cell.
struct Counts {
    std::uint32_t photons = 0;
    double power = 0, seen = 0;
    bool all_direct = true, all_shadow = true;
};

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

class CellBuilder {
public:
    CellBuilder(std::uint32_t agreeing) : agreeing_(agreeing) {}

    /// `scratch` is as long as `photons`; `larger` is null at the root.
    std::unique_ptr<VisibilityCell> build(std::span<ShadowPhoton> photons, std::span<ShadowPhoton> scratch,
                                          const VisibilityCell* larger) const {
        auto cell = std::make_unique<VisibilityCell>();
        weigh(photons, larger, *cell);
        if (!is_worth_splitting(*cell) || !choose_split(photons, *cell)) return cell;
        const auto is_below = [&](const ShadowPhoton& photon) { return photon.p[cell->axis] < cell->split; };
        const std::size_t below = stable_split(photons, scratch, is_below);
        if (below == 0 || below == photons.size()) return cell;

        const auto build_below = [&] { cell->below = build(photons.first(below), scratch.first(below), cell.get()); };
        const auto build_above = [&] {
            cell->above = build(photons.subspan(below), scratch.subspan(below), cell.get());
        };
        if (photons.size() > parallel_photons) {
            parallel_pair(build_below, build_above);
        } else {
            build_below();
            build_above();
        }
        cell->lights = {};
        return cell;
    }

private:
    /// Evidence about the lights of the larger cell; at the root, about those of the photons.
    void weigh(std::span<const ShadowPhoton> photons, const VisibilityCell* larger, VisibilityCell& cell) const {
        double power = 0, all = 0;
        for (const ShadowPhoton& photon : photons)
            power += static_cast<double>(photon.power);
        if (larger)
            for (const LightEvidence& light : larger->lights)
                all += light.unoccluded;
        const double part = all > 0 ? power / all : 0;
        cell.share = larger ? larger->share * part : 1;

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
            cell.lights.reserve(larger->lights.size());
            for (const LightEvidence& light : larger->lights)
                cell.lights.push_back(evidence(light.light, counts_of(light.light), &light, part, agreeing_));
        } else {
            while (photon != photons.end()) {
                const std::uint32_t light = photon->light;
                cell.lights.push_back(evidence(light, counts_of(light), nullptr, 1, agreeing_));
            }
        }
    }

    bool is_worth_splitting(const VisibilityCell& cell) const {
        std::size_t lights = 0, photons = 0;
        for (const LightEvidence& light : cell.lights) {
            if (light.verdict == LightVerdict::dark) continue;
            if (light.verdict == LightVerdict::open && light.photons / 2 >= agreeing_) return true;
            ++lights;
            photons += light.photons;
        }
        return lights > 0 && photons >= 2 * photons_per_light * lights;
    }

    /// The median of the longest axis.
    static bool choose_split(std::span<const ShadowPhoton> photons, VisibilityCell& cell) {
        Bounds bounds;
        for (const ShadowPhoton& photon : photons)
            bounds.add(photon.p);
        Eigen::Index axis = 0;
        const Vec3 extent = bounds.upper - bounds.lower;
        if (!(extent.maxCoeff(&axis) > 0.f)) return false;
        cell.axis = static_cast<std::uint32_t>(axis);
        std::vector<float> coordinates(photons.size());
        std::transform(photons.begin(), photons.end(), coordinates.begin(),
                       [&](const ShadowPhoton& photon) { return photon.p[axis]; });
        const auto middle = coordinates.begin() + static_cast<std::ptrdiff_t>(coordinates.size() / 2);
        std::nth_element(coordinates.begin(), middle, coordinates.end());
        cell.split = *middle;
        return true;
    }

    /// Moves those below before the others, each in the order they have, and returns their number.
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

std::unique_ptr<VisibilityCell> build_visibility_cells(std::vector<ShadowPhoton> photons, std::uint32_t agreeing) {
    if (photons.empty()) return nullptr;
    std::vector<ShadowPhoton> scratch(photons.size());
    return CellBuilder(agreeing).build(photons, scratch, nullptr);
}

}  // namespace gib
