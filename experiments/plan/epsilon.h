#pragma once
// The epsilon of relative errors, (x - r)^2 / (r^2 + epsilon) [radiance^2]: its default and its range, which hold for
// the experiment file and for the command line.

#include "common/core/reject.h"

namespace gib {

inline constexpr double default_epsilon = 0.01;

/// The range keeps relative errors and their squares within the range of double. Where r is 0, the square of a
/// difference of floats, 4.6e77 at most, is divided by epsilon alone. Intervals square the quotient again: double
/// holds this square from an epsilon of 4e-77 on, and the sum of 3e9 such squares from 2e-72 on. The upper bound
/// keeps the squares as far from underflow.
inline constexpr double smallest_epsilon = 1e-60, largest_epsilon = 1e60;

/// Throws InputError at `where` unless epsilon lies in [smallest_epsilon, largest_epsilon].
inline void require_epsilon(double epsilon, const SourceLocation& where = {}) {
    if (!(epsilon >= smallest_epsilon && epsilon <= largest_epsilon))
        reject(where, "epsilon is a number from {:g} to {:g}, not {}", smallest_epsilon, largest_epsilon, epsilon);
}

}  // namespace gib
