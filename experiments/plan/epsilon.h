#pragma once
// The epsilon of relative errors, (x - r)^2 / (r^2 + epsilon) [radiance^2]: the experiment file and the command line
// take the same ones.

#include "common/core/error.h"

namespace gib {

inline constexpr double default_epsilon = 0.01;

/// Where r is 0, a difference of floats squared, 4.6e77 at most, is divided by epsilon alone; intervals square that
/// again, which double holds from an epsilon of 4e-77 on, and its sum over 3e9 numbers from 2e-72 on. The upper bound
/// keeps squares of relative errors as far from zero.
inline constexpr double smallest_epsilon = 1e-60, largest_epsilon = 1e60;

/// Throws InputError at `where` unless epsilon lies between these two.
void require_epsilon(double epsilon, const SourceLocation& where = {});

}  // namespace gib
