#pragma once
// Ranks methods: which one is best, which ones do not differ significantly from it, and which ones are unknown.
//
// The logarithms of errors and times are compared. Few seeds estimate a method's own scatter s_i^2 badly: with 3 seeds
// and 2 degrees of freedom t is 6.96 at 98 %. The methods of a comparison together have D = sum (n_i - 1) degrees of
// freedom for the pooled scatter s^2 = sum (n_i - 1) s_i^2 / D. Methods are not equally noisy, though. So the mean of
// method i has the variance s^2 / n_i with D degrees of freedom, and where its own scatter is larger, in addition
// (s_i^2 - s^2) / n_i with n_i - 1. Unsampled light does not contribute to the scatter.
//
// All methods are compared with one reference R = r + h. Its noise h favours those methods whose images err in its
// direction: to first order it changes log E_i, E_i = mean w (x_i - R)^2, by u_i = -2 mean w (x_i - R) h / E_i. So the
// difference of two methods has in addition the variance of u_i - u_j, which the scatter over the reference's m groups
// gives with m - 1 degrees of freedom. The logarithms of times shift by as much as those of errors, because squared
// errors fall as 1 / time.

#include "experiments/analysis/curves.h"
#include "experiments/metrics/statistics.h"
#include "experiments/metrics/student_t.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

enum class Standing {
    best,
    tie,       ///< not significantly different from the best
    one_seed,  ///< inconclusive, because one seed has no scatter
    behind,
    open,        ///< inconclusive, because its run ended earlier
    incomplete,  ///< leaves out light, so that its number does not count
    no_image,
};

/// A method in a comparison of squared errors or times; the smaller is better.
struct Contender {
    /// The relation of `mean` and `logs` to the numbers that are compared.
    enum class Known { equal, lower_bounds, upper_bounds };

    std::string method;
    double mean = 0;                ///< the number, by which contenders are ranked
    std::vector<double> logs = {};  ///< its logarithm for each seed; empty: no image
    Known known = Known::equal;
    bool is_complete = true;              ///< whether it has all light
    std::optional<Interval> by_law = {};  ///< where only bounds are known: 95 % interval of the logarithm by its law
    std::vector<double> pulls = {};       ///< ReplicateStatistics::pulls
    double missed_shift = 0;              ///< ReplicateStatistics::missed_shift
    bool is_close = false;                ///< has not reached an error that lies within the interval of its own
    double ended = 0;                     ///< mean time of the runs [s]
    double first_image = 0;               ///< time after which all runs have an image [s]
    // Set by ranked() and set_scatter():
    Standing standing = Standing::no_image;
    double log_mean = 0;                     ///< mean of `logs`
    std::vector<VarianceTerm> scatter = {};  ///< variance of that mean
};

/// Significance level of the difference of two methods. It is below that of the intervals, because many pairs are
/// compared.
inline constexpr double tie_tail = 0.02;

/// Sets `log_mean` and `scatter` of each contender from the seeds of all.
void set_scatter(std::vector<Contender>& contenders);

/// The variances of the difference of two logarithms: by the scatter of both, and by the noise of the reference.
std::vector<VarianceTerm> difference_terms(const Contender& a, const Contender& b);

/// Whether `better` is significantly smaller than `worse` (half_width()), also with the light that the reference may
/// have missed. False for one seed.
bool differ_significantly(const Contender& better, const Contender& worse);

/// The contenders in order, with their standings: complete ones with known numbers by their means, ended runs, methods
/// that leave out light, methods without an image. Only a complete one with a known number can be best.
std::vector<Contender> ranked(std::vector<Contender> contenders);

/// The first one if it is the best; null if none is.
const Contender* best_of(const std::vector<Contender>& ranking);
const Contender& of_method(const std::vector<Contender>& ranking, const std::string& method);

/// The remark that a sentence about a method has to add.
struct Doubts {
    std::vector<std::string> ties = {};  ///< methods that do not differ significantly from it
    std::vector<std::string> open = {};  ///< methods whose runs ended too early
    std::vector<std::string> lone = {};  ///< methods with one seed, where the method itself has more
    bool one_seed = false;
};
Doubts doubts_about(const std::string& method, const std::vector<Contender>& ranking);

/// The methods of one scene, compared in one layer: after a time, in the time to an error, and by their final images.
class Contest {
public:
    /// `analysis` has to outlive this object.
    Contest(const Analysis& analysis, const std::string& scene, Layer layer = Layer::total);

    std::size_t methods() const { return methods_.size(); }
    const CellsByMethod& cells() const { return methods_; }
    /// Whether the reference has the whole layer, so that a method can be the best.
    bool is_judged() const { return is_judged_; }
    /// The least noise floor of the methods that have all light (TableRow::noise_floor); without one, the reference's.
    double noise_floor() const;
    /// The noise floor of a method's row; without a row, the reference's.
    double noise_floor(const std::string& method) const;

    /// The time [s] after which the methods are compared: the shortest of their mean total times, without methods that
    /// have converged, whose images more time would not change (the longest of all if each has).
    double equal_time() const;
    /// By the squared error after `seconds`. Between two checkpoints, errors follow a power law of time. A method whose
    /// runs ended before is known by its law alone, unless it has converged. Errors below the noise floor are equal.
    std::vector<Contender> after(double seconds) const;
    /// By the time to target_errors[target]. A seed that has not reached it gives its whole time as a lower bound.
    std::vector<Contender> to_error(std::size_t target) const;
    /// By the squared error of the final images; for methods whose runs ended earlier than those of the best, by that
    /// of their law at that time.
    std::vector<Contender> by_final_images() const;

private:
    Contender contender(const std::string& method, const Runs& cells) const;
    bool is_complete(const TableRow& row) const;
    /// Sets the bounds of a method's error after `seconds` by its law.
    void extrapolate(Contender& contender, double seconds) const;
    /// Sets the squared errors of the seeds after `seconds`; where their mean is not above the noise floor, each is
    /// that floor.
    void set_errors(Contender& contender, const Runs& cells, double seconds) const;

    const Analysis& analysis_;
    std::string scene_;
    Layer layer_;
    CellsByMethod methods_;
    bool is_judged_;
    double noise_floor_;
};

}  // namespace gib
