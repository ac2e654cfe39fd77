#pragma once
// The form factor of two polygons as an integral around both contours.

#include "methods/radiosity/form_factors/convex_region.h"

namespace gib {

/// The integral of the kernel of polygon_form_factor.h over both polygons, which is area times form factor [scene
/// units^2]. Each polygon must lie wholly in front of the other, or in its plane. Stokes' theorem, applied twice,
/// turns the integral into 1 / (2 pi) times the integral of ln |x - y| dx . dy around both contours,
/// counter-clockwise seen from the front (Sparrow 1963; Goral et al. 1984; Schroeder and Hanrahan 1993, "On the Form
/// Factor between Two Polygons"). The inner integral has a closed form, which is finite where the contours touch; the
/// outer one, around `outer`, is adaptive. The error is below `error_share` times the larger of the result and
/// `negligible`, but not below rounding.
double contour_integral(const ConvexRegion& outer, const ConvexRegion& inner, double error_share, double negligible);

}  // namespace gib
