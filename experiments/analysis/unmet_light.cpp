#include "experiments/analysis/unmet_light.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>

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

double allow_for_unmet_light(TableRow& row, const std::vector<Image>& images, const Image& unmet,
                             const ReferenceLayer& reference, const Denominators& denominators) {
    if (!row.statistics || is_black(unmet)) return 0;
    std::vector<Image> met = images;
    for (Image& x : met)
        for (std::size_t i = 0; i < x.rgb.size(); ++i)
            x.rgb[i] += unmet.rgb[i];
    const double unmet_energy = mean_energy(unmet);
    for (std::size_t i = 0; i < unmet.rgb.size(); ++i)
        row.unmet += denominators.weight(i) * sqr(double{unmet.rgb[i]}) / static_cast<double>(unmet.rgb.size());
    const ReplicateStatistics with = replicate_statistics(met, reference, denominators);
    widen(row.statistics->bias2, with.bias2);
    widen(row.statistics->rel_bias2, with.rel_bias2);
    const auto footing = equal_footing(met, reference, denominators.plain());
    if (!row.footing || !footing) return unmet_energy;
    Footing& plain = *row.footing;
    const double least = std::min(std::abs(plain.excess.value), std::abs(footing->excess.value));
    widen(plain.excess, footing->excess);
    const bool is_less = plain.verdict == FootingVerdict::differs && least * plain.unit < unmet_energy;
    if (footing->verdict == plain.verdict && !is_less) return unmet_energy;
    plain.verdict = FootingVerdict::unresolved;
    plain.misses_light = true;
    return unmet_energy;
}

}  // namespace gib
