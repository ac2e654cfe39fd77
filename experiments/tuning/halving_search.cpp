#include "experiments/tuning/halving_search.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace gib {

namespace {

/// A setting is given up if it seems to take this many times as long as the best. A law of a short run is often wrong
/// by a factor of two.
constexpr double hopeless = 4;

}  // namespace

SearchOutcome search(const SearchSpace& space, double seconds, const MeasureTimes& measure) {
    std::vector<Setting> alive = space.cover(static_cast<int>(settings_per_axis * space.axes().size()));
    const double rounds = std::max(1.0, std::floor(std::log2(static_cast<double>(alive.size()))));
    std::map<Setting, int> measured;  // rounds that have measured a setting's time, less one
    double best_measured = std::numeric_limits<double>::infinity();
    SearchOutcome outcome;
    const double first_budget = seconds / (rounds * static_cast<double>(alive.size()));
    for (std::uint64_t round = 0; round == 0 || alive.size() > 1; ++round) {
        const double budget = std::min(std::exp2(round) * first_budget, 2 * best_measured);
        const auto times = measure(alive, round, budget);
        std::vector<Trial> trials;
        for (std::size_t i = 0; i < alive.size(); ++i) {
            if (times[i]) trials.push_back({alive[i], *times[i]});
            else outcome.is_cut = true;
        }
        for (Trial& trial : trials) {
            const auto before = std::ranges::find(outcome.trials, trial.setting, &Trial::setting);
            if (before == outcome.trials.end()) continue;
            if (trial.time.is_measured && before->time.is_measured) {
                const double weight = 1 / (1. + ++measured[trial.setting]);
                trial.time.seconds = std::pow(before->time.seconds, 1 - weight) * std::pow(trial.time.seconds, weight);
            }
            outcome.trials.erase(before);
        }
        std::ranges::stable_sort(trials, {}, [](const Trial& t) { return t.time.cost(); });
        alive.clear();
        for (const Trial& trial : trials) {
            if (trial.time.is_measured) best_measured = std::min(best_measured, trial.time.seconds);
            const bool is_hopeless = trial.time.cost() > hopeless * trials.front().time.cost();
            if (alive.size() < std::max<std::size_t>(1, trials.size() / 2) && !is_hopeless)
                alive.push_back(trial.setting);
        }
        outcome.trials.insert(outcome.trials.begin(), trials.begin(), trials.end());
    }
    return outcome;
}

}  // namespace gib
