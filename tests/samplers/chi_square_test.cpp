#include "tests/samplers/chi_square.h"

#include <gtest/gtest.h>
#include <cmath>

namespace gib::test::chi_square_test {
namespace {

// With 2 m degrees of freedom the chi-square tail is a sum of m Poisson probabilities; with one degree, it is the
// two-sided tail of the normal law.
TEST(ChiSquare, TailAgreesWithTheClosedFormsOfEvenAndSingleDegrees) {
    for (int m : {1, 2, 10, 512, 2000}) {
        for (double x : {0.1, 0.8, 1.0, 1.1, 2.0, 5.0}) {
            const double half = x * m;
            double sum = 0;
            for (int k = 0; k < m; ++k)
                sum += std::exp(k * std::log(half) - half - std::lgamma(k + 1.0));
            EXPECT_NEAR(chi_square_tail(2 * half, 2.0 * m), sum, 1e-10 * sum + 1e-12) << m << ' ' << x;
        }
    }
    for (double x : {0.01, 1.0, 3.841458820694124, 30.0, 300.0})
        EXPECT_NEAR(chi_square_tail(x, 1), std::erfc(std::sqrt(x / 2)), 1e-9 * std::erfc(std::sqrt(x / 2)) + 1e-14);
    EXPECT_EQ(chi_square_tail(0, 5), 1);
    EXPECT_NEAR(normal_two_sided_tail(1.959963984540054), 0.05, 1e-12);
}

TEST(ChiSquare, CellsThatExpectLittleArePooled) {
    const PearsonTest test = pearson_test({{12, 10}, {8, 10}, {1, 2}, {4, 2}, {2, 3}});
    EXPECT_EQ(test.degrees, 2);
    EXPECT_NEAR(test.statistic, 0.4 + 0.4 + 0.0, 1e-12);
    // The pool expects 3 and joins the smaller cell: (8 + 0 - 13)^2 / 13.
    EXPECT_NEAR(pearson_test({{22, 20}, {8, 10}, {0, 3}}).statistic, 0.2 + 25.0 / 13, 1e-12);
    EXPECT_EQ(pearson_test({{3, 3}}).p_value, 1);
}

TEST(Holm, StepsDownAndCountsWhatIsNotANumberAsRejected) {
    using Indices = std::vector<std::size_t>;
    // The thresholds are 0.05 / 4, 0.05 / 3, 0.05 / 2 and 0.05.
    EXPECT_EQ(holm_rejections({0.02, 0.001, 0.016, 0.9}, 0.05), (Indices{1, 2, 0}));
    EXPECT_EQ(holm_rejections({0.02, 0.013, 0.016, 0.9}, 0.05), Indices{});
    EXPECT_EQ(holm_rejections({0.5, std::nan("")}, 0.05), Indices{1});
    EXPECT_EQ(holm_rejections({}, 0.05), Indices{});
}

}  // namespace
}  // namespace gib::test::chi_square_test
