#pragma once
// Maps from the unit square to the distributions that light transport needs, with their densities.

#include "common/core/math.h"

#include <algorithm>
#include <vector>

namespace gib {

struct SineCosine {
    float sine, cosine;
};
/// Sine and cosine for |x| <= pi / 4 by Taylor's series, whose next terms are below 2^-25. A function call instead
/// would force all registers into memory.
inline SineCosine small_sine_cosine(float x) {
    const float x2 = x * x;
    return {x * (1.f + x2 * (-1.f / 6 + x2 * (1.f / 120 + x2 * (-1.f / 5040 + x2 * (1.f / 362880))))),
            1.f + x2 * (-1.f / 2 + x2 * (1.f / 24 + x2 * (-1.f / 720 + x2 * (1.f / 40320))))};
}

/// A uniform point of the unit disc by the concentric map (Shirley and Chiu 1997). Neighbours in the square stay
/// neighbours on the disc, so that stratification survives.
inline Vec2 square_to_disk(const Vec2& u) {
    const float a = 2.f * u.x() - 1.f, b = 2.f * u.y() - 1.f;
    if (a == 0.f && b == 0.f) return Vec2::Zero();
    const bool wide = std::abs(a) > std::abs(b);
    const float side = wide ? a : b, other = wide ? b : a;
    const SineCosine angle = small_sine_cosine((pi / 4) * (other / side));  // from the nearer axis
    const float along = side * angle.cosine, across = side * angle.sine;
    return wide ? Vec2(along, across) : Vec2(across, along);
}

/// A direction of the upper hemisphere in the local frame, with density cos(theta) / pi [1/sr].
inline Vec3 square_to_cosine_hemisphere(const Vec2& u) {
    const Vec2 d = square_to_disk(u);
    // 1 - d.d >= 0 up to rounding; the lower bound keeps the density positive for the direction that is returned.
    return {d.x(), d.y(), std::sqrt(std::max(1.f - d.squaredNorm(), 1e-12f))};
}
inline float cosine_hemisphere_pdf(float cos_theta) { return std::max(cos_theta, 0.f) * inv_pi; }

/// Uniform directions on the unit sphere and their density [1/sr].
inline constexpr float uniform_sphere_pdf_w = 0.25f * inv_pi;
inline Vec3 square_to_sphere(const Vec2& u) {
    const float z = 1.f - 2.f * u.x();
    const float r = safe_sqrt(1.f - z * z);
    const float phi = 2.f * pi * u.y();
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A uniform direction in the cone around +z with half angle theta, where `one_minus_cos_max` is 1 - cos(theta). The
/// density is 1 / (2 pi one_minus_cos_max) [1/sr]. Unlike cos, 1 - cos keeps the precision of narrow cones.
inline Vec3 square_to_cone(const Vec2& u, float one_minus_cos_max) {
    const float one_minus_cos = u.x() * one_minus_cos_max;
    const float sin_theta = safe_sqrt(one_minus_cos * (2.f - one_minus_cos));
    const float phi = 2.f * pi * u.y();
    return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), 1.f - one_minus_cos};
}

/// Barycentric weights of the second and third vertex of a uniform point of the triangle.
/// Source: Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
inline Vec2 square_to_triangle(const Vec2& u) {
    // Both coordinates lose half of the smaller one. The minimum replaces a branch, which could not be predicted.
    const float half = 0.5f * std::min(u.x(), u.y());
    return {u.x() - half, u.y() - half};
}

/// x in [0, 1] with a density that is linear, proportional to `f0` at 0 and to `f1` at 1; both must be >= 0. Uniform
/// if both are 0.
inline double sample_linear(double u, double f0, double f1) {
    // x is the root of f0 x + (f1 - f0) x^2 / 2 = u (f0 + f1) / 2, in the form that does not cancel for f1 near f0.
    const double denominator = f0 + std::sqrt((1 - u) * sqr(f0) + u * sqr(f1));
    return denominator > 0 ? std::min(u * (f0 + f1) / denominator, 1.0) : u;
}

/// The polar part of a density over directions: f(theta) sin(theta) for theta [rad] in [theta0, theta1], where f is
/// linear from f0 >= 0 to f1 >= 0.
struct PolarRamp {
    double theta0, theta1;
    double f0, f1;

    /// The integral of f(theta) sin(theta) over the interval, with full relative precision even for
    /// the narrowest intervals.
    double integral() const;
    /// A random theta [rad] with a density proportional to this function, by inversion to 1e-12 of the interval. f0
    /// and f1 must not both be 0.
    double sample(double u) const;
};

/// A choice among n items with probabilities proportional to given weights.
class DiscreteDistribution {
public:
    DiscreteDistribution() = default;
    /// Weights must be finite and >= 0. If all are 0, total() is 0 and sample() must not be called.
    explicit DiscreteDistribution(const std::vector<double>& weights);

    std::size_t size() const { return items_.size(); }
    double total() const { return total_; }
    float probability(std::size_t i) const { return items_[i].probability; }
    /// The smallest u for which sample() chooses item i.
    float begin(std::size_t i) const { return items_[i].begin; }

    struct Choice {
        std::size_t index;
        float probability;
        float u;  ///< the rest of the random number, uniform in [0, 1) again
    };
    Choice sample(float u) const {
        // The chosen item is the last that begins at or below u. The bisection has no branches, which could
        // not be predicted.
        std::size_t i = 0;
        for (std::size_t rest = items_.size(); rest > 1;) {
            const std::size_t half = rest / 2;
            i += items_[i + half].begin <= u ? half : 0;
            rest -= half;
        }
        const Item& item = items_[i];
        return {i, item.probability, std::min((u - item.begin) * item.per_probability, 1.f - unit_roundoff)};
    }

private:
    struct Item {
        float begin, probability;  ///< start and length of the item's interval in [0, 1)
        float per_probability;     ///< 1 / probability
    };
    std::vector<Item> items_;
    double total_ = 0;
};

}  // namespace gib
