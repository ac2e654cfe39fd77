#include "experiments/analysis/unsampled_light.h"

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
void widen(EnergyBalance& balance, const EnergyBalance& other, bool in_doubt) {
    widen(balance.excess, other.excess);
    if (balance.verdict == other.verdict && !in_doubt) return;
    balance.verdict = BalanceVerdict::inconclusive;
    balance.misses_light = true;
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

Image unsampled_light(const std::vector<Image>& images, const Image& reference) {
    Image unsampled(reference.width, reference.height);
    for (std::size_t i = 0; i < reference.rgb.size(); ++i)
        if (std::all_of(images.begin(), images.end(), [i](const Image& x) { return x.rgb[i] == 0.f; }))
            unsampled.rgb[i] = std::max(reference.rgb[i], 0.f);
    return unsampled;
}

double allow_for_unsampled_light(TableRow& row, const std::vector<Image>& images, const Image& unsampled,
                                 const ReferenceLayer& reference, const Denominators& denominators) {
    if (!row.statistics || is_black(unsampled)) return 0;
    const std::vector<Image> met = changed(images, unsampled, 1);
    const double unsampled_energy = mean_energy(unsampled);
    row.unsampled = relative_square(unsampled, denominators);
    const ReplicateStatistics with = replicate_statistics(met, reference, denominators);
    widen(row.statistics->bias2, with.bias2);
    widen(row.statistics->rel_bias2, with.rel_bias2);
    const auto balance = energy_balance(met, reference, denominators.plain());
    if (!row.balance || !balance) return unsampled_energy;
    const double least = std::min(std::abs(row.balance->excess.value), std::abs(balance->excess.value));
    const bool is_within_unsampled =
        row.has_verdict(BalanceVerdict::differs) && least * row.balance->unit < unsampled_energy;
    widen(*row.balance, *balance, is_within_unsampled);
    return unsampled_energy;
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
    if (const auto balance = energy_balance(others, reference, denominators.plain()); row.balance && balance)
        widen(*row.balance, *balance, false);
}

}  // namespace gib
