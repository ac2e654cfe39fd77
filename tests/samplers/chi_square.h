#pragma once
// Tests of counts against expected counts, and of many hypotheses at once.

#include <cstddef>
#include <vector>

namespace gib::test {

/// P(X >= statistic) for a chi-square variable: the regularised incomplete gamma function Q(degrees / 2, statistic /
/// 2). Relative error below 1e-10 (absolute where it underflows). `degrees` > 0.
double chi_square_tail(double statistic, double degrees);

/// P(|Z| >= z) for a standard normal variable.
double normal_two_sided_tail(double z);

struct Cell {
    double observed, expected;
};

struct PearsonTest {
    double statistic, degrees, p_value;
};

/// Pearson's test of counts whose expectations sum to their number. Cells that expect fewer than 5 are pooled (Cochran
/// 1954); where the pool itself expects fewer, it joins the smallest of the others. With fewer than two cells left
/// there is nothing to test: p = 1.
PearsonTest pearson_test(const std::vector<Cell>& cells);

/// Holm's step-down correction (Holm 1979): the hypotheses to reject so that the probability of any wrong rejection is
/// at most `alpha`, whatever the dependence between the tests. Indices in the order of their p-values.
std::vector<std::size_t> holm_rejections(const std::vector<double>& p_values, double alpha);

}  // namespace gib::test
