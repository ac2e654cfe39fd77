#pragma once
// Who is best: the one place that decides which method wins a comparison, which ones cannot be told from it, and of which
// ones nothing is known there.

#include "experiments/metrics/statistics.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

enum class Standing {
    best,
    tie,  ///< cannot be told from the best
    behind,
    open,        ///< its run ended before this could be told
    incomplete,  ///< leaves out light, so that its number does not count
    no_image,
};

/// A method in a comparison of numbers of which the smaller is better: an error, or the logarithm of a time.
struct Contender {
    /// The relation of `values` to the numbers that are compared.
    enum class Known { equal, lower_bounds, upper_bounds };

    std::string method;
    std::vector<double> values;  ///< one for each seed; empty: no image
    Known known = Known::equal;
    bool is_complete = true;                 ///< whether it has all light
    std::optional<Interval> by_law = {};     ///< where only bounds are known: 95 % interval of the number by its law
    double ended = 0;                        ///< mean time of the runs [s]
    double first_image = 0;                  ///< time after which all runs have an image [s]
    Standing standing = Standing::no_image;  ///< set by ranked()

    double mean() const;
};

/// The probability with which two methods of equal means are told apart. It is smaller than that of the intervals,
/// because many pairs are compared.
inline constexpr double tie_tail = 0.02;

/// Whether the mean of `better` is below that of `worse` for sure (half_width()). One seed tells nothing.
bool are_told_apart(const std::vector<double>& better, const std::vector<double>& worse);

/// The contenders in their order, with their standings: the complete ones whose numbers are known, by their means; those
/// whose runs ended; those that leave out light; those without an image. A complete one whose number is known is best.
std::vector<Contender> ranked(std::vector<Contender> contenders);

/// The first one if it is the best; null if none is.
const Contender* best_of(const std::vector<Contender>& ranking);
/// The methods with this standing, in their order.
std::vector<std::string> those(const std::vector<Contender>& ranking, Standing standing);

}  // namespace gib
