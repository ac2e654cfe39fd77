#include "experiments/plan/epsilon.h"

#include <fmt/format.h>

#include <cmath>

namespace gib {

void require_epsilon(double epsilon, const SourceLocation& where) {
    // isfinite() comes first, because a comparison with NaN is an invalid operation, which some builds trap.
    if (std::isfinite(epsilon) && epsilon >= smallest_epsilon && epsilon <= largest_epsilon) return;
    const std::string given = std::isnan(epsilon) ? "nan" : fmt::format("{}", epsilon);
    throw InputError(
        where, fmt::format("epsilon is a number from {:g} to {:g}, not {}", smallest_epsilon, largest_epsilon, given));
}

}  // namespace gib
