#pragma once
// The energy balance: whether the images of a method hold as much light as the reference. A method that lacks, doubles
// or scales a class of light paths changes the mean energy of its image; noise and blur do not.

#include "experiments/metrics/statistics.h"
#include "experiments/metrics/student_t.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

enum class BalanceVerdict {
    agrees,        ///< the whole interval lies within balance_tolerance
    differs,       ///< the interval excludes zero, and the difference is at least balance_least
    inconclusive,  ///< too noisy, or too few seeds
};

std::string name_of(BalanceVerdict verdict);

/// The mean over the pixels and channels of an image [W/(sr m^2)].
double mean_energy(const Image& image);
/// The mean energy of a reference. Its variance comes from the scatter of the groups, and holds the square of its bias.
/// Without groups, the errors of pixels and channels are taken as independent; without a standard error the reference
/// counts as exact.
SampleMean reference_energy(const ReferenceLayer& reference);

inline constexpr double balance_tolerance = 0.01;  ///< share of the mean energy that may differ
/// Share of the mean energy, half the tolerance. A smaller difference is not worth a warning, even if it is certain.
inline constexpr double balance_least = 0.005;

/// The mean energy of one component of one method against the reference's.
struct EnergyBalance {
    /// Mean over the pixels and channels of the method's images [W/(sr m^2)]. One image gives no variance.
    SampleMean energy;
    double unit = 0;  ///< energy that differences are divided by [W/(sr m^2)]
    /// (mean of the method - mean of the reference) / unit, over pixels and channels. The unit is the reference's
    /// mean of this component, or a hundredth of its mean of the total image if that is more. With two seeds or more
    /// there is a 99 % interval, over the seeds and the reference's groups (half_width()).
    Estimate excess;
    BalanceVerdict verdict = BalanceVerdict::inconclusive;
    bool misses_light = false;  ///< unsampled light decides its verdict (analysis/unsampled_light.h)

    /// Compares two methods of one scene with each other, where the reference is too noisy. The excess
    /// is (energy - other.energy) / unit.
    EnergyBalance against(const EnergyBalance& other) const;
};

/// The interval of a method's excess, cut at the excess of a black image. A negative mean, as filters with negative
/// lobes leave it, stays inside.
Interval of_light(const Interval& excess, const EnergyBalance& balance);

/// Compares `replicates`, images of one component from independent seeds, with the same component `reference`;
/// `total` is the reference's total image. A 99 % interval misses the truth in one of a hundred comparisons. A method
/// whose energy is wrong by the tolerance or more passes as agreeing with a probability below 0.5 %. Empty if the
/// reference is black.
std::optional<EnergyBalance> energy_balance(const std::vector<Image>& replicates, const ReferenceLayer& reference,
                                            const Image& total);

}  // namespace gib
