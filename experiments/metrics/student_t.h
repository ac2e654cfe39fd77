#pragma once
// Student's t distribution: quantiles for intervals from few replicates, tails for tests.

#include <span>
#include <vector>

namespace gib {

/// A part of a statistic's variance, and how well it is known.
struct VarianceTerm {
    double variance, degrees;
};

/// Half the width of the interval that leaves out `tail` (both sides together), with the degrees of freedom of Welch
/// (1947) and Satterthwaite (1946). 0 without variance, NaN if a term is NaN.
double half_width(const std::vector<VarianceTerm>& terms, double tail);

/// The mean of a sample, and that mean's variance: scatter / (n (n - 1)), n - 1 degrees of freedom; NaN for less than 2
/// values. Of values that are not finite, both are NaN.
struct SampleMean {
    double value;
    VarianceTerm variance;
};
SampleMean sample_mean(std::span<const double> values);

/// The t for which P(|T| > t) = `tail`; `degrees` >= 1 may be fractional (Welch-Satterthwaite) or infinite (the normal
/// law). Relative error below 1e-9. `tail` in (0, 1).
double student_t_two_sided(double tail, double degrees);

/// P(|T| >= t) for t >= 0; `degrees` as above. 0 for an infinite t. Relative error below 1e-7, beyond
/// 1e7 degrees t^4 / 4e7.
double student_t_tail(double t, double degrees);

}  // namespace gib
