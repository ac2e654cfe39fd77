// The search for the cheapest settings, with methods whose times are known in closed form.
#include "experiments/tuning/halving_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace gib::test::halving_search_test {
namespace {

using Values = std::map<std::string, double>;

/// The values that count, by name.
Values values_of(const SearchSpace& space, const Setting& setting) {
    Values values;
    for (std::size_t d = 0; d < space.axes().size(); ++d)
        values[space.axes()[d].name] = space.effective(setting, d).value();
    return values;
}

/// A bowl in the logarithms around photons = 1.3e5 and k = 200, where the target takes 2 s.
double time_of(const Values& values) {
    const double photons = std::log2(values.at("photons") / 1.3e5), k = std::log2(values.at("k") / 200);
    return 2 * std::exp(0.1 * photons * photons + 0.2 * k * k + 0.05 * photons * k);
}

SearchSpace bowl() {
    const MethodLabel base{"photon_mapper", {}};
    auto axes = tuning_axes(base, {});
    std::erase_if(axes, [](const TuningAxis& axis) { return axis.name != "photons" && axis.name != "k"; });
    return {base, axes};
}

struct KnownTimes {
    SearchSpace space = bowl();
    double spent = 0;
    double end = 1e30;  ///< after which no run begins
    std::vector<std::vector<Setting>> rounds = {};
    std::vector<double> budgets = {};

    SearchOutcome search(double seconds) {
        return gib::search(space, seconds, [this](const auto& settings, std::uint64_t round, double budget) {
            EXPECT_EQ(round, rounds.size()) << "the seed of each round is new";
            std::vector<std::optional<TimeEstimate>> times;
            budgets.push_back(budget);
            rounds.emplace_back();
            for (const Setting& setting : settings) {
                times.emplace_back();
                if (spent >= end) continue;
                rounds.back().push_back(setting);
                const double known = seconds_of(setting);
                times.back() = TimeEstimate{known, known <= budget};
                spent += budget;
            }
            return times;
        });
    }
    double seconds_of(const Setting& setting) const { return time_of(values_of(space, setting)); }
};

TEST(HalvingSearch, FindsTheBestOfTheCover) {
    KnownTimes known;
    const auto trials = known.search(600).trials;
    ASSERT_EQ(trials.size(), known.rounds[0].size());
    for (const auto& trial : trials)
        EXPECT_GE(known.seconds_of(trial.setting), known.seconds_of(trials.front().setting));
}

TEST(HalvingSearch, HalvesTheSettingsAndDoublesTheBudget) {
    KnownTimes known;
    known.search(60);
    ASSERT_GE(known.rounds.size(), 3u);
    EXPECT_EQ(known.rounds[0].size(), 21u) << "the defaults and ten settings for each of two parameters";
    EXPECT_EQ(known.rounds[0].front(), known.space.defaults()) << "the defaults are among them";
    EXPECT_LE(known.rounds[1].size(), 10u);
    EXPECT_NEAR(known.budgets[1], 2 * known.budgets[0], 1e-9);
}

// The time of a setting falls from round to round: 8 s, 4 s, 2 s, ...
TEST(HalvingSearch, TimesOfSeveralRoundsAreTheirMean) {
    const auto outcome = search(bowl(), 60, [](const auto& settings, std::uint64_t round, double) {
        return std::vector<std::optional<TimeEstimate>>(settings.size(), TimeEstimate{8 / std::exp2(round), true});
    });
    EXPECT_NEAR(outcome.trials.front().time.seconds, 8 / std::exp2(1.5), 1e-9) << "of rounds 0 to 3";
    EXPECT_NEAR(outcome.trials.back().time.seconds, 8, 1e-9);
}

TEST(HalvingSearch, StaysWithinItsTime) {
    for (const double seconds : {1.0, 60.0, 3000.0}) {
        KnownTimes known;
        known.search(seconds);
        EXPECT_LE(known.spent, seconds) << seconds;
    }
}

TEST(HalvingSearch, RunsNoLongerThanTwiceTheBestTime) {
    KnownTimes known;
    known.search(6000);
    for (std::size_t round = 1; round < known.budgets.size(); ++round)
        EXPECT_LE(known.budgets[round], 2 * known.seconds_of(known.space.defaults()));
}

TEST(HalvingSearch, EndsWhereNoTimeIsLeft) {
    KnownTimes known{.end = 5};
    const SearchOutcome outcome = known.search(60);
    EXPECT_TRUE(outcome.is_cut);
    ASSERT_FALSE(outcome.trials.empty());
    EXPECT_EQ(outcome.trials.size(), known.rounds[0].size()) << "only what was measured";
    for (std::size_t i = 1; i < outcome.trials.size(); ++i)
        EXPECT_LE(known.seconds_of(outcome.trials.front().setting), known.seconds_of(outcome.trials[i].setting));
    KnownTimes none{.end = 0};
    EXPECT_TRUE(none.search(60).trials.empty());
    EXPECT_FALSE(KnownTimes().search(6000).is_cut);
}

TEST(HalvingSearch, DropsWhatCannotWin) {
    std::vector<std::size_t> sizes;
    search(bowl(), 60, [&](const auto& settings, std::uint64_t, double) {
        std::vector<std::optional<TimeEstimate>> times(settings.size(), TimeEstimate{100, false});
        times.front()->seconds = 1;
        sizes.push_back(settings.size());
        return times;
    });
    EXPECT_EQ(sizes.size(), 1u) << "all others seem to take 100 times as long";
}

}  // namespace
}  // namespace gib::test::halving_search_test
