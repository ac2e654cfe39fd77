#pragma once
// Quantiles of Student's t distribution, for intervals from few replicates.

namespace gib {

/// The t for which P(|T| > t) = `tail`; `degrees` >= 1 may be fractional (Welch-Satterthwaite) or infinite (the normal
/// law). Relative error below 1e-9. `tail` in (0, 1).
double student_t_two_sided(double tail, double degrees);

}  // namespace gib
