#pragma once
// Compares methods with each other: which is closest to the reference after the same time, which checkpoints lie on
// the Pareto frontier of time and error, and how bias falls with a parameter.

#include "experiments/analysis/curves.h"

#include <string>
#include <vector>

namespace gib {

/// The errors of the methods in one component of one scene after the same charged time.
struct EqualTimeRow {
    struct Entry {
        std::string method;
        double relative_rmse;  ///< sqrt of the seeds' mean rel_mse, less the reference's own variance
    };
    std::string scene, component;
    double seconds;  ///< equal_time()
    /// The methods that have an image by then and an error above the noise floor, best first.
    std::vector<Entry> entries;
};
/// The time [s] after which the methods of a scene are compared: the shortest of their mean total times, without methods
/// that have converged, whose images more time would not change (the longest of all if each has).
double equal_time(const CellsByMethod& methods);
/// The rows of every scene with two methods or more; none for the total where part of the light is not judged. Between
/// two checkpoints, errors follow a power law of time.
std::vector<EqualTimeRow> equal_time_rows(const Analysis& analysis);

/// A checkpoint that no other checkpoint of any method beats: none is as close to the reference in less time, or
/// closer in the same time.
struct FrontierPoint {
    std::string scene, method;
    std::uint32_t passes;
    double seconds;        ///< mean over the seeds
    double relative_rmse;  ///< relative RMSE of the total image, as in EqualTimeRow; 0: not above the noise floor
};
/// The Pareto frontier over the checkpoints of all methods, for every scene with two methods or more whose light is
/// judged completely. Points are
/// ordered by scene, then by time.
std::vector<FrontierPoint> pareto_frontier(const Analysis& analysis);

/// The fitted law bias^2 = c x^-exponent over the values x of a parameter, with all other parameters equal.
struct BiasLaw {
    std::string scene, component;
    std::string method;     ///< the label without the parameter
    std::string parameter;  ///< name of the parameter
    std::vector<double> values = {};
    Estimate exponent = {};  ///< exponent by weighted least squares in the logarithms
    /// The number of values at which bias^2 is above 0 with its whole interval; only these are fitted.
    std::size_t resolved_count = 0;
};
/// One law for every numeric parameter that takes three values or more in labels that are otherwise equal, if at
/// least three of these values are resolved.
std::vector<BiasLaw> bias_laws(const Analysis& analysis);

}  // namespace gib
