#pragma once
// The price of accuracy in words and tables, for table.md and the report.

#include "experiments/analysis/price.h"

#include <array>
#include <string>
#include <vector>

namespace gib {

/// The places in target_errors of the errors that answers are given for: 5 % and 1 %.
inline constexpr std::array<std::size_t, 2> asked_targets = {1, 3};

/// Whether the reference can tell that an image has come so close to it.
bool is_target_resolved(const Analysis& analysis, const std::string& scene, const std::string& component,
                        std::size_t target);

/// Which method is cheapest at an error, how much more the next one takes, and what keeps the others from it.
struct PriceAnswer {
    std::string scene;
    double target;  ///< relative RMSE
    std::string text;
};
/// For the asked_targets, of every scene. Times that no run has measured are marked as extrapolated by the fitted law.
std::vector<PriceAnswer> price_answers(const Analysis& analysis);

/// A time to an error that was not measured: "42.0 (extrapolated)" where the method's law holds, "never (floor 2.30 %)"
/// where its floor is above the error, else empty.
std::string unmeasured_time(const TableRow& row, double target);

/// What the time has to be multiplied by for half the error of the final image, by the law: "3.90 (3.10 to 4.80)",
/// "at least 4.10", "never: floor"; empty where no law holds.
std::string next_halving_text(const TableRow& row);

/// Sections of table.md: answers, price lists, crossovers.
std::string price_text(const Analysis& analysis);

}  // namespace gib
