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

/// Widens the interval. The verdict becomes inconclusive if both differ, or if `in_doubt`.
void widen(Footing& footing, const Footing& other, bool in_doubt) {
    widen(footing.excess, other.excess);
    if (footing.verdict == other.verdict && !in_doubt) return;
    footing.verdict = FootingVerdict::inconclusive;
    footing.misses_light = true;
}

/// The images plus `factor` times the light.
std::vector<Image> changed(std::vector<Image> images, const Image& light, float factor) {
    for (Image& x : images)
        for (std::size_t i = 0; i < x.rgb.size(); ++i)
            x.rgb[i] += factor * light.rgb[i];
    return images;
}

/// The mean over values of light^2 / (r^2 + epsilon).
double relative_square(const Image& light, const Denominators& denominators) {
    double sum = 0;
    for (std::size_t i = 0; i < light.rgb.size(); ++i)
        sum += denominators.weight(i) * sqr(double{light.rgb[i]});
    return sum / static_cast<double>(light.rgb.size());
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
    const std::vector<Image> met = changed(images, unmet, 1);
    const double unmet_energy = mean_energy(unmet);
    row.unmet = relative_square(unmet, denominators);
    const ReplicateStatistics with = replicate_statistics(met, reference, denominators);
    widen(row.statistics->bias2, with.bias2);
    widen(row.statistics->rel_bias2, with.rel_bias2);
    const auto footing = equal_footing(met, reference, denominators.plain());
    if (!row.footing || !footing) return unmet_energy;
    const double least = std::min(std::abs(row.footing->excess.value), std::abs(footing->excess.value));
    const bool is_within_unmet = row.has_verdict(FootingVerdict::differs) && least * row.footing->unit < unmet_energy;
    widen(*row.footing, *footing, is_within_unmet);
    return unmet_energy;
}

void allow_for_missed_light(TableRow& row, const std::vector<Image>& images, const Image& missed,
                            const ReferenceLayer& reference, const Denominators& denominators) {
    if (!row.statistics || is_black(missed)) return;
    // An image differs from the reference with this light as the image without it differs from the reference.
    const std::vector<Image> others = changed(images, missed, -1);
    const ReplicateStatistics with = replicate_statistics(others, reference, denominators);
    ReplicateStatistics& plain = *row.statistics;
    row.noise_floor += relative_square(missed, denominators);
    if (plain.rel_mse_corrected > row.noise_floor)
        plain.missed_shift = std::log(std::max(with.rel_mse_corrected, row.noise_floor) / plain.rel_mse_corrected);
    for (const auto estimate : {&ReplicateStatistics::mse, &ReplicateStatistics::rmse, &ReplicateStatistics::rel_mse})
        widen(plain.*estimate, with.*estimate);
    widen(plain.bias2, with.bias2);
    widen(plain.rel_bias2, with.rel_bias2);
    if (const auto footing = equal_footing(others, reference, denominators.plain()); row.footing && footing)
        widen(*row.footing, *footing, false);
}

}  // namespace gib
