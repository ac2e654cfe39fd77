#pragma once
// Error against time as the report draws it: the mean of the seeds at each pass that all of them have.

#include "experiments/analysis/analysis.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib {

struct MeanPoint {
    std::uint32_t passes;
    double seconds;  ///< mean over the seeds
    /// Roots of the seeds' mean squared errors, less the reference's own variance. Bands: 95 %, Student's t over the
    /// seeds' scatter alone, symmetric in the logarithm; none with one seed.
    Estimate relative_rmse, rmse;
};

/// Only points with times and errors above 0, which have a place on logarithmic axes, and above what the reference
/// resolves.
std::vector<MeanPoint> mean_curve(const Analysis& analysis, const std::string& scene, const std::string& method,
                                  const std::string& component);

}  // namespace gib
