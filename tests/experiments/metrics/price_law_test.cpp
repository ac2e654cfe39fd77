// The law error^2 = floor + factor (t - start)^-slope: a fit finds it in exact curves,
// and gives honest intervals for noisy ones.

#include "experiments/metrics/price_law.h"

#include "common/core/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gib::test::price_law_test {
namespace {

using Runs = std::vector<std::vector<ErrorPoint>>;

/// Checkpoints after 1, 2, 3, 4, 6, 8, 12, ... passes.
std::vector<double> checkpoint_times(double start, double pass_seconds, int last) {
    std::vector<double> times;
    for (int power = 1; power <= last; power *= 2) {
        times.push_back(start + power * pass_seconds);
        if (power >= 2 && 3 * power / 2 <= last) times.push_back(start + 1.5 * power * pass_seconds);
    }
    return times;
}

Runs exact_runs(const ErrorLaw& law, int seeds) {
    std::vector<ErrorPoint> run;
    for (const double t : checkpoint_times(law.start, 0.25, 64))
        run.push_back({t, law.error2(t)});
    return Runs(static_cast<std::size_t>(seeds), run);
}

TEST(PriceLaw, GivesBackTheLawOfExactCurves) {
    for (const ErrorLaw& law : {ErrorLaw{0, 4e-3, 1, 0}, ErrorLaw{1e-4, 4e-3, 1, 2}, ErrorLaw{2e-3, 1e-2, 1.4, 0.5},
                                ErrorLaw{0, 1e-2, 0.4, 0.1}}) {
        const auto price = fit_price_law(exact_runs(law, 4), law.start);
        ASSERT_TRUE(price.has_value());
        EXPECT_NEAR(price->slope.value, law.slope, 1e-4 * law.slope);
        EXPECT_NEAR(price->law.factor, law.factor, 1e-3 * law.factor);
        EXPECT_NEAR(price->floor.value, law.floor, 1e-3 * law.floor + 1e-7);
        EXPECT_LT(price->misfit, 1e-4);
        EXPECT_NEAR(price->last_seconds, law.start + 16, 1e-9);
        // Equal runs have no scatter, so the interval has no width.
        ASSERT_TRUE(price->slope.interval.has_value());
        EXPECT_NEAR(price->slope.interval->lo, price->slope.interval->hi, 1e-9);
    }
}

TEST(PriceLaw, NextHalvingIsWhenTheLawSaysSo) {
    // Pure noise of slope 1 without preparation needs four times the time. If half of the time at the end is a
    // preparation of 16 s, the factor is (16 + 4 * 16) / 32.
    EXPECT_NEAR(fit_price_law(exact_runs({0, 4e-3, 1, 0}, 1), 0)->next_halving.value().value, 4, 1e-3);
    EXPECT_NEAR(fit_price_law(exact_runs({0, 4e-3, 1, 16}, 1), 16)->next_halving.value().value, 2.5, 1e-3);
    // At 16 s the floor is above a quarter of the squared error, so the error never halves.
    EXPECT_FALSE(fit_price_law(exact_runs({1e-3, 4e-3, 1, 0}, 4), 0)->next_halving.has_value());
    const ErrorLaw law{1e-4, 4e-3, 1, 2};
    EXPECT_NEAR(*law.seconds_to(law.error2(37)), 37, 1e-9);
    EXPECT_FALSE(law.seconds_to(1e-4).has_value());
}

// The last points of four runs scatter by more than the floor that their mean seems to have. So "never" is not known,
// and a law without floor gives the least time. A floor that all runs have alike is believed.
TEST(PriceLaw, AFloorThatIsNotResolvedForbidsNothing) {
    Runs runs = exact_runs({0, 4e-3, 1, 0}, 4);
    for (std::size_t s = 0; s < 4; ++s)
        for (std::size_t i = 0; i < runs[s].size(); ++i)
            runs[s][i].error2 += (s < 3 ? 0.0 : 4e-4);
    const auto unresolved = fit_price_law(runs, 0);
    ASSERT_GT(unresolved->floor.value, 5e-5);
    ASSERT_EQ(unresolved->floor.interval->lo, 0);
    const auto time = unresolved->extrapolate(2.5e-5);
    ASSERT_TRUE(time.has_value());
    EXPECT_TRUE(time->at_least);
    EXPECT_GT(time->seconds, 160) << "the runs without floor";
    const auto resolved = fit_price_law(exact_runs({1e-4, 4e-3, 1, 0}, 4), 0);
    EXPECT_FALSE(resolved->extrapolate(2.5e-5).has_value());
    EXPECT_NEAR(resolved->extrapolate(1.4e-4)->seconds, 100, 0.5);
    EXPECT_FALSE(resolved->extrapolate(1.4e-4)->at_least);
}

TEST(PriceLaw, SaysNothingOfTooLittleOrOfErrorsThatDoNotFall) {
    EXPECT_FALSE(fit_price_law({}, 0).has_value());
    EXPECT_FALSE(fit_price_law({{{1, 1e-2}, {2, 5e-3}, {4, 2.5e-3}}}, 0).has_value()) << "three points, three unknowns";
    EXPECT_FALSE(fit_price_law({{{1, 1e-3}, {2, 1e-3}, {4, 1e-3}, {8, 1e-3}}}, 0).has_value()) << "a floor alone";
    // A value below the reference's resolution ends the curve.
    EXPECT_FALSE(fit_price_law({{{1, 1e-2}, {2, 5e-3}, {4, 2e-3}, {8, -1e-4}, {16, 1e-4}}}, 0).has_value());
    EXPECT_FALSE(fit_price_law({{{1, NAN}, {2, 5e-3}, {4, 2e-3}, {8, 1e-3}, {16, 1e-4}}}, 0).has_value());
    const auto two = fit_price_law(exact_runs({0, 4e-3, 1, 0}, 2), 0);
    EXPECT_FALSE(two->slope.interval.has_value()) << "two runs leave no scatter to speak of";
}

// The squared error of low-discrepancy points falls as t^-1.5 at first and as t^-1 at last. The
// fit takes the bend for a floor, but the end, which falls as noise does, disproves it. A floor
// that makes half of the final error is found.
TEST(PriceLaw, ABendTowardsTheSlopeOfNoiseIsNoFloor) {
    const auto price_of = [](double floor) {
        Runs runs;
        for (const double own : {0.97, 0.99, 1.01, 1.03}) {
            runs.emplace_back();
            for (const double t : checkpoint_times(0, 0.25, 1024))
                runs.back().push_back({t, own * (floor + 4e-3 / t + 2e-2 / std::pow(t, 1.5))});
        }
        return *fit_price_law(runs, 0);
    };
    const PriceLaw bent = price_of(0);
    ASSERT_GT(bent.floor.value, 0) << "what the fit takes it for";
    EXPECT_EQ(bent.floor.interval->lo, 0);
    ASSERT_TRUE(bent.extrapolate(1e-6).has_value());
    EXPECT_TRUE(bent.extrapolate(1e-6)->at_least);
    const PriceLaw floored = price_of(2e-5);
    EXPECT_GT(floored.floor.interval->lo, 0);
    EXPECT_FALSE(floored.extrapolate(1e-6).has_value());
}

/// Runs whose squared error has two parts: a fixed one, equal in all points of a run, with a
/// relative scatter of 10 %, and noise with a relative scatter of 5 %. The noise is summed up over
/// the passes, so the points of a run are correlated.
Runs noisy_runs(const ErrorLaw& law, int seeds, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    Runs runs;
    for (int s = 0; s < seeds; ++s) {
        runs.emplace_back();
        const double own = 1 + 0.1 * normal(random);
        double walk = 0, before = 0;
        for (const double t : checkpoint_times(law.start, 0.25, 256)) {
            walk += std::sqrt(t - law.start - before) * normal(random);
            before = t - law.start;
            const double noise = law.error2(t) - law.floor;
            runs.back().push_back({t, law.floor * own + noise * (1 + 0.05 * walk / std::sqrt(before))});
        }
    }
    return runs;
}

// Over 500 repetitions a proportion of 95 % has a standard error of 1 %. The bounds are those of the intervals of
// bias and variance, 92 to 98.5 %, widened by two standard errors.
TEST(PriceLaw, IntervalsContainTheTruth) {
    constexpr int repetitions = 500;
    for (const int seeds : {4, 8}) {
        const ErrorLaw law{4e-4, 8e-3, 1, 1};
        std::mt19937_64 random(static_cast<std::uint64_t>(seeds));
        int floors = 0, slopes = 0;
        for (int i = 0; i < repetitions; ++i) {
            const auto price = fit_price_law(noisy_runs(law, seeds, random), law.start);
            ASSERT_TRUE(price && price->floor.interval && price->slope.interval);
            floors += price->floor.interval->lo <= law.floor && law.floor <= price->floor.interval->hi;
            slopes += price->slope.interval->lo <= law.slope && law.slope <= price->slope.interval->hi;
        }
        for (const auto& [name, hits] : {std::pair{"floor", floors}, {"slope", slopes}}) {
            const double coverage = static_cast<double>(hits) / repetitions;
            RecordProperty(std::string(name) + "_" + std::to_string(seeds), std::to_string(coverage));
            EXPECT_GE(coverage, 0.92 - 0.024) << name << " seeds " << seeds;
            EXPECT_LE(coverage, 0.985 + 0.011) << name << " seeds " << seeds;
        }
    }
}

}  // namespace
}  // namespace gib::test::price_law_test
