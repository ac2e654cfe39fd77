#pragma once
// Kernels of the density estimate: radial weights over a disc, or in media over a ball, each with integral 1. With s =
// d / r the weight over a disc times pi r^2 is 1 (uniform), 3 (1 - s) (cone; Jensen 1996, normalised), 2 exp(-2 s^2) /
// (1 - exp(-2)) (gaussian, cut off at two standard deviations), 2 (1 - s^2) (epanechnikov); over a ball the weights
// have the same shapes.

#include <array>
#include <numbers>
#include <string_view>

namespace gib {

/// Width of the Gaussian in units of the radius at which it is cut off.
inline constexpr float gaussian_sigma = 0.5f;

enum class Kernel { uniform, cone, gaussian, epanechnikov };
inline constexpr std::array<std::string_view, 4> kernel_names = {"uniform", "cone", "gaussian", "epanechnikov"};

/// K(d) [1/area] for d^2 = `d2` <= r^2, r > 0; integrates to 1 over the disc of radius r. In double: at a focus discs
/// are so small that 1 / r^2 exceeds the range of float.
double kernel_weight(Kernel kernel, float d2, float r);
/// The share of the kernel's integral within the distance `s` of the centre, where s is a fraction of r in [0, 1].
float kernel_mass(Kernel kernel, float s);
/// Inverse of kernel_mass(): the distance, as a fraction of r, within which the share `u` lies.
float kernel_radius(Kernel kernel, float u);

/// K(d) [1/volume] for d^2 = `d2` <= r^2, r > 0; integrates to 1 over the ball of radius r. In double: 1 / r^3
/// exceeds the range of float below r = 1e-13.
double ball_kernel_weight(Kernel kernel, float d2, float r);
/// The distance, as a fraction of r, below which the share `u` of the kernel's integral over the ball lies.
float ball_kernel_radius(Kernel kernel, float u);

/// The bias of an estimate from the radius r, which falls as r^2, is this multiple of its difference to the estimate from
/// the same photons within r / sqrt(2), whose bias is half as large.
inline constexpr float bias_of_difference = 2.f;
inline constexpr float narrow_radius = std::numbers::sqrt2_v<float> / 2.f;  ///< the smaller radius, as a fraction of r

}  // namespace gib
