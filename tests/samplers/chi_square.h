#pragma once
// The test of counts against expected counts, and the correction for many hypotheses at once.

#include <cstddef>
#include <vector>

namespace gib::test {

/// P(X >= statistic) for a chi-square variable X: the regularised incomplete gamma function Q(degrees / 2, statistic
/// / 2). The relative error is below 1e-10 (absolute where the result underflows). `degrees` > 0.
double chi_square_tail(double statistic, double degrees);

/// P(|Z| >= z) for a standard normal variable.
double normal_two_sided_tail(double z);

struct Cell {
    double observed, expected;
};

struct PearsonTest {
    double statistic, degrees, p_value;
};

/// Pearson's test of counts whose expectations sum to their number. Cells that expect fewer than 5 are pooled
/// (Cochran 1954); a pool that expects fewer than 5 itself joins the smallest of the other cells. If fewer than two
/// cells are left, there is nothing to test and p = 1.
PearsonTest pearson_test(const std::vector<Cell>& cells);

/// Holm's step-down correction (Holm 1979): the hypotheses to reject so that the probability of any wrong rejection
/// is at most `alpha`, whatever the dependence between the tests. Returns indices in the order of their p-values.
std::vector<std::size_t> holm_rejections(const std::vector<double>& p_values, double alpha);

}  // namespace gib::test
