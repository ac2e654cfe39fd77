#pragma once
// Student's t distribution: quantiles for intervals from few replicates, tails for tests.

namespace gib {

/// The t for which P(|T| > t) = `tail`; `degrees` >= 1 may be fractional (Welch-Satterthwaite) or infinite (the normal
/// law). Relative error below 1e-9. `tail` in (0, 1).
double student_t_two_sided(double tail, double degrees);

/// P(|T| >= t) for t >= 0; `degrees` as above. 0 for an infinite t. Relative error below 1e-7, beyond
/// 1e7 degrees t^4 / 4e7.
double student_t_tail(double t, double degrees);

}  // namespace gib
