#pragma once
// Methods against each other: which is closest to the reference after the same time, which are worth their time, and
// how bias falls along a sweep.

#include "experiments/analysis/analysis.h"

#include <string>
#include <vector>

namespace gib {

/// One component of one scene after the same charged time.
struct EqualTimeRow {
    struct Entry {
        std::string method;
        double relative_rmse;  ///< sqrt of the seeds' mean rel_mse, the reference's own variance subtracted
    };
    std::string scene, component;
    double seconds;  ///< the shortest of the methods' whole times
    std::vector<Entry>
        entries;  ///< best first; methods that have an image by then and an error above what the reference resolves
};
/// Of every scene with two methods or more. Errors between two checkpoints follow a power law of time.
std::vector<EqualTimeRow> equal_time_rows(const Analysis& analysis);

/// A checkpoint that no other one of any method beats: none is as close to the reference in less time, nor closer in
/// the same.
struct FrontierPoint {
    std::string scene, method;
    std::uint32_t passes;
    double seconds;        ///< mean over the seeds
    double relative_rmse;  ///< of the whole image, as in EqualTimeRow; 0: below what the reference resolves
};
/// Pareto's frontier over the checkpoints of all methods, of every scene with two methods or more; by scene, then by
/// time.
std::vector<FrontierPoint> pareto_frontier(const Analysis& analysis);

/// bias^2 = c x^-exponent over the values x of a parameter, all else equal.
struct BiasLaw {
    std::string scene, component;
    std::string method;     ///< the label without the parameter
    std::string parameter;  ///< its name
    std::vector<double> values;
    Estimate exponent;  ///< weighted least squares of the logarithms
    std::size_t
        resolved_count;  ///< of the values: where bias^2 is above 0 with its whole interval; only these are fitted
};
/// For every numeric parameter of which three values or more stand among labels that are otherwise equal; at least
/// three resolved.
std::vector<BiasLaw> bias_laws(const Analysis& analysis);

/// All as sections of table.md; empty where there is nothing to say.
std::string comparison_text(const Analysis& analysis);

}  // namespace gib
