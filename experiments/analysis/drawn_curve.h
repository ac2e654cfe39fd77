#pragma once
// The curve of error against time that the report draws: the mean of the seeds at each pass that all of them have.

#include "experiments/analysis/analysis.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib {

struct MeanPoint {
    std::uint32_t passes;
    double seconds;  ///< mean over the seeds
    /// Square roots of the seeds' mean squared errors, less the reference's own variance. Their 95 % intervals come
    /// from Student's t over the scatter of the seeds alone and are symmetric in the logarithm; one seed has none.
    Estimate relative_rmse, rmse;
};

/// The points of the curve that logarithmic axes can show, with times and errors above 0, and whose error is above
/// the noise floor.
std::vector<MeanPoint> mean_curve(const Analysis& analysis, const std::string& scene, const std::string& method,
                                  const std::string& component);

}  // namespace gib
