#pragma once
// Adaptive integration, over rectangles, of functions that may have narrow peaks and jumps,
// with an estimate of the error.

#include "common/core/math.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace gib::test {

struct Rectangle {
    Vec2d lower, upper;

    Vec2d extent() const { return upper - lower; }
    double area() const { return extent().prod(); }
};

using PlaneFunction = std::function<double(const Vec2d&)>;

struct Integral {
    double value = 0;
    double error = 0;       ///< estimated standard deviation, see integrate()
    bool converged = true;  ///< the error is below the tolerance
};

/// The integral of f over the union of `boxes`, which must be fine enough for a rule of 3 x 3 points to notice every
/// feature. The box with the largest error is halved along the axis along which halving changes its integral most,
/// until the total error is below `tolerance(value)` or `max_evaluations` are spent. The error of a box is the change
/// of its integral by halving: an overestimate by orders of magnitude where the function is smooth, and about right
/// where a jump crosses the box. Errors at jumps have either sign, so the errors of boxes are added as independent
/// ones (in squares). Throws std::domain_error where f is not finite.
Integral integrate(const PlaneFunction& f, const std::vector<Rectangle>& boxes,
                   const std::function<double(double)>& tolerance, std::size_t max_evaluations);

}  // namespace gib::test
