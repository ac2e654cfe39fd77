#include "tests/samplers/chi_square.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gib::test {

namespace {

constexpr double precision = 1e-14;
constexpr int max_terms = 100000;

// The regularised lower incomplete gamma function by its series (DLMF 8.11.4), whose terms are all positive.
double lower_gamma_series(double a, double x, double front) {
    double term = 1 / a, sum = term;
    for (int k = 1; k < max_terms && term > precision * sum; ++k)
        sum += term *= x / (a + k);
    return front * sum;
}

// The regularised upper incomplete gamma function by its continued fraction (DLMF 8.9.2 in its even form), evaluated
// with the modified Lentz method.
double upper_gamma_fraction(double a, double x, double front) {
    constexpr double tiny = 1e-300;
    double b = x + 1 - a, c = 1 / tiny, d = 1 / b, f = d;
    for (int k = 1; k < max_terms; ++k) {
        const double numerator = -k * (k - a);
        b += 2;
        d = 1 / (numerator * d + b);
        c = b + numerator / c;
        f *= c * d;
        if (std::abs(c * d - 1) < precision) break;
    }
    return front * f;
}

}  // namespace

double chi_square_tail(double statistic, double degrees) {
    const double a = degrees / 2, x = statistic / 2;
    if (!(x > 0)) return 1;
    if (std::isinf(x)) return 0;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    // The series converges quickly below a + 1, the fraction above it; neither subtracts nearly equal numbers there.
    return x < a + 1 ? 1 - lower_gamma_series(a, x, front) : upper_gamma_fraction(a, x, front);
}

double normal_two_sided_tail(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

PearsonTest pearson_test(const std::vector<Cell>& cells) {
    constexpr double least = 5;
    std::vector<Cell> kept;
    Cell pool{0, 0};
    for (const Cell& cell : cells) {
        if (cell.expected >= least) {
            kept.push_back(cell);
        } else {
            pool.observed += cell.observed;
            pool.expected += cell.expected;
        }
    }
    if (pool.expected >= least || kept.empty()) {
        kept.push_back(pool);
    } else {
        auto& smallest = *std::min_element(kept.begin(), kept.end(),
                                           [](const Cell& a, const Cell& b) { return a.expected < b.expected; });
        smallest.observed += pool.observed;
        smallest.expected += pool.expected;
    }
    if (kept.size() < 2) return {0, 0, 1};
    double statistic = 0;
    for (const Cell& cell : kept) {
        const double difference = cell.observed - cell.expected;
        statistic += difference * difference / cell.expected;
    }
    const double degrees = static_cast<double>(kept.size()) - 1;
    return {statistic, degrees, chi_square_tail(statistic, degrees)};
}

std::vector<std::size_t> holm_rejections(const std::vector<double>& p_values, double alpha) {
    // NaN is no evidence for the hypothesis, so it counts as p = 0.
    const auto p = [&](std::size_t i) { return std::isnan(p_values[i]) ? 0.0 : p_values[i]; };
    std::vector<std::size_t> order(p_values.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p(a) < p(b); });
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (p(order[k]) > alpha / static_cast<double>(order.size() - k)) {
            order.resize(k);
            break;
        }
    }
    return order;
}

}  // namespace gib::test
