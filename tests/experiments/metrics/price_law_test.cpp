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

using Kind = Extrapolation::Kind;

TEST(PriceLaw, TimesAreThoseOfTheLaw) {
    const PriceLaw noise = *fit_price_law(exact_runs({0, 4e-3, 1, 0}, 4), 0);
    // Half the error of the end, at 16 s, takes four times the time. The runs are equal, so that the interval has no
    // width but for the floor, which a curve over a factor of 64 can hide a little of.
    const auto time = noise.extrapolate(4e-3 / 16 / 4);
    ASSERT_TRUE(time && time->kind == Kind::time);
    EXPECT_NEAR(time->seconds, 64, 0.1);
    EXPECT_NEAR(time->interval->lo, 64, 0.5);
    EXPECT_GE(time->interval->hi, 63.9);
    EXPECT_LT(time->interval->hi, 70);
    const PriceLaw prepared = *fit_price_law(exact_runs({0, 4e-3, 1, 16}, 4), 16);
    EXPECT_NEAR(prepared.extrapolate(4e-3 / 16 / 4, true)->seconds, 16 + 64, 0.1);
    // The floor is above a quarter of the squared error of the end.
    EXPECT_EQ(fit_price_law(exact_runs({1e-3, 4e-3, 1, 0}, 4), 0)->extrapolate(3e-4)->kind, Kind::never);
    const ErrorLaw law{1e-4, 4e-3, 1, 2};
    EXPECT_NEAR(*law.seconds_to(law.error2(37)), 37, 1e-9);
    EXPECT_FALSE(law.seconds_to(1e-4).has_value());
}

// Without an interval there is no extrapolation.
TEST(PriceLaw, TwoRunsDoNotExtrapolate) {
    EXPECT_FALSE(fit_price_law(exact_runs({0, 4e-3, 1, 0}, 2), 0)->extrapolate(6e-5).has_value());
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
    EXPECT_GT(unresolved->floor.interval->hi, unresolved->floor.value);
    const auto time = unresolved->extrapolate(2.5e-5);
    ASSERT_TRUE(time.has_value());
    EXPECT_EQ(time->kind, Kind::at_least);
    const auto resolved = fit_price_law(exact_runs({1e-4, 4e-3, 1, 0}, 4), 0);
    EXPECT_EQ(resolved->extrapolate(2.5e-5)->kind, Kind::never);
    EXPECT_NEAR(resolved->extrapolate(1.4e-4)->seconds, 100, 0.5);
    EXPECT_EQ(resolved->extrapolate(1.4e-4)->kind, Kind::time);
}

// The fitted floor of each curve is 0. That is no knowledge: floors up to a third of the last error fit nearly as well.
TEST(PriceLaw, AFittedFloorOfZeroHasAnUpperEnd) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    Runs runs;
    for (int s = 0; s < 5; ++s) {
        runs.emplace_back();
        for (const double t : checkpoint_times(0, 0.25, 16))
            runs.back().push_back({t, 4e-3 / std::pow(t, 1.2) * (1 + 0.02 * normal(random))});
    }
    const PriceLaw price = *fit_price_law(runs, 0);
    ASSERT_LT(price.floor.value, 0.1 * 4e-3 / std::pow(4, 1.2));
    EXPECT_GT(price.floor.interval->hi, 0.02 * 4e-3 / std::pow(4, 1.2));
    EXPECT_EQ(price.extrapolate(1e-6)->kind, Kind::at_least);
}

// An error that falls faster than the steepest law has no slope, and no time is computed from it.
TEST(PriceLaw, ASlopeAtTheEndOfItsRangeHasNoInterval) {
    Runs runs;
    for (const double own : {0.97, 0.99, 1.01, 1.03}) {
        runs.emplace_back();
        for (const double t : checkpoint_times(0, 0.25, 16))
            runs.back().push_back({t, own * std::exp(-8 * t)});
    }
    const PriceLaw price = *fit_price_law(runs, 0);
    ASSERT_NEAR(price.slope.value, 4, 0.05);
    EXPECT_FALSE(price.slope.interval.has_value());
    EXPECT_FALSE(price.extrapolate(1e-30).has_value());
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
    EXPECT_EQ(bent.extrapolate(1e-6)->kind, Kind::at_least);
    const PriceLaw floored = price_of(2e-5);
    EXPECT_GT(floored.floor.interval->lo, 0);
    EXPECT_EQ(floored.extrapolate(1e-6)->kind, Kind::never);
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
