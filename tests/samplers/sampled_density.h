#pragma once
// A sampler together with the density that it claims to have, and the tests that compare the two.

#include "common/sampling/sampler.h"
#include "tests/samplers/adaptive_quadrature.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gib::test {

/// The random numbers of one sample, each uniform in [0, 1).
struct RandomNumbers {
    Vec2 choice;  ///< chooses a lobe or a light
    Vec2 u, v;

    explicit RandomNumbers(const Sampler& s) : choice(s.get_2d(0)), u(s.get_2d(1)), v(s.get_2d(2)) {}
    /// Every number at the lower or the upper end of its range: bit i of `corner` says which.
    explicit RandomNumbers(unsigned corner);
};

/// A sample as a point of the plane; a SphereChart maps directions to points.
struct Sampled {
    Vec2d point = Vec2d::Zero();
    double pdf = 0;        ///< density as the sampler returned it
    double pdf_again = 0;  ///< density as the density function gives it for the same point
    double weight = 1;     ///< the weight of an estimator: value / pdf
    bool delta = false;    ///< from a delta lobe: only the weight counts
};

/// The rectangle that contains the points, and the lines where the density may jump (the first and the last line are
/// sides of the rectangle).
struct Domain {
    std::vector<double> x_breaks, y_breaks;

    Rectangle bounds() const { return {{x_breaks.front(), y_breaks.front()}, {x_breaks.back(), y_breaks.back()}}; }
};

/// One sampler with one set of parameters.
struct SamplerCase {
    std::string name;  ///< also gives the seed, so that new cases do not change the numbers of others
    Domain domain;
    /// Returns nothing where the sampler gives up.
    std::function<std::optional<Sampled>(const RandomNumbers&)> sample;
    PlaneFunction pdf;
    /// The integral of the density, where theory gives it: 1, or less because of delta lobes
    /// or of samples that are given up.
    std::optional<double> total = 1.0;
    /// The numerator of `weight`, if the weight is to be tested too.
    PlaneFunction value = nullptr;
    /// The mean of `weight` over all samples, delta lobes included, where theory gives it (an albedo).
    std::optional<double> mean_weight = {};
    /// An upper limit of the mean of `weight` (energy conservation).
    double largest_mean_weight = infinity;
};

/// Maps directions to points (1 - cos theta, phi) around an axis, so that area in the plane is solid angle. 1 - cos
/// theta is computed without cancellation near the axis, so that lobes and cones of any width are resolved there.
class SphereChart {
public:
    explicit SphereChart(const Vec3d& axis = Vec3d::UnitZ());

    Vec2d point(const Vec3d& w) const;
    Vec3d direction(const Vec2d& point) const;
    /// The domain of all directions. The density may jump at the equator (the horizon of a surface) and at the values
    /// of 1 - cos theta in `breaks`.
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

/// Limits of the tests whose outcome is not a matter of chance.
namespace limits {
inline constexpr double pdf_mismatch = 1e-3;      ///< largest relative difference of a sample's two densities ...
inline constexpr double mismatch_share = 1e-5;    ///< ... except in this share of samples, from rounding at jumps
inline constexpr double lost_share = 1e-5;        ///< share of samples given up though the density integrates to 1
inline constexpr double integral = 1e-3;          ///< error of the density's integral
inline constexpr double mean_weight = 1e-3;       ///< error of the weights' mean
inline constexpr double quadrature_error = 0.02;  ///< error of a cell's expected count over the count's deviation
}  // namespace limits

struct PValue {
    std::string test;
    double p;
};

struct CaseResult {
    std::string name;
    std::vector<PValue> p_values;
    std::vector<std::string> failures;  ///< failures of the tests whose outcome is not a matter of chance
    double integral = 0, integral_error = 0;
    double mean_weight = 0;
    std::size_t evaluations = 0;  ///< number of evaluations of the density and of the weights' numerator
};

/// Draws `samples` and tests:
/// - the counts in 1024 cells of equal probability, and in 16, against the integrals of the density over them
///   (chi-square); the samples that were given up are one more cell;
/// - the mean weight against the integral of `value` (normal law), if there is one;
/// - that the two densities of a sample agree and are positive and finite, also at the ends of the random numbers'
///   ranges;
/// - the known integrals.
/// The cells come from a separate pilot sample, which also decides where the quadrature refines.
CaseResult run_case(const SamplerCase& test, std::uint64_t samples);

}  // namespace gib::test
