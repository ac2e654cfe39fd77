#include "experiments/metrics/student_t.h"

#include "common/core/math.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace gib {

namespace {

namespace policies = boost::math::policies;
/// Gives NaN where the distribution is not defined, as for values that are not finite.
using StudentT =
    boost::math::students_t_distribution<double, policies::policy<policies::domain_error<policies::ignore_error>>>;

}  // namespace

double student_t_tail(double t, double degrees) { return 2 * cdf(complement(StudentT(degrees), t)); }

double student_t_two_sided(double tail, double degrees) { return quantile(complement(StudentT(degrees), tail / 2)); }

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
    double sum = 0;
    for (const auto& term : terms) {
        if (std::isnan(term.variance)) return term.variance;
        if (term.variance == 0) continue;
        sum += sqr(student_t_two_sided(tail, term.degrees)) * term.variance;
    }
    return std::sqrt(sum);
}

}  // namespace gib
