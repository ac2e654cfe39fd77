#pragma once
// The epsilon of relative errors, (x - r)^2 / (r^2 + epsilon) [radiance^2], without which dark pixels would decide the
// error.
//
// An epsilon that is given is absolute; papers take 0.01. Otherwise it is (0.1 m)^2, where m is the mean luminance of
// the reference r [W/(sr m^2)]: pixels darker than a tenth of the mean weigh nearly alike, brighter ones by 1 / r^2. If
// another unit of light multiplies x and r by s, then m^2 and r^2 grow by s^2 as (x - r)^2 does, and the relative error
// stays. The share of a hundredth makes it the papers' epsilon at a mean luminance of 1.

#include "common/core/reject.h"
#include "common/images/image.h"

#include <optional>

namespace gib {

/// The range keeps relative errors and their squares within the range of double. Where r is 0, the square of a
/// difference of floats, 4.6e77 at most, is divided by epsilon alone. Intervals square the quotient again: double
/// holds this square from an epsilon of 4e-77 on, and the sum of 3e9 such squares from 2e-72 on. The upper bound
/// keeps the squares as far from underflow.
inline constexpr double smallest_epsilon = 1e-60, largest_epsilon = 1e60;

/// The default epsilon is the square of this share of the reference's mean luminance.
inline constexpr double relative_epsilon_share = 0.1;

/// Throws InputError at `where` unless epsilon lies in [smallest_epsilon, largest_epsilon].
inline void require_epsilon(double epsilon, const SourceLocation& where = {}) {
    if (!(epsilon >= smallest_epsilon && epsilon <= largest_epsilon))
        reject(where, "epsilon is a number from {:g} to {:g}, not {}", smallest_epsilon, largest_epsilon, epsilon);
}

/// The epsilon of errors relative to the image `r` [radiance^2]: the number that is given, else the default. The
/// default keeps to the range above: a black reference has the smallest epsilon, and any light is a huge error there.
double epsilon_of(const std::optional<double>& given, const Image& r);

}  // namespace gib
