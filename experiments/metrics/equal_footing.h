#pragma once
// Do two methods stand on an equal footing: is there as much light in their images? A method that lacks or doubles a
// class of light paths, or scales one, has another mean energy; noise and blur have not.

#include "experiments/metrics/statistics.h"
#include "experiments/metrics/student_t.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

enum class FootingVerdict {
    agrees,      ///< the whole interval lies within footing_tolerance
    differs,     ///< the interval leaves out zero, and the difference is at least footing_least
    unresolved,  ///< too noisy, or too few seeds, to tell
};

std::string name_of(FootingVerdict verdict);

inline constexpr double footing_tolerance = 0.01;  ///< of the mean energy
/// Differences that are certain but smaller are not worth a warning: half the tolerance.
inline constexpr double footing_least = 0.005;

/// The mean energy of one component of one method against the reference's.
struct Footing {
    SampleMean energy;  ///< the method's, over pixels and channels [radiance]; its variance is unknown from one image
    double unit = 0;    ///< what differences are relative to
    /// (mean of the method - mean of the reference) over pixels and channels, relative to the reference's mean of this
    /// component, or of a hundredth of the total where that is more; with its 99 % interval (Welch's, over seeds and
    /// the reference's groups), if there are two seeds or more.
    Estimate excess;
    FootingVerdict verdict = FootingVerdict::unresolved;

    /// The same of two methods of one scene, where the reference cannot tell: (this - other) / unit.
    Footing against(const Footing& other) const;
};

/// `replicates`: images of one component by independent seeds; `reference`: of the same component; `total`: the
/// reference's total image. With 99 % intervals one in a hundred noisy cells is unlucky; a method that is wrong by the
/// tolerance or more is passed as agreeing with a probability below 0.5 %. Empty if the reference is black.
std::optional<Footing> equal_footing(const std::vector<Image>& replicates, const ReferenceLayer& reference,
                                     const Image& total);

}  // namespace gib
