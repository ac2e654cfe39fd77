#pragma once
// A sampler beside the density that it claims to have, and what can be tested about the two.

#include "common/sampling/sampler.h"
#include "tests/samplers/adaptive_quadrature.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gib::test {

/// The random numbers of one sample, each uniform in [0, 1).
struct RandomNumbers {
    Vec2 choice;  ///< of a lobe, a light
    Vec2 u, v;

    explicit RandomNumbers(const Sampler& s) : choice(s.get_2d(0)), u(s.get_2d(1)), v(s.get_2d(2)) {}
    /// Every number at the lower or the upper end of its range: bit i of `corner` says which.
    explicit RandomNumbers(unsigned corner);
};

/// What a sampler returned, at a point of the plane (solid angles through a SphereChart).
struct Sampled {
    Vec2d point = Vec2d::Zero();
    double pdf = 0;        ///< as the sampler says
    double pdf_again = 0;  ///< as the density function says for the same point
    double weight = 1;     ///< what an estimator would make of it: value / pdf
    bool delta = false;    ///< of a delta lobe: counts for the weight only
};

/// The rectangle that the points lie in, with the lines where the density may jump (first and last: its sides).
struct Domain {
    std::vector<double> x_breaks, y_breaks;

    Rectangle bounds() const { return {{x_breaks.front(), y_breaks.front()}, {x_breaks.back(), y_breaks.back()}}; }
};

/// One sampler with one set of parameters.
struct SamplerCase {
    std::string name;  ///< also the seed: cases may be added without changing the numbers of others
    Domain domain;
    /// Empty where the sampler gives up.
    std::function<std::optional<Sampled>(const RandomNumbers&)> sample;
    PlaneFunction pdf;
    /// The integral of the density where theory gives it: 1, or less because of delta lobes or samples that are given
    /// up.
    std::optional<double> total = 1.0;
    /// The numerator of `weight`, if the weight is to be tested too.
    PlaneFunction value = nullptr;
    /// The mean of `weight` over all samples, delta lobes included, where theory gives it (an albedo).
    std::optional<double> mean_weight = {};
    /// No mean of weights may be larger (energy conservation).
    double largest_mean_weight = infinity;
};

/// (1 - cos theta, phi) around an axis: area is solid angle. 1 - cos is formed without cancellation around the axis, so
/// that lobes and cones of any width are resolved there.
class SphereChart {
public:
    explicit SphereChart(const Vec3d& axis = Vec3d::UnitZ());

    Vec2d point(const Vec3d& w) const;
    Vec3d direction(const Vec2d& point) const;
    /// Of all directions; a jump at the equator (the horizon of a surface) is expected, and at further values of 1 -
    /// cos.
    static Domain domain(const std::vector<double>& breaks = {});

private:
    Eigen::Matrix3d to_local_;
};

struct SampledDirection {
    Vec3 w;  ///< unit
    double pdf;
    double weight = 1;
    bool delta = false;
};

/// A sampler of directions with a density over solid angle.
SamplerCase sphere_case(std::string name, const SphereChart& chart,
                        std::function<std::optional<SampledDirection>(const RandomNumbers&)> sample,
                        const std::function<double(const Vec3&)>& pdf);

/// A sampler of points of the plane that never gives up and whose density is a function of the point alone.
SamplerCase plane_case(std::string name, Domain domain, std::function<Vec2(const RandomNumbers&)> sample,
                       const PlaneFunction& pdf);

/// Limits on what is not a matter of chance.
namespace limits {
inline constexpr double pdf_mismatch = 1e-3;      ///< relative, of the two densities of a sample ...
inline constexpr double mismatch_share = 1e-5;    ///< ... which this share of samples may exceed: rounding at jumps
inline constexpr double lost_share = 1e-5;        ///< of samples given up though the density integrates to 1
inline constexpr double integral = 1e-3;          ///< of the density's integral
inline constexpr double mean_weight = 1e-3;       ///< of the weights' mean
inline constexpr double quadrature_error = 0.02;  ///< of a cell's expected count, in standard deviations of the count
}  // namespace limits

struct PValue {
    std::string test;
    double p;
};

struct CaseResult {
    std::string name;
    std::vector<PValue> p_values;
    std::vector<std::string> failures;  ///< of what is not a matter of chance
    double integral = 0, integral_error = 0;
    double mean_weight = 0;
    std::size_t evaluations = 0;  ///< of the density and of the weights' numerator
};

/// Draws `samples` and tests:
/// - counts in 1024 cells of equal probability, and in 16, against the integrals of the density over them (chi-square),
/// where the
///   samples that were given up are one more cell;
/// - the mean weight against the integral of `value` (normal law), if there is one;
/// - that the densities of a sample agree, are positive and finite, also at the ends of the random numbers' ranges;
/// - the known integrals.
/// A pilot sample of its own makes the cells and tells the quadrature where to look.
CaseResult run_case(const SamplerCase& test, std::uint64_t samples);

}  // namespace gib::test
