// When the best method changes (comparison.h).
#include "experiments/analysis/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace gib {

namespace {

/// A change of the best method counts only if the new error is below this fraction of the old one.
constexpr double least_lead = 0.95;
/// Runs of one budget end with unlike passes, within this share of its time.
constexpr double well_before = 0.9;

/// The mean squared error of some runs as a function of time: infinite before all of them have an image, 0 unless it
/// is above the noise floor.
struct MeanCurve {
    Runs cells;
    double noise_floor;
    double operator()(double seconds) const {
        const auto errors2 = errors2_by(cells, Layer::total, seconds);
        if (errors2.empty()) return std::numeric_limits<double>::infinity();
        const double mean = sample_mean(errors2).value;
        return mean > noise_floor ? mean : 0;
    }
    MeanCurve without(std::size_t seed) const { return {gib::without(cells, seed), noise_floor}; }
};

/// The time at which `challenger` passes `best`, by bisection between a time at which it is behind and one at which
/// it is ahead.
double passing_time(const MeanCurve& best, const MeanCurve& challenger, double behind, double ahead) {
    for (int step = 0; step < 60; ++step) {
        const double middle = std::sqrt(behind * ahead);
        (challenger(middle) < best(middle) ? ahead : behind) = middle;
    }
    return ahead;
}

/// The time at which `challenger` passes `best`; if it does so between several pairs of successive `times`, the one
/// nearest to `near`.
std::optional<double> passing_near(const MeanCurve& best, const MeanCurve& challenger, const std::vector<double>& times,
                                   double near) {
    std::optional<double> nearest;
    for (std::size_t i = 1; i < times.size(); ++i) {
        if (challenger(times[i - 1]) < best(times[i - 1]) || !(challenger(times[i]) < best(times[i]))) continue;
        const double time = passing_time(best, challenger, times[i - 1], times[i]);
        if (!nearest || std::abs(std::log(time / near)) < std::abs(std::log(*nearest / near))) nearest = time;
    }
    return nearest;
}

std::optional<Interval> passing_interval(const MeanCurve& best, const MeanCurve& challenger,
                                         const std::vector<double>& times, double seconds) {
    const std::size_t seeds = std::min(best.cells.size(), challenger.cells.size());
    std::vector<double> logs;
    for (std::size_t s = 0; seeds > 2 && s < seeds; ++s) {
        const auto time = passing_near(best.without(s), challenger.without(s), times, seconds);
        if (!time) return std::nullopt;
        logs.push_back(std::log(*time));
    }
    if (logs.empty()) return std::nullopt;
    const Interval interval = *jackknife(std::log(seconds), logs).interval;
    // The first image of a method comes at one time, whatever seed is left out.
    if (!(interval.hi - interval.lo > 1e-9)) return std::nullopt;
    return Interval{std::exp(interval.lo), std::exp(interval.hi)};
}

/// The scan of one scene through the times of all checkpoints.
class Scan {
public:
    Scan(std::string scene, const Contest& contest) : scene_(std::move(scene)), contest_(contest) {
        std::set<double> times;
        for (const auto& [method, cells] : contest.cells())
            for (const Cell* cell : cells)
                for (const auto& c : cell->checkpoints)
                    times.insert(c.checkpoint.seconds);
        times_.assign(times.begin(), times.end());
    }

    std::vector<Crossover> changes() {
        for (std::size_t i = 0; i < times_.size(); ++i) {
            const auto ranking = contest_.after(times_[i]);
            const Contender* best = best_of(ranking);
            if (!best) continue;
            if (changes_.empty()) add_change({.scene = scene_, .method = best->method, .seconds = times_[i]});
            const Contender& reigning = of_method(ranking, changes_.back().method);
            if (reigning.known != Contender::Known::equal && reigning.standing != Standing::behind) {
                end_reign(reigning.ended);
                changes_.push_back({.scene = scene_,
                                    .method = "",
                                    .before = reigning.method,
                                    .seconds = reigning.ended,
                                    .ends = true});
                return std::move(changes_);
            }
            if (best->method != reigning.method && is_passed(reigning, *best, i)) pass(*best, i);
            compare_rivals(ranking);
        }
        if (!changes_.empty()) end_reign(times_.back());
        return std::move(changes_);
    }

private:
    MeanCurve curve(const std::string& method) const { return {contest_.cells().at(method), contest_.noise_floor()}; }
    bool is_passed(const Contender& reigning, const Contender& best, std::size_t i) const {
        if (reigning.known != Contender::Known::equal) return true;
        return std::sqrt(curve(best.method)(times_[i])) < least_lead * std::sqrt(curve(reigning.method)(times_[i]));
    }

    void pass(const Contender& best, std::size_t i) {
        const MeanCurve before = curve(changes_.back().method), after = curve(best.method);
        Crossover change{
            .scene = scene_, .method = best.method, .before = changes_.back().method, .seconds = times_[i]};
        // The new method may have been ahead for a while, but by less than a change needs.
        std::size_t behind = std::max<std::size_t>(i, 1) - 1;
        while (behind > 0 && times_[behind] > changes_.back().seconds && after(times_[behind]) < before(times_[behind]))
            --behind;
        if (after(times_[i]) < before(times_[i])) {
            change.seconds = passing_time(before, after, times_[behind], times_[i]);
            change.interval = passing_interval(before, after, times_, change.seconds);
        }
        end_reign(change.seconds);
        add_change(std::move(change));
    }

    void add_change(Crossover change) {
        change.relative_rmse = resolved({curve(change.method)(change.seconds), {}}, contest_.noise_floor());
        change.doubts.one_seed = contest_.cells().at(change.method).size() < 2;
        changes_.push_back(std::move(change));
        told_apart_.clear();
    }
    /// Names the rivals whose runs had ended before the best method's time was over.
    void end_reign(double seconds) {
        Crossover& now = changes_.back();
        for (const Contender& c : contest_.after(seconds))
            if (c.method != now.method && c.standing == Standing::open && c.ended < well_before * seconds)
                now.doubts.open.push_back(c.method);
    }
    /// A rival ties until there is a time from which on the best method is told apart from it.
    void compare_rivals(const std::vector<Contender>& ranking) {
        Crossover& now = changes_.back();
        const Contender& own = of_method(ranking, now.method);
        for (const Contender& c : ranking) {
            if (c.method == now.method || !c.is_complete || c.logs.empty() || c.known != Contender::Known::equal)
                continue;
            if (are_told_apart(own, c)) told_apart_.insert(c.method);
            const auto found = std::ranges::find(now.doubts.ties, c.method);
            if (told_apart_.count(c.method) == 0 && found == now.doubts.ties.end()) now.doubts.ties.push_back(c.method);
            if (told_apart_.count(c.method) > 0 && found != now.doubts.ties.end()) now.doubts.ties.erase(found);
        }
    }

    std::string scene_;
    const Contest& contest_;
    std::vector<double> times_;
    std::vector<Crossover> changes_;
    std::set<std::string> told_apart_;  ///< from the best method since the last change
};

}  // namespace

std::vector<Crossover> crossovers(const Analysis& analysis) {
    std::vector<Crossover> all;
    for (const auto& scene : scenes_of(analysis)) {
        const Contest contest(analysis, scene);
        if (contest.methods() < 2 || !contest.is_judged()) continue;
        for (Crossover& change : Scan(scene, contest).changes())
            all.push_back(std::move(change));
    }
    return all;
}

}  // namespace gib
