#pragma once
// Student's t distribution: quantiles for intervals from few replicates, tails for tests.

#include <span>
#include <vector>

namespace gib {

/// The probability that a 95 % interval misses the truth, both sides together.
inline constexpr double interval_tail = 0.05;

/// An independent contribution to the variance of a statistic, and the degrees of freedom with which it is known.
struct VarianceTerm {
    double variance, degrees;
};

/// Half the width of the interval that misses the truth with probability `tail` at most (both sides together):
/// sqrt(sum t_i^2 v_i), with Student's t_i for the degrees of freedom of the variance v_i (Banerjee 1960). It is exact
/// for one term. The degrees of freedom of Welch and Satterthwaite give narrower intervals, but are themselves
/// estimated: with 2 degrees of freedom, 99 % intervals by them cover 97 %. 0 without variance, NaN if a term is NaN.
double half_width(const std::vector<VarianceTerm>& terms, double tail);

/// The mean of a sample of n values, and the variance of that mean: sum (v - mean)^2 / (n (n - 1)), with n - 1
/// degrees of freedom. The variance is NaN for fewer than 2 values; both are NaN if a value is not finite.
struct SampleMean {
    double value;
    VarianceTerm variance;
};
SampleMean sample_mean(std::span<const double> values);

/// The t for which P(|T| > t) = `tail`, which lies in (0, 1). `degrees` >= 1 may be fractional (Welch-Satterthwaite)
/// or infinite (the normal distribution).
double student_t_two_sided(double tail, double degrees);

/// P(|T| >= t) for t >= 0, which may be infinite; `degrees` as above.
double student_t_tail(double t, double degrees);

}  // namespace gib
