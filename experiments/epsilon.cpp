#include "experiments/epsilon.h"

#include <fmt/format.h>

namespace gib {

void require_epsilon(double epsilon, const SourceLocation& where) {
    if (!(epsilon >= smallest_epsilon && epsilon <= largest_epsilon))
        throw InputError(where, fmt::format("epsilon is a number from {:g} to {:g}, not {}", smallest_epsilon,
                                            largest_epsilon, epsilon));
}

}  // namespace gib
