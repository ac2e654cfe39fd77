// The search for the cheapest settings, with methods whose times are known in closed form.
#include "experiments/tuning/halving_search.h"

#include "common/core/number_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

namespace gib::test::halving_search_test {
namespace {

double value_of(const MethodLabel& label, const std::string& name, double initial) {
    for (const auto& [key, value] : label.values)
        if (key == name) return number_from<double>(value).value();
    return initial;
}

/// A bowl in the logarithms around photons = 1.3e5 and k = 200, where the target takes 2 s.
double time_of(const MethodLabel& label) {
    const double photons = std::log2(value_of(label, "photons", 1e6) / 1.3e5);
    const double k = std::log2(value_of(label, "k", 50) / 200);
    return 2 * std::exp(0.1 * photons * photons + 0.2 * k * k + 0.05 * photons * k);
}

MethodLabel base() { return {"photon_mapper", {}}; }
std::vector<TuningAxis> axes_named(const std::set<std::string>& names) {
    auto all = tuning_axes(base(), {});
    std::erase_if(all, [&](const TuningAxis& axis) { return !names.contains(axis.name); });
    return all;
}
/// Only photons and k vary.
std::vector<TuningAxis> axes() { return axes_named({"photons", "k"}); }

/// The axes as they are if all candidates but the defaults have these values.
std::vector<TuningAxis> axes_at(const std::map<std::string, double>& values) {
    std::set<std::string> names;
    for (const auto& [name, value] : values)
        names.insert(name);
    auto axes = axes_named(names);
    for (TuningAxis& axis : axes) {
        axis.span = {values.at(axis.name), 1.01 * values.at(axis.name), axis.span.is_logarithmic};
        axis.has_default_apart = false;
    }
    return axes;
}

/// The best label after one step of a search in which every run reaches its target after `seconds`.
MethodLabel best_after_one_step(const std::vector<TuningAxis>& axes, double (*seconds)(const MethodLabel&)) {
    const auto measure = [&](const auto& labels, double, int) {
        std::vector<std::optional<TimeEstimate>> times;
        for (const auto& label : labels)
            times.emplace_back(TimeEstimate{seconds(label), true});
        return times;
    };
    return search(base(), axes, {.seconds = 3000, .most_steps = 1}, measure).trials.front().label;
}

struct KnownTimes {
    double spent = 0;
    double besides = 0;  ///< seconds of each run besides its budget
    double end = 1e30;   ///< after which no run begins
    std::map<int, std::vector<std::string>> rounds = {};
    std::map<int, double> budgets = {};

    SearchOutcome search_photon_mapper(double seconds) {
        SearchSettings settings{.seconds = seconds};
        settings.elapsed = [this] { return spent; };
        return search(base(), axes(), settings, [this](const auto& labels, double budget, int round) {
            std::vector<std::optional<TimeEstimate>> times;
            budgets[round] = budget;
            for (const auto& label : labels) {
                times.emplace_back();
                if (spent >= end) continue;
                rounds[round].push_back(label.text());
                times.back() = TimeEstimate{time_of(label), time_of(label) <= budget};
                spent += budget + besides;
            }
            return times;
        });
    }
};

TEST(HalvingSearch, FindsSettingsNearTheBest) {
    KnownTimes known;
    const auto trials = known.search_photon_mapper(600).trials;
    EXPECT_LE(time_of(trials.front().label), 1.1 * 2) << trials.front().label.text();
    for (const auto& trial : trials)
        EXPECT_GE(time_of(trial.label), 2) << "no setting is better than the optimum";
}

/// A narrow valley along k = 10 direct_samples, which falls towards few of both.
double time_in_valley(const MethodLabel& label) {
    const double k = std::log2(value_of(label, "k", 50)), paths = std::log2(value_of(label, "direct_samples", 1));
    const double across = k - paths - std::log2(10.), along = k + paths;
    return std::exp(std::abs(across) + 0.1 * along);
}

// In a valley every single change loses; from its upper end, where all candidates but the defaults lie, which are worse, only
// two changes together lead down. There is one step, which is repeated.
TEST(HalvingSearch, FollowsAValleyInWhichTwoNumbersChangeTogether) {
    const MethodLabel upper = MethodLabel::parse("photon_mapper k=6400 direct_samples=640");
    const MethodLabel best = best_after_one_step(axes_at({{"k", 6400}, {"direct_samples", 640}}), time_in_valley);
    EXPECT_LT(time_in_valley(best), 0.3 * time_in_valley(upper)) << best.text();
}

/// Twice as many photons, paths or rays gain 4 %, too little to be taken alone.
double time_of_small_gains(const MethodLabel& label) {
    double doublings = 0;
    for (const auto& [name, initial] :
         std::map<std::string, double>{{"photons", 1e6}, {"direct_samples", 1}, {"gather", 1}})
        doublings += std::log2(value_of(label, name, initial));
    return std::exp(-0.04 * doublings);
}

TEST(HalvingSearch, SmallGainsAreTakenTogether) {
    const std::map<std::string, double> start = {{"photons", 4e6}, {"direct_samples", 4}, {"gather", 64}};
    const MethodLabel best = best_after_one_step(axes_at(start), time_of_small_gains);
    for (const auto& [name, value] : start)
        EXPECT_GT(value_of(best, name, value), value) << name << " in " << best.text();
}

TEST(HalvingSearch, HalvesTheSettingsAndDoublesTheBudget) {
    KnownTimes known;
    known.search_photon_mapper(60);
    ASSERT_GE(known.rounds.size(), 3u);
    EXPECT_EQ(known.rounds[0].size(), 13u) << "the defaults and six settings for each of two parameters";
    EXPECT_EQ(known.rounds[0].front(), base().text()) << "the defaults are among them";
    EXPECT_LE(known.rounds[1].size(), 7u);
    EXPECT_NEAR(known.budgets[1], 2 * known.budgets[0], 1e-9);
}

TEST(HalvingSearch, StaysWithinItsTime) {
    for (const double seconds : {1.0, 60.0, 3000.0}) {
        KnownTimes known;
        known.search_photon_mapper(seconds);
        EXPECT_LE(known.spent, seconds) << seconds;
    }
}

TEST(HalvingSearch, RunsNoLongerThanTwiceTheBestTime) {
    KnownTimes known;
    known.search_photon_mapper(6000);
    for (std::size_t round = 1; round < known.budgets.size(); ++round)
        EXPECT_LE(known.budgets[static_cast<int>(round)], 2 * time_of(base()));
}

TEST(HalvingSearch, CountsWhatRunsTakeBesidesTheirBudgets) {
    KnownTimes known{.besides = 3};
    const SearchOutcome outcome = known.search_photon_mapper(120);
    EXPECT_TRUE(outcome.is_cut) << "13 runs take 39 s besides their budgets";
    EXPECT_NEAR(known.budgets[1], known.budgets[0], 1e-9) << "no time for a second round of 7 runs: the steps begin";
    EXPECT_LE(known.spent, 120);
}

TEST(HalvingSearch, EndsWhereNoTimeIsLeft) {
    KnownTimes known{.end = 5};
    const SearchOutcome outcome = known.search_photon_mapper(60);
    EXPECT_TRUE(outcome.is_cut);
    EXPECT_EQ(known.rounds.size(), 1u);
    EXPECT_EQ(outcome.trials.size(), known.rounds[0].size()) << "only what was measured";
    for (std::size_t i = 1; i < outcome.trials.size(); ++i)
        EXPECT_LE(time_of(outcome.trials.front().label), time_of(outcome.trials[i].label));
    KnownTimes none{.end = 0};
    const SearchOutcome nothing = none.search_photon_mapper(60);
    ASSERT_EQ(nothing.trials.size(), 1u);
    EXPECT_EQ(nothing.trials.front().label.text(), base().text());
    EXPECT_FALSE(KnownTimes().search_photon_mapper(6000).is_cut);
    // Wherever time runs out, in the middle of a step too, the search ends.
    KnownTimes whole;
    whole.search_photon_mapper(60);
    for (double end = 0.25; end < whole.spent; end += 0.25) {
        KnownTimes cut{.end = end};
        ASSERT_FALSE(cut.search_photon_mapper(60).trials.empty()) << end;
    }
}

TEST(HalvingSearch, DropsWhatCannotWin) {
    std::size_t second = 0;
    search(base(), axes(), {.seconds = 60}, [&](const auto& labels, double, int round) {
        std::vector<std::optional<TimeEstimate>> times(labels.size(), TimeEstimate{100, false});
        times.front()->seconds = 1;
        if (round == 1) second = labels.size();
        return times;
    });
    EXPECT_NE(second, 7u) << "all others seem to take 100 times as long";
}

TEST(HalvingSearch, HasNothingToDoWithoutParameters) {
    const MethodLabel path{"path", {}};
    const auto outcome = search(path, tuning_axes(path, {}), {}, [](const auto&, double, int) {
        ADD_FAILURE() << "nothing varies";
        return std::vector<std::optional<TimeEstimate>>();
    });
    ASSERT_EQ(outcome.trials.size(), 1u);
    EXPECT_EQ(outcome.trials.front().label.text(), "path");
    EXPECT_FALSE(outcome.is_cut);
}

}  // namespace
}  // namespace gib::test::halving_search_test
