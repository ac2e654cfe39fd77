#include "experiments/tuning/halving_search.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// How many times longer than the best a setting may seem to take. A law of a short run is often wrong by a factor of two.
constexpr double hopeless = 4;
/// Share of the time for the halving; the rest is for the descent.
constexpr double halving_share = 0.6;
/// A step is taken for this share of the time or less, so that noise does not keep the descent moving.
constexpr double least_gain = 0.95;

class Search {
public:
    Search(const SearchSpace& space, const SearchLimits& limits, const MeasureTimes& measure)
        : space_(space), limits_(limits), measure_(measure) {}

    SearchOutcome run() {
        const auto settings = space_.cover(static_cast<int>(settings_per_axis * space_.axes().size()));
        const double rounds = std::ceil(std::log2(static_cast<double>(settings.size()))) + 1;
        budget_ = halving_share * limits_.seconds / (rounds * static_cast<double>(settings.size()));
        if (auto best = best_by_halving(settings)) {
            for (int step = 0; step < limits_.most_steps; ++step) {
                const auto next = step_from(*best);
                if (!next) break;
                best = repeated_while_it_gains(*best, *next);
            }
            std::stable_partition(done_.begin(), done_.end(),
                                  [&](const Trial& t) { return t.setting == best->setting; });
        }
        return {done_, is_cut_};
    }

private:
    double limited_budget() const { return std::min(budget_, 2 * best_measured_); }

    /// Whether so many runs end within this share of the search's time, each with the time besides its budget that runs
    /// have taken so far. If they do not, the search is cut.
    bool has_time_for(std::size_t runs, double share) {
        const double elapsed = limits_.elapsed();
        const double besides = runs_ > 0 ? std::max(0.0, elapsed - budgets_) / static_cast<double>(runs_) : 0;
        const double needed = static_cast<double>(runs) * (limited_budget() + besides);
        if (elapsed + needed > share * limits_.seconds) is_cut_ = true;
        return elapsed + needed <= share * limits_.seconds;
    }

    /// Measures settings and returns the trials, the best first, without those for which no time was left.
    std::vector<Trial> trials(const std::vector<Setting>& settings) {
        const double budget = limited_budget();
        const auto times = measure_(settings, budget);
        std::vector<Trial> result;
        for (std::size_t i = 0; i < settings.size(); ++i) {
            if (!times[i]) {
                is_cut_ = true;
                continue;
            }
            result.push_back({settings[i], *times[i]});
            if (times[i]->is_measured) best_measured_ = std::min(best_measured_, times[i]->seconds);
            std::erase_if(done_, [&](const Trial& t) { return t.setting == settings[i]; });
        }
        std::ranges::stable_sort(result, {}, [](const Trial& t) { return t.time.cost(); });
        done_.insert(done_.begin(), result.begin(), result.end());
        budgets_ += budget * static_cast<double>(result.size());
        runs_ += result.size();
        return result;
    }

    /// The same for those that are new; none if there is no time for all of them.
    std::vector<Trial> new_trials(std::vector<Setting> settings) {
        std::erase_if(settings, [&](const Setting& s) { return std::ranges::count(done_, s, &Trial::setting) > 0; });
        return settings.empty() || !has_time_for(settings.size(), 1) ? std::vector<Trial>() : trials(settings);
    }

    std::optional<Trial> best_by_halving(std::vector<Setting> alive) {
        std::optional<Trial> best;
        while (true) {
            const double budget = limited_budget();
            const auto round = trials(alive);
            if (round.empty()) return best;
            best = round.front();
            alive.clear();
            for (std::size_t i = 0; i < (round.size() + 1) / 2; ++i)
                if (i == 0 || round[i].time.cost() <= hopeless * best->time.cost()) alive.push_back(round[i].setting);
            budget_ *= 2;
            // Runs that last no longer than those before would say nothing new.
            if (alive.size() < 2 || limited_budget() <= budget || !has_time_for(alive.size(), halving_share)) break;
        }
        budget_ /= 2;  // that of the last round
        return best;
    }

    /// The best neighbour, or all changes together that gain; empty if no step gains enough.
    std::optional<Trial> step_from(const Trial& best) {
        auto better = new_trials(space_.neighbours(best.setting));
        std::erase_if(better, [&](const Trial& t) { return t.time.cost() >= best.time.cost(); });
        if (better.size() > 1) {
            std::vector<Setting> changes;
            for (const Trial& trial : better)
                changes.push_back(trial.setting);
            const auto all = new_trials({space_.with_all_changes(best.setting, changes)});
            if (!all.empty() && all.front().time.cost() < better.front().time.cost()) better.front() = all.front();
        }
        if (better.empty() || better.front().time.cost() > least_gain * best.time.cost()) return std::nullopt;
        return better.front();
    }

    /// Goes on for as long as the change from one setting to the next, made again, gains (the pattern move).
    Trial repeated_while_it_gains(Trial from, Trial to) {
        while (true) {
            const auto next = new_trials({space_.with_change_repeated(from.setting, to.setting)});
            if (next.empty() || next.front().time.cost() > least_gain * to.time.cost()) return to;
            from = to;
            to = next.front();
        }
    }

    const SearchSpace& space_;
    const SearchLimits& limits_;
    const MeasureTimes& measure_;
    double budget_ = 0, budgets_ = 0;  ///< seconds of a run, and of all so far
    std::size_t runs_ = 0;
    double best_measured_ = std::numeric_limits<double>::infinity();
    bool is_cut_ = false;
    std::vector<Trial> done_;
};

}  // namespace

SearchOutcome search(const SearchSpace& space, const SearchLimits& limits, const MeasureTimes& measure) {
    return Search(space, limits, measure).run();
}

}  // namespace gib
