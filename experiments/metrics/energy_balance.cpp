#include "experiments/metrics/energy_balance.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace gib {

namespace {

constexpr double tail = 0.01;  // probability of both tails together: 99 % intervals
constexpr double least_balance_share =
    0.01;  // share of the total's energy: darker components are measured against this

SampleMean mean_energies(const std::vector<Image>& images) {
    std::vector<double> energies;
    for (const Image& image : images)
        energies.push_back(mean_energy(image));
    return sample_mean(energies);
}

/// The mean energy of the reference, with its variance from the scatter of the groups. Without groups, the errors of
/// pixels and channels are taken as independent; without a standard error the reference counts as exact.
SampleMean noisy_energy(const ReferenceLayer& reference) {
    if (reference.groups.size() > 1) return mean_energies(reference.groups);
    SampleMean mean{mean_energy(reference.mean), {0, std::numeric_limits<double>::infinity()}};
    if (!reference.standard_error) return mean;
    const auto size = static_cast<double>(reference.standard_error->rgb.size());
    for (const float v : reference.standard_error->rgb)
        mean.variance.variance += sqr(static_cast<double>(v) / size);
    return mean;
}

BalanceVerdict verdict_of(const Estimate& excess, double truth) {
    // The excess is NaN if the image has a value that is not finite.
    if (!std::isfinite(excess.value)) return BalanceVerdict::differs;
    // Both are exactly black. Most often this is a component that the scene does not have.
    if (excess.value == 0 && truth == 0) return BalanceVerdict::agrees;
    if (!excess.interval) return BalanceVerdict::inconclusive;
    const auto [lo, hi] = *excess.interval;
    if ((lo > 0 || hi < 0) && std::abs(excess.value) >= balance_least) return BalanceVerdict::differs;
    return lo >= -balance_tolerance && hi <= balance_tolerance ? BalanceVerdict::agrees : BalanceVerdict::inconclusive;
}

EnergyBalance compared(const SampleMean& method, const SampleMean& truth, double unit) {
    EnergyBalance balance{method, unit, {(method.value - truth.value) / unit, std::nullopt}};
    const double half = half_width({method.variance, truth.variance}, tail) / unit;
    if (std::isfinite(half))
        balance.excess.interval = Interval{balance.excess.value - half, balance.excess.value + half};
    balance.verdict = verdict_of(balance.excess, truth.value);
    return balance;
}

}  // namespace

double mean_energy(const Image& image) {
    return std::accumulate(image.rgb.begin(), image.rgb.end(), 0.0) / static_cast<double>(image.rgb.size());
}

SampleMean reference_energy(const ReferenceLayer& reference) {
    SampleMean mean = noisy_energy(reference);
    for (const ReferenceLayer& layer : reference.bias) {
        const SampleMean bias = noisy_energy(layer);
        const double squared_bias = sqr(bias.value) - bias.variance.variance;
        if (squared_bias > 0) mean.variance.variance += squared_bias;
    }
    return mean;
}

std::string name_of(BalanceVerdict verdict) {
    return verdict == BalanceVerdict::agrees    ? "agrees"
           : verdict == BalanceVerdict::differs ? "differs"
                                                : "inconclusive";
}

EnergyBalance EnergyBalance::against(const EnergyBalance& other) const { return compared(energy, other.energy, unit); }

Interval of_light(const Interval& excess, const EnergyBalance& balance) {
    return {std::max(excess.lo, balance.excess.value - std::max(balance.energy.value, 0.0) / balance.unit), excess.hi};
}

std::optional<EnergyBalance> energy_balance(const std::vector<Image>& replicates, const ReferenceLayer& reference,
                                            const Image& total) {
    const SampleMean truth = reference_energy(reference);
    const double unit = std::max(truth.value, least_balance_share * mean_energy(total));
    if (!(unit > 0)) return std::nullopt;
    EnergyBalance balance = compared(mean_energies(replicates), truth, unit);
    if (balance.excess.interval) balance.excess.interval = of_light(*balance.excess.interval, balance);
    return balance;
}

}  // namespace gib
