// The search for the cheapest settings, with methods whose times are known in closed form.
#include "experiments/tuning/halving_search.h"

#include "common/core/number_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace gib {
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

struct KnownTimes {
    double spent = 0;
    std::map<int, std::vector<std::string>> rounds = {};
    std::map<int, double> budgets = {};

    std::vector<Trial> search_photon_mapper(double seconds) {
        const MethodLabel base{"photon_mapper", {}};
        return search(base, tuning_axes(base, {}), {.seconds = seconds},
                      [this](const auto& labels, double budget, int round) {
                          std::vector<TimeEstimate> times;
                          for (const auto& label : labels) {
                              rounds[round].push_back(label.text());
                              times.push_back({time_of(label), time_of(label) <= budget});
                          }
                          spent += budget * static_cast<double>(labels.size());
                          budgets[round] = budget;
                          return times;
                      });
    }
};

TEST(HalvingSearch, FindsSettingsNearTheBest) {
    KnownTimes known;
    const auto trials = known.search_photon_mapper(600);
    EXPECT_LE(time_of(trials.front().label), 1.1 * 2) << trials.front().label.text();
    for (const auto& trial : trials)
        EXPECT_GE(time_of(trial.label), 2) << "no setting is better than the optimum";
}

TEST(HalvingSearch, HalvesTheSettingsAndDoublesTheBudget) {
    KnownTimes known;
    known.search_photon_mapper(60);
    ASSERT_GE(known.rounds.size(), 3u);
    EXPECT_EQ(known.rounds[0].size(), 13u) << "the defaults and six settings for each of two parameters";
    EXPECT_EQ(known.rounds[0].front(), "photon_mapper") << "the defaults are among them";
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
        EXPECT_LE(known.budgets[static_cast<int>(round)], 2 * time_of({"photon_mapper", {}}));
}

TEST(HalvingSearch, DropsWhatCannotWin) {
    const MethodLabel base{"photon_mapper", {}};
    std::size_t second = 0;
    search(base, tuning_axes(base, {}), {.seconds = 60}, [&](const auto& labels, double, int round) {
        std::vector<TimeEstimate> times(labels.size(), TimeEstimate{100, false});
        times.front().seconds = 1;
        if (round == 1) second = labels.size();
        return times;
    });
    EXPECT_NE(second, 7u) << "all others seem to take 100 times as long";
}

TEST(HalvingSearch, HasNothingToDoWithoutParameters) {
    const MethodLabel base{"path", {}};
    const auto trials = search(base, tuning_axes(base, {}), {}, [](const auto&, double, int) {
        ADD_FAILURE() << "nothing varies";
        return std::vector<TimeEstimate>();
    });
    ASSERT_EQ(trials.size(), 1u);
    EXPECT_EQ(trials.front().label.text(), "path");
}

}  // namespace
}  // namespace gib
