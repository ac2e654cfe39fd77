#pragma once
// The double contour integral of form factors.

#include "methods/radiosity/form_factors/convex_region.h"

namespace gib {

/// The integral of the kernel of polygon_form_factor.h over both polygons, each of which lies wholly in front of the
/// other, or in its plane: area times form factor [scene units^2]. By Stokes' theorem twice it is 1 / (2 pi) times the
/// integral of ln |x - y| dx . dy around both, counter-clockwise seen from the front (Sparrow 1963; Schroeder and
/// Hanrahan 1993). Its inner integral is closed, and finite where the contours touch; the outer one is adaptive, around
/// `outer`. The error is below `error_share` times the larger of the result and `negligible`, but not below rounding.
double contour_integral(const ConvexRegion& outer, const ConvexRegion& inner, double error_share, double negligible);

}  // namespace gib
