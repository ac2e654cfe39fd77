#include "experiments/analysis/price.h"

#include "common/core/math.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace gib {

namespace {

using Runs = std::vector<const Cell*>;

/// A change of the best method counts only if the new error is below this fraction of the old one.
constexpr double least_lead = 0.95;

std::vector<std::vector<ErrorPoint>> points_of(const Runs& cells, const std::string& component) {
    const std::size_t count = common_checkpoints(cells);
    std::vector<std::vector<ErrorPoint>> runs;
    for (const Cell* cell : cells) {
        runs.emplace_back();
        for (std::size_t i = 0; i < count; ++i) {
            const auto& [checkpoint, errors] = cell->checkpoints[i];
            const auto error = errors.find(component);
            if (error == errors.end()) return {};
            runs.back().push_back({checkpoint.seconds, error->second.rel_mse_corrected});
        }
    }
    return runs;
}

Runs without(const Runs& cells, std::size_t left_out) {
    Runs rest = cells;
    if (left_out < rest.size()) rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(left_out));
    return rest;
}

/// The 95 % interval of a number by the delete-one jackknife over `runs` runs, in its logarithm. `log_without(s)` is the
/// logarithm without run s. None for fewer than 3 runs, or if one of these is empty.
template <typename LogWithout>
std::optional<Interval> log_interval(double log_value, std::size_t runs, const LogWithout& log_without) {
    if (runs < 3) return std::nullopt;
    std::vector<double> logs;
    for (std::size_t s = 0; s < runs; ++s) {
        const auto log = log_without(s);
        if (!log) return std::nullopt;
        logs.push_back(*log);
    }
    const Estimate e = jackknife(log_value, logs);
    return Interval{std::exp(e.interval->lo), std::exp(e.interval->hi)};
}

/// log(time of the last point / time at which the error was twice as large), for the mean of the runs.
std::optional<double> log_last_halving(const Runs& cells, const std::string& component, double noise_floor) {
    const auto runs = points_of(cells, component);
    if (runs.empty() || runs.front().empty()) return std::nullopt;
    std::vector<ErrorPoint> mean(runs.front().size(), {0, 0});
    for (const auto& run : runs)
        for (std::size_t i = 0; i < mean.size(); ++i) {
            mean[i].seconds += run[i].seconds / static_cast<double>(runs.size());
            mean[i].error2 += run[i].error2 / static_cast<double>(runs.size());
        }
    const ErrorPoint end = mean.back();
    if (!(end.error2 > noise_floor)) return std::nullopt;
    for (std::size_t i = mean.size() - 1; i-- > 0;) {
        const ErrorPoint &a = mean[i], &b = mean[i + 1];
        if (!(a.error2 >= 4 * end.error2)) continue;
        const double part = std::log(a.error2 / (4 * end.error2)) / std::log(a.error2 / b.error2);
        return std::log(end.seconds / a.seconds) - part * std::log(b.seconds / a.seconds);
    }
    return std::nullopt;
}

/// The mean squared error of some runs as a function of time: infinite before all of them have an image, 0 unless it
/// is above the noise floor.
struct MeanCurve {
    Runs cells;
    double noise_floor;
    double operator()(double seconds) const {
        const auto error2 = mean_error2_after(cells, total_name, seconds);
        if (!error2) return std::numeric_limits<double>::infinity();
        return *error2 > noise_floor ? *error2 : 0;
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
    return log_interval(std::log(seconds), seeds, [&](std::size_t s) {
        const auto time = passing_near(best.without(s), challenger.without(s), times, seconds);
        return time ? std::optional(std::log(*time)) : std::nullopt;
    });
}

std::vector<Crossover> crossovers_of(const CellsByMethod& methods, const std::string& scene, double noise_floor) {
    std::set<double> all_times;
    std::vector<std::pair<std::string, MeanCurve>> curves;
    for (const auto& [method, cells] : methods) {
        curves.push_back({method, {cells, noise_floor}});
        for (const Cell* cell : cells)
            for (const auto& c : cell->checkpoints)
                all_times.insert(c.checkpoint.seconds);
    }
    const std::vector<double> times(all_times.begin(), all_times.end());
    std::vector<Crossover> changes;
    const MeanCurve* best = nullptr;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const auto& [method, curve] =
            *std::min_element(curves.begin(), curves.end(),
                              [&](const auto& a, const auto& b) { return a.second(times[i]) < b.second(times[i]); });
        const double error2 = curve(times[i]);
        if (!std::isfinite(error2)) continue;
        if (!best) {
            changes.push_back(
                {.scene = scene, .method = method, .seconds = times[i], .relative_rmse = std::sqrt(error2)});
            best = &curve;
            continue;
        }
        if (!(std::sqrt(error2) < least_lead * std::sqrt((*best)(times[i])))) continue;
        // The new method may have been ahead for a while, but by less than a change needs.
        std::size_t behind = i - 1;
        while (times[behind] > changes.back().seconds && curve(times[behind]) < (*best)(times[behind]))
            --behind;
        const double seconds = passing_time(*best, curve, times[behind], times[i]);
        changes.push_back({.scene = scene,
                           .method = method,
                           .before = changes.back().method,
                           .seconds = seconds,
                           .interval = passing_interval(*best, curve, times, seconds),
                           .relative_rmse = std::sqrt(curve(seconds))});
        best = &curve;
    }
    return changes;
}

}  // namespace

std::optional<PriceLaw> price_law_of(const std::vector<const Cell*>& cells, const std::string& component,
                                     double noise_floor) {
    if (cells.empty()) return std::nullopt;
    double start = 0;
    for (const Cell* cell : cells)
        start += cell->prepare_seconds / static_cast<double>(cells.size());
    return fit_price_law(points_of(cells, component), start, noise_floor);
}

std::optional<Estimate> last_halving(const std::vector<const Cell*>& cells, const std::string& component,
                                     double noise_floor) {
    const auto log_factor = log_last_halving(cells, component, noise_floor);
    if (!log_factor) return std::nullopt;
    return Estimate{std::exp(*log_factor), log_interval(*log_factor, cells.size(), [&](std::size_t s) {
                        return log_last_halving(without(cells, s), component, noise_floor);
                    })};
}

double floor_bias2(const TableRow& row) {
    if (row.is_unbiased || !row.law || !row.statistics || !row.statistics->rel_bias2) return 0;
    return std::clamp(row.statistics->rel_bias2->value, 0.0, row.law->floor.value);
}

std::vector<Crossover> crossovers(const Analysis& analysis) {
    std::vector<Crossover> changes;
    for (const auto& scene : scenes_of(analysis)) {
        const CellsByMethod methods = cells_by_method(analysis, scene);
        if (methods.size() < 2 || !analysis.unjudged(scene).empty()) continue;
        for (auto& change : crossovers_of(methods, scene, analysis.noise_floor(scene, total_name)))
            changes.push_back(std::move(change));
    }
    return changes;
}

}  // namespace gib
