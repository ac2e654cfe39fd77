#pragma once
// Compares methods with each other: which is closest to the reference after the same time, when this changes, which
// checkpoints lie on the Pareto frontier of time and error, how bias falls with a parameter, and which stored image
// each method shows at equal time.

#include "experiments/analysis/ranking.h"
#include "experiments/analysis/table_row.h"
#include "experiments/results/judgement.h"

#include <string>
#include <vector>

namespace gib {

/// The methods in one layer of one scene after Contest::equal_time().
struct EqualTimeRow {
    std::string scene;
    Layer layer;
    double seconds;
    std::vector<Contender> ranking;  ///< by squared errors
    double noise_floor;
};
/// The rows of every scene with two methods or more that have an image at equal time. A total without a verdict has no
/// row.
std::vector<EqualTimeRow> equal_time_rows(const Analysis& analysis);

/// A checkpoint that no other checkpoint of any method beats: none is as close to the reference in less time, or
/// closer in the same time.
struct FrontierPoint {
    std::string scene, method;
    std::uint32_t least_passes, most_passes;
    double seconds;       ///< mean over the seeds
    Field relative_rmse;  ///< of the total
    Doubts doubts = {};   ///< at that time
};
/// The Pareto frontier over the checkpoints of all methods, for every scene with two methods or more whose reference
/// has all light. Points are ordered by scene and time.
std::vector<FrontierPoint> pareto_frontier(const Analysis& analysis);

/// A change of the best method: from `seconds` on, `method` is closer to the reference than the others.
struct Crossover {
    std::string scene, method;
    std::string before = "";  ///< the best method before `seconds`; empty: no method had an image
    double seconds;           ///< charged time [s]
    /// 95 % interval of `seconds`, by the delete-one jackknife over the seeds of both methods in log(time). Empty
    /// below 3 seeds, or if `method` does not pass `before` in one of the means that leave out a seed.
    std::optional<Interval> interval = std::nullopt;
    Field relative_rmse = {};  ///< of `method` at that time
    /// Methods that differ significantly at no time before the next change, and methods whose runs ended before it.
    Doubts doubts = {};
    /// Whether `seconds` is the end of the best method's run, after which the best one is unknown; `method` is empty.
    bool ends = false;
};
/// The changes of the best method, by time, in every scene with two methods or more whose reference has all light.
/// Curves are means over the seeds. After the end of a run its fitted law replaces it. Equal errors
/// cross by chance: a change counts only if the new method becomes closer by 5 %.
std::vector<Crossover> crossovers(const Analysis& analysis);

/// The law y = factor x^-exponent.
struct PowerFit {
    Estimate exponent;
    double factor;
};

/// How the parts of the mean squared error change with a parameter x, with all others equal: the rows by x, and the
/// fitted law of bias^2 [radiance^2].
struct BiasLaw {
    std::string scene;
    Layer layer;
    std::string method;                                         ///< the label without the parameter
    std::string name;                                           ///< the name of its rows without the parameter
    std::string parameter;                                      ///< name of the parameter
    std::vector<std::pair<double, const TableRow*>> rows = {};  ///< by x; of the analysis, which has to outlive them
    /// By weighted least squares in the logarithms. Empty below `resolved_count` 3.
    std::optional<PowerFit> fit = {};
    /// The number of values whose interval of bias^2 lies above 0; only these are fitted.
    std::size_t resolved_count = 0;
    /// The exponent that theory gives for light that is smooth; empty if it gives none.
    std::optional<double> theory = {};
};
/// One for every numeric parameter that takes three values or more in labels that are otherwise equal, unless the
/// method is unbiased.
std::vector<BiasLaw> bias_laws(const Analysis& analysis);

/// The looks of all methods of one scene, after one_label_a_method(), at Contest::equal_time(). A method without an
/// image at that time shows its first image and has no error. FLIP reads the images from the folder and compares frames
/// at their own size.
std::vector<EqualTimeLook> equal_time_looks(const Analysis& analysis, const std::string& scene,
                                            const Judgement& judgement, const ResultFolder& folder);

}  // namespace gib
