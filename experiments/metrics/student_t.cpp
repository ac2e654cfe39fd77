#include "experiments/metrics/student_t.h"

#include "common/core/math.h"

#include <cmath>
#include <limits>

namespace gib {

namespace {

// The continued fraction of the incomplete beta function, DLMF 8.17.22, evaluated with the modified Lentz method. The
// fraction converges quickly for x < (a + 1) / (a + b + 2).
double beta_fraction(double a, double b, double x) {
    constexpr double tiny = 1e-300;
    const auto away_from_zero = [](double v) { return std::abs(v) < tiny ? tiny : v; };
    double c = 1, d = 1 / away_from_zero(1 - (a + b) * x / (a + 1)), f = d;
    for (int m = 1; m < 10000; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / away_from_zero(1 + even * d);
        c = away_from_zero(1 + even / c);
        f *= c * d;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / away_from_zero(1 + odd * d);
        c = away_from_zero(1 + odd / c);
        f *= c * d;
        if (std::abs(c * d - 1) < 1e-14) break;
    }
    return f;
}

// The regularised incomplete beta function I_x(a, b), DLMF 8.17.2.
double incomplete_beta(double a, double b, double x) {
    if (x <= 0) return 0;
    if (x >= 1) return 1;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
    return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

}  // namespace

// Source: Abramowitz and Stegun, 26.7.1 with 26.5.27.
double student_t_tail(double t, double degrees) {
    // Beyond 1e7 degrees of freedom the difference from the normal distribution is below the promised error, and
    // lgamma loses digits.
    if (degrees > 1e7) return std::erfc(t / std::sqrt(2.0));
    return incomplete_beta(degrees / 2, 0.5, degrees / (degrees + t * t));
}

double student_t_two_sided(double tail, double degrees) {
    double lo = 1e-12, hi = 1e12;
    for (int step = 0; step < 120; ++step) {
        const double middle = std::sqrt(lo * hi);  // the range spans many powers of ten
        (student_t_tail(middle, degrees) > tail ? lo : hi) = middle;
    }
    return std::sqrt(lo * hi);
}

SampleMean sample_mean(std::span<const double> values) {
    const auto n = static_cast<double>(values.size());
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    double mean = 0, scatter = 0;
    for (const double v : values)
        mean += v / n;
    if (!std::isfinite(mean)) return {unknown, {unknown, n - 1}};
    for (const double v : values)
        scatter += sqr(v - mean);
    return {mean, {n < 2 ? unknown : scatter / (n * (n - 1)), n - 1}};
}

double half_width(const std::vector<VarianceTerm>& terms, double tail) {
    double sum = 0, spread = 0;
    for (const auto& term : terms)
        sum += term.variance;
    if (sum == 0 || !std::isfinite(sum)) return sum;
    // Variances are divided by the sum before they are squared. The square of a variance is the eighth power of a
    // difference of images, which may leave the range of double.
    for (const auto& term : terms)
        spread += sqr(term.variance / sum) / term.degrees;
    const double degrees = spread > 0 ? 1 / spread : std::numeric_limits<double>::infinity();
    return std::sqrt(sum) * student_t_two_sided(tail, degrees);
}

}  // namespace gib
