#include "experiments/tuning/halving_search.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// Share of the time for the halving; the rest is for the steps to better neighbours.
constexpr double halving_share = 0.6;
/// A step is taken for this share of the time or less, so that noise does not keep the descent moving.
constexpr double least_gain = 0.95;

class Search {
public:
    Search(const MeasureTimes& measure, const SearchSettings& settings) : measure_(measure), settings_(settings) {}

    /// Measures labels and returns the trials, the best first, without those for which no time was left.
    std::vector<Trial> trials(const std::vector<MethodLabel>& labels, double budget) {
        const double limited = limited_budget(budget);
        const auto times = measure_(labels, limited, round_++);
        std::vector<Trial> result;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            if (!times[i]) {
                is_out_of_time_ = true;
                continue;
            }
            result.push_back({labels[i], *times[i]});
            if (times[i]->is_measured) best_measured_ = std::min(best_measured_, times[i]->seconds);
            forget(labels[i]);
        }
        std::stable_sort(result.begin(), result.end(),
                         [](const Trial& a, const Trial& b) { return a.time.cost() < b.time.cost(); });
        done_.insert(done_.begin(), result.begin(), result.end());
        budgets_ += limited * static_cast<double>(result.size());
        runs_ += result.size();
        return result;
    }
    /// Whether so many runs end within this share of the search's time, each with the time besides its budget that runs
    /// have taken so far. If they do not, the search is cut, but shorter rounds may follow.
    bool has_time_for(std::size_t runs, double budget, double share) {
        const double elapsed = settings_.elapsed ? settings_.elapsed() : budgets_;
        const double besides = runs_ > 0 ? std::max(0.0, elapsed - budgets_) / static_cast<double>(runs_) : 0;
        const double needed = static_cast<double>(runs) * (limited_budget(budget) + besides);
        const bool has_time = !is_out_of_time_ && elapsed + needed <= share * settings_.seconds;
        is_cut_ = is_cut_ || !has_time;
        return has_time;
    }
    bool is_known(const MethodLabel& label) const {
        return std::any_of(done_.begin(), done_.end(), [&](const Trial& t) { return t.label.text() == label.text(); });
    }
    const std::vector<Trial>& done() const { return done_; }
    bool is_cut() const { return is_cut_ || is_out_of_time_; }

private:
    double limited_budget(double budget) const { return std::min(budget, 2 * best_measured_); }
    void forget(const MethodLabel& label) {
        std::erase_if(done_, [&](const Trial& t) { return t.label.text() == label.text(); });
    }

    const MeasureTimes& measure_;
    const SearchSettings& settings_;
    double budgets_ = 0;
    std::size_t runs_ = 0;
    double best_measured_ = std::numeric_limits<double>::infinity();
    int round_ = 0;
    bool is_cut_ = false, is_out_of_time_ = false;
    std::vector<Trial> done_;
};

/// The labels that go on: the better half without those that cannot win.
std::vector<MethodLabel> better_half(const std::vector<Trial>& trials) {
    std::vector<MethodLabel> labels;
    for (std::size_t i = 0; i < (trials.size() + 1) / 2; ++i)
        if (i == 0 || trials[i].time.cost() <= hopeless * trials.front().time.cost()) labels.push_back(trials[i].label);
    return labels;
}

/// The best label of successive halving.
MethodLabel best_by_halving(Search& state, std::vector<MethodLabel> alive, double& budget) {
    MethodLabel best = alive.front();
    while (true) {
        const auto trials = state.trials(alive, budget);
        if (trials.empty()) return best;
        best = trials.front().label;
        alive = better_half(trials);
        if (alive.size() < 2 || !state.has_time_for(alive.size(), 2 * budget, halving_share)) return best;
        budget *= 2;
    }
}

/// Trials with the same seed and the same budget, the best first: one of the best label so far, and others.
struct Comparison {
    std::vector<Trial> trials;
    double best_cost;  ///< cost of the best label so far
};

/// Compares `best` with those of `labels` that are new. Empty if none is new, if there is no time for all of them, or if
/// there was time for `best` or for the others only.
std::optional<Comparison> beside(Search& state, const MethodLabel& best, const std::vector<MethodLabel>& labels,
                                 double budget) {
    std::vector<MethodLabel> around = {best};
    for (const auto& label : labels)
        if (!state.is_known(label)) around.push_back(label);
    if (around.size() < 2 || !state.has_time_for(around.size(), budget, 1)) return std::nullopt;
    auto trials = state.trials(around, budget);
    const auto own =
        std::find_if(trials.begin(), trials.end(), [&](const Trial& t) { return t.label.text() == best.text(); });
    if (own == trials.end() || trials.size() < 2) return std::nullopt;
    const double best_cost = own->time.cost();
    return Comparison{std::move(trials), best_cost};
}

/// The labels that take less than `share` of the cost of the best one so far, the best first.
std::vector<MethodLabel> gaining(const std::optional<Comparison>& comparison, double share = least_gain) {
    std::vector<MethodLabel> labels;
    if (comparison)
        for (const Trial& trial : comparison->trials)
            if (trial.time.cost() < share * comparison->best_cost) labels.push_back(trial.label);
    return labels;
}

/// The better one of the best label and its neighbours, after one step; empty if no step gains. The step may take all changes
/// together that gain anything, so that several small gains make one that is taken. Where nothing gains, two changes may gain
/// together; these are looked for around the change that loses least.
std::optional<MethodLabel> step_from(Search& state, const MethodLabel& best, const std::vector<TuningAxis>& axes,
                                     double budget) {
    const auto comparison = beside(state, best, neighbours(best, axes), budget);
    if (!comparison) return std::nullopt;
    const auto better = gaining(comparison), slightly_better = gaining(comparison, 1);
    const MethodLabel all = with_all_changes(best, slightly_better, axes);
    if (better.empty()) {
        if (slightly_better.size() > 1 && !gaining(beside(state, best, {all}, budget)).empty()) return all;
        const auto& trials = comparison->trials;
        const MethodLabel& least_loss = trials[trials.front().label.text() == best.text() ? 1 : 0].label;
        const auto pairs = gaining(beside(state, best, neighbours(least_loss, axes), budget));
        return pairs.empty() ? std::nullopt : std::optional(pairs.front());
    }
    if (state.is_known(all) || !state.has_time_for(2, budget, 1)) return better.front();
    const auto both = state.trials({better.front(), all}, budget);
    return both.empty() ? better.front() : both.front().label;
}

/// Goes on as far as the change from one label to the next, made again, gains (Hooke and Jeeves 1961, the pattern move).
MethodLabel repeated_while_it_gains(Search& state, MethodLabel from, MethodLabel to,
                                    const std::vector<TuningAxis>& axes, double budget) {
    while (true) {
        const MethodLabel next = with_change_repeated(from, to, axes);
        const auto better = gaining(beside(state, to, {next}, budget));
        if (better.empty()) return to;
        from = to;
        to = next;
    }
}

}  // namespace

SearchOutcome search(const MethodLabel& base, const std::vector<TuningAxis>& axes, const SearchSettings& settings,
                     const MeasureTimes& measure) {
    if (axes.empty()) return {{{base, {}}}};
    const auto labels = candidates(base, axes, settings.labels_per_axis * static_cast<int>(axes.size()));
    const double rounds = std::ceil(std::log2(static_cast<double>(labels.size()))) + 1;
    double budget = halving_share * settings.seconds / (rounds * static_cast<double>(labels.size()));
    Search state(measure, settings);
    MethodLabel best = best_by_halving(state, labels, budget);
    for (int step = 0; step < settings.most_steps; ++step) {
        const auto next = step_from(state, best, axes, budget);
        if (!next) break;
        best = repeated_while_it_gains(state, best, *next, axes, budget);
    }
    SearchOutcome outcome{state.done(), state.is_cut()};
    if (outcome.trials.empty()) outcome.trials.push_back({base, {}});
    std::stable_partition(outcome.trials.begin(), outcome.trials.end(),
                          [&](const Trial& t) { return t.label.text() == best.text(); });
    return outcome;
}

}  // namespace gib
