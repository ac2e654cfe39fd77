#pragma once
// States the price of accuracy in words, for table.md and the report.

#include "experiments/analysis/price.h"

#include <array>
#include <string>
#include <vector>

namespace gib {

/// Indices into target_errors of the errors for which price_answers() names the cheapest method: 5 % and 1 %.
inline constexpr std::array<std::size_t, 2> asked_targets = {1, 3};

/// The time [s] to target_errors[target], "12.3 (11.0 to 14.1)"; "not resolved" if the reference cannot tell that an
/// image has reached it; if no run has reached it, "42.0 (extrapolated)" if
/// the method's law holds, "never (floor 2.30 %)" if its floor is above the error, else "not reached". Empty if the row is
/// not judged.
std::string time_text(const TableRow& row, std::size_t target);

/// Whether a method has reached the target with all light of the scene. One that leaves out an effect, or paths of a
/// component that holds light, is never the cheapest, however small its share of the error is.
bool reaches(const TableRow& row, std::size_t target);

/// The answer for one scene and error: which method is cheapest, how much longer the next one takes, and how far the
/// others are then.
struct PriceAnswer {
    std::string scene;
    std::string text;
};
/// The answers for every scene and each of asked_targets. Where the reference does not judge a component that holds
/// light, there is one answer: no method is the cheapest. Times that no run has measured are marked as extrapolated by
/// the fitted law.
std::vector<PriceAnswer> price_answers(const Analysis& analysis);

/// The label with the smallest error of its final images, among those that leave out no light if there are such: the
/// one that is named where no method has reached an error. Null if the scene has no judged row.
const TableRow* closest_row(const Analysis& analysis, const std::string& scene);

/// PriceLaw::next_halving, unless the law does not hold or the factor is too large to be extrapolated.
std::optional<Estimate> next_halving(const TableRow& row);

/// The factor by which the time has to grow to halve the error of the final image, by the fitted law: "3.90 (3.10 to
/// 4.80)", "at least 4.10", "never: floor"; empty if no law holds.
std::string next_halving_text(const TableRow& row);

}  // namespace gib
