#pragma once
// The price of accuracy in words and tables, for table.md and the report.

#include "experiments/price.h"

#include <string>
#include <vector>

namespace gib {

/// Which method is cheapest at an error, how much more the next one takes, and what keeps the others from it.
struct PriceAnswer {
    std::string scene;
    double target;  ///< relative RMSE
    std::string text;
};
/// For 5 % and 1 %, of every scene. Times that no run has measured are marked as extrapolated by the fitted law.
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
