#include "experiments/tuning/tuning_result.h"

#include "common/core/number_text.h"
#include "experiments/text/numbers.h"
#include "experiments/tuning/time_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

Estimate exponential(double mean, double half) {
    return {std::exp(mean), Interval{std::exp(mean - half), std::exp(mean + half)}};
}

bool is_same(const MethodLabel& a, const MethodLabel& b) { return a.text() == b.text(); }

/// The words for a change along an axis; empty if nothing changes.
std::string change_along(const TuningAxis& axis, const MethodLabel& best, const MethodLabel& other) {
    const std::string from = effective_value(best, axis), to = effective_value(other, axis);
    if (from == to || to.empty()) return "";
    const auto before = number_from<double>(from), after = number_from<double>(to);
    const double ratio = before && after && *before > 0 ? *after / *before : 0;
    if (std::abs(ratio - 0.5) < 0.05) return axis.name + " halved";
    if (std::abs(ratio - 2) < 0.2) return axis.name + " doubled";
    return fmt::format("{}={}", axis.name, to);
}

}  // namespace

Estimate seconds_of(const FinalSetting& f) {
    return exponential(f.mean.value, half_width({f.mean.variance}, interval_tail));
}

Estimate factor_between(const FinalSetting& other, const FinalSetting& best) {
    return exponential(other.mean.value - best.mean.value,
                       half_width({other.mean.variance, best.mean.variance}, interval_tail));
}

std::vector<std::pair<double, Estimate>> times_along_the_way(const TuningResult& result) {
    std::vector<std::pair<double, Estimate>> along;
    for (const double error : errors_along_the_way)
        if (const auto times = log_times(result.best().cells, error); times.size() > 1) {
            const SampleMean mean = sample_mean(times);
            along.emplace_back(error, exponential(mean.value, half_width({mean.variance}, interval_tail)));
        }
    return along;
}

std::string change_of(const TuningResult& result, const FinalSetting& other) {
    const TunedMethod& method = result.methods[other.method];
    if (!method.axes.empty() && is_same(other.label, method.base)) return "the defaults";
    if (other.method != result.best().method) return "";
    std::string only;
    for (const TuningAxis& axis : method.axes) {
        const std::string change = change_along(axis, result.best().label, other.label);
        if (!change.empty() && !only.empty()) return "";
        if (!change.empty()) only = change;
    }
    return only;
}

std::vector<Speedup> speedups(const TuningResult& result) {
    std::vector<Speedup> all;
    for (std::size_t m = 0; m < result.methods.size(); ++m) {
        const auto of_method = [&](const FinalSetting& f) { return f.method == m && !f.log_times.empty(); };
        const auto is_base = [&](const FinalSetting& f) {
            return f.method == m && is_same(f.label, result.methods[m].base);
        };
        const auto best = std::find_if(result.finals.begin(), result.finals.end(), of_method);
        const auto base = std::find_if(result.finals.begin(), result.finals.end(), is_base);
        if (result.methods[m].axes.empty() || best == result.finals.end() || base == result.finals.end()) continue;
        Speedup speedup{.method = m, .best = &*best};
        if (!base->log_times.empty()) speedup.factor = factor_between(*base, *best);
        else if (!base->cells.empty()) speedup.at_least = result.final_budget / std::exp(best->mean.value);
        if (speedup.factor || speedup.at_least.value_or(0) > 1) all.push_back(speedup);
    }
    return all;
}

std::string sentence_of(const TuningResult& result, const Speedup& speedup) {
    const MethodLabel& base = result.methods[speedup.method].base;
    const char* start = base.values.empty() ? "its defaults" : "the defaults of all other parameters";
    if (is_same(speedup.best->label, base)) return fmt::format("{} is fastest with {}", base.text(), start);
    if (!speedup.factor)
        return fmt::format("{} is at least {} times faster than with {}, which do not reach {} in {} s", base.text(),
                           short_number(*speedup.at_least), start, result.target, short_number(result.final_budget));
    return fmt::format("{} is {} times faster than with {}{}", base.text(), with_interval(*speedup.factor), start,
                       holds_one(*speedup.factor) ? ", which cannot be told apart" : "");
}

std::string label_to_paste(const TuningResult& result) {
    const FinalSetting& best = result.best();
    const auto passes = passes_to(best.cells, result.target_error);
    return passes ? with_value(best.label, "spp", std::to_string(*passes)).text() : best.label.text();
}

}  // namespace gib
