#include "experiments/analysis/unmet_light.h"

#include <algorithm>

namespace gib {

namespace {

void widen(Estimate& estimate, const Estimate& other) {
    if (!estimate.interval || !other.interval) return;
    estimate.interval = Interval{std::min(estimate.interval->lo, other.interval->lo),
                                 std::max(estimate.interval->hi, other.interval->hi)};
}

void widen(std::optional<Estimate>& estimate, const std::optional<Estimate>& other) {
    if (estimate && other) widen(*estimate, *other);
}

}  // namespace

Image unmet_light(const std::vector<Image>& images, const Image& reference) {
    Image unmet(reference.width, reference.height);
    for (std::size_t i = 0; i < reference.rgb.size(); ++i)
        if (std::all_of(images.begin(), images.end(), [i](const Image& x) { return x.rgb[i] == 0.f; }))
            unmet.rgb[i] = std::max(reference.rgb[i], 0.f);
    return unmet;
}

void allow_for_unmet_light(TableRow& row, const std::vector<Image>& images, const Image& unmet,
                           const ReferenceLayer& reference, const Denominators& denominators) {
    if (!row.statistics || is_black(unmet)) return;
    std::vector<Image> met = images;
    for (Image& x : met)
        for (std::size_t i = 0; i < x.rgb.size(); ++i)
            x.rgb[i] += unmet.rgb[i];
    const ReplicateStatistics with = replicate_statistics(met, reference, denominators);
    widen(row.statistics->bias2, with.bias2);
    widen(row.statistics->rel_bias2, with.rel_bias2);
    const auto footing = equal_footing(met, reference, denominators.plain());
    if (!row.footing || !footing) return;
    widen(row.footing->excess, footing->excess);
    if (footing->verdict == row.footing->verdict) return;
    row.footing->verdict = FootingVerdict::unresolved;
    row.footing->misses_light = true;
}

}  // namespace gib
