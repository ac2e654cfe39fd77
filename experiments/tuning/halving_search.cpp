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
    Search(const MeasureTimes& measure, double seconds) : measure_(measure), seconds_(seconds) {}

    std::vector<Trial> trials(const std::vector<MethodLabel>& labels, double budget) {
        const double limited = std::min(budget, 2 * best_measured_);
        const auto times = measure_(labels, limited, round_++);
        std::vector<Trial> result;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            result.push_back({labels[i], times[i]});
            if (times[i].is_measured) best_measured_ = std::min(best_measured_, times[i].seconds);
            forget(labels[i]);
        }
        std::stable_sort(result.begin(), result.end(),
                         [](const Trial& a, const Trial& b) { return a.time.seconds < b.time.seconds; });
        done_.insert(done_.begin(), result.begin(), result.end());
        spent_ += limited * static_cast<double>(labels.size());
        return result;
    }
    bool has_time_for(double budget) const { return spent_ + budget <= seconds_; }
    bool is_known(const MethodLabel& label) const {
        return std::any_of(done_.begin(), done_.end(), [&](const Trial& t) { return t.label.text() == label.text(); });
    }
    const std::vector<Trial>& done() const { return done_; }

private:
    void forget(const MethodLabel& label) {
        std::erase_if(done_, [&](const Trial& t) { return t.label.text() == label.text(); });
    }

    const MeasureTimes& measure_;
    double seconds_, spent_ = 0;
    double best_measured_ = std::numeric_limits<double>::infinity();
    int round_ = 0;
    std::vector<Trial> done_;
};

/// The labels that go on: the better half without those that cannot win.
std::vector<MethodLabel> better_half(const std::vector<Trial>& trials) {
    std::vector<MethodLabel> labels;
    for (std::size_t i = 0; i < (trials.size() + 1) / 2; ++i)
        if (i == 0 || trials[i].time.seconds <= hopeless * trials.front().time.seconds)
            labels.push_back(trials[i].label);
    return labels;
}

}  // namespace

std::vector<Trial> search(const MethodLabel& base, const std::vector<TuningAxis>& axes, const SearchSettings& settings,
                          const MeasureTimes& measure) {
    if (axes.empty()) return {{base, {}}};
    std::vector<MethodLabel> alive = candidates(base, axes, settings.labels_per_axis * static_cast<int>(axes.size()));
    const double rounds = std::ceil(std::log2(static_cast<double>(alive.size()))) + 1;
    double budget = halving_share * settings.seconds / (rounds * static_cast<double>(alive.size()));
    Search state(measure, settings.seconds);
    Trial best;
    while (true) {
        const auto trials = state.trials(alive, budget);
        best = trials.front();
        alive = better_half(trials);
        if (alive.size() < 2) break;
        budget *= 2;
    }
    for (int step = 0; step < settings.most_steps; ++step) {
        std::vector<MethodLabel> around = {best.label};
        for (const auto& label : neighbours(best.label, axes))
            if (!state.is_known(label)) around.push_back(label);
        if (around.size() < 2 || !state.has_time_for(budget * static_cast<double>(around.size()))) break;
        // The best label runs again beside its neighbours: all of them have the same seed and the same budget.
        const auto trials = state.trials(around, budget);
        const auto again = std::find_if(trials.begin(), trials.end(),
                                        [&](const Trial& t) { return t.label.text() == best.label.text(); });
        const bool is_better = trials.front().time.seconds < least_gain * again->time.seconds;
        best = is_better ? trials.front() : *again;
        if (!is_better) break;
    }
    std::vector<Trial> sorted = state.done();
    std::stable_partition(sorted.begin(), sorted.end(),
                          [&](const Trial& t) { return t.label.text() == best.label.text(); });
    return sorted;
}

}  // namespace gib
