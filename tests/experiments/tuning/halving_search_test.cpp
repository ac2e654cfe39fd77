// The search for the cheapest settings, with methods whose times are known in closed form.
#include "experiments/tuning/halving_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace gib::test::halving_search_test {
namespace {

using Values = std::map<std::string, double>;

/// The numbers that count.
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

/// Some axes of the photon mapper.
SearchSpace space_of(const std::set<std::string>& names, const std::vector<Variation>& variations = {}) {
    const MethodLabel base{"photon_mapper", {}};
    auto axes = tuning_axes(base, variations);
    std::erase_if(axes, [&](const TuningAxis& axis) { return !names.contains(axis.name); });
    return {base, axes};
}
SearchSpace bowl() { return space_of({"photons", "k"}); }

struct KnownTimes {
    double (*time)(const Values&) = time_of;
    SearchSpace space = bowl();
    double spent = 0;
    double besides = 0;  ///< seconds of each run besides its budget
    double end = 1e30;   ///< after which no run begins
    std::vector<std::vector<Setting>> rounds = {};
    std::vector<double> budgets = {};

    SearchOutcome search(double seconds, int most_steps = 8) {
        const SearchLimits limits{.seconds = seconds, .elapsed = [this] { return spent; }, .most_steps = most_steps};
        return gib::search(space, limits, [this](const auto& settings, double budget) {
            std::vector<std::optional<TimeEstimate>> times;
            budgets.push_back(budget);
            rounds.emplace_back();
            for (const Setting& setting : settings) {
                times.emplace_back();
                if (spent >= end) continue;
                rounds.back().push_back(setting);
                const double known = seconds_of(setting);
                times.back() = TimeEstimate{known, known <= budget};
                spent += budget + besides;
            }
            return times;
        });
    }
    double seconds_of(const Setting& setting) const { return time(values_of(space, setting)); }
};

TEST(HalvingSearch, FindsSettingsNearTheBest) {
    KnownTimes known;
    const auto trials = known.search(600).trials;
    EXPECT_LE(known.seconds_of(trials.front().setting), 1.1 * 2) << known.space.label(trials.front().setting).text();
    for (const auto& trial : trials)
        EXPECT_GE(known.seconds_of(trial.setting), 2) << "no setting is better than the optimum";
}

/// Twice as many photons, paths or rays gain 4 %, too little to be taken alone.
double time_of_small_gains(const Values& values) {
    double doublings = 0;
    for (const auto& [name, value] : values)
        doublings += std::log2(value);
    return std::exp(-0.04 * doublings);
}

TEST(HalvingSearch, SmallGainsAreTakenTogether) {
    // All settings of the cover but the defaults lie where the search begins.
    const std::string spans[] = {"photons=4e6..4.01e6", "direct_samples=4..4.01", "gather=64..64.1"};
    std::vector<Variation> variations;
    for (const auto& span : spans)
        variations.push_back(parse_variation(span));
    KnownTimes known{.time = time_of_small_gains,
                     .space = space_of({"photons", "direct_samples", "gather"}, variations)};
    const auto best = values_of(known.space, known.search(3000, 1).trials.front().setting);
    EXPECT_GT(best.at("photons"), 4e6);
    EXPECT_GT(best.at("direct_samples"), 4);
    EXPECT_GT(best.at("gather"), 64);
}

TEST(HalvingSearch, HalvesTheSettingsAndDoublesTheBudget) {
    KnownTimes known;
    known.search(60);
    ASSERT_GE(known.rounds.size(), 3u);
    EXPECT_EQ(known.rounds[0].size(), 13u) << "the defaults and six settings for each of two parameters";
    EXPECT_EQ(known.rounds[0].front(), known.space.defaults()) << "the defaults are among them";
    EXPECT_LE(known.rounds[1].size(), 7u);
    EXPECT_NEAR(known.budgets[1], 2 * known.budgets[0], 1e-9);
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

TEST(HalvingSearch, RepeatsNoRunThatWouldBeNoLonger) {
    KnownTimes known;
    known.search(6000);
    std::map<Setting, double> longest;
    for (std::size_t round = 0; round < known.rounds.size(); ++round)
        for (const Setting& setting : known.rounds[round]) {
            EXPECT_LT(longest[setting], known.budgets[round]) << known.space.label(setting).text();
            longest[setting] = known.budgets[round];
        }
}

TEST(HalvingSearch, CountsWhatRunsTakeBesidesTheirBudgets) {
    KnownTimes known{.besides = 3};
    const SearchOutcome outcome = known.search(120);
    EXPECT_TRUE(outcome.is_cut) << "13 runs take 39 s besides their budgets";
    EXPECT_NEAR(known.budgets[1], known.budgets[0], 1e-9) << "no time for a second round of 7 runs: the descent begins";
    EXPECT_LE(known.spent, 120);
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
    // Wherever time runs out, in the middle of a step too, the search ends.
    KnownTimes whole;
    whole.search(60);
    for (double end = 0.25; end < whole.spent; end += 0.25) {
        KnownTimes cut{.end = end};
        ASSERT_FALSE(cut.search(60).trials.empty()) << end;
    }
}

TEST(HalvingSearch, DropsWhatCannotWin) {
    std::vector<std::size_t> sizes;
    double spent = 0;
    search(bowl(), {.seconds = 60, .elapsed = [&] { return spent; }}, [&](const auto& settings, double budget) {
        std::vector<std::optional<TimeEstimate>> times(settings.size(), TimeEstimate{100, false});
        times.front()->seconds = 1;
        sizes.push_back(settings.size());
        spent += budget * static_cast<double>(settings.size());
        return times;
    });
    ASSERT_GE(sizes.size(), 2u);
    EXPECT_NE(sizes[1], 7u) << "all others seem to take 100 times as long";
}

TEST(HalvingSearch, MeasuresTheDefaultsAloneWithoutParameters) {
    const SearchSpace path({"path", {}}, {});
    int runs = 0;
    const auto outcome =
        search(path, {.seconds = 60, .elapsed = [] { return 0.0; }}, [&](const auto& settings, double) {
            runs += static_cast<int>(settings.size());
            return std::vector<std::optional<TimeEstimate>>(settings.size(), TimeEstimate{3, true});
        });
    EXPECT_EQ(runs, 1);
    ASSERT_EQ(outcome.trials.size(), 1u);
    EXPECT_EQ(outcome.trials.front().time.seconds, 3);
    EXPECT_FALSE(outcome.is_cut);
}

}  // namespace
}  // namespace gib::test::halving_search_test
