#include "experiments/tuning/tuning_result.h"

#include "experiments/analysis/table_row.h"
#include "experiments/metrics/student_t.h"
#include "experiments/text/json_record.h"
#include "experiments/text/numbers.h"
#include "methods/method.h"

#include <fmt/format.h>

#include <cmath>

namespace gib {

using nlohmann::json;

namespace {

constexpr const char* state_names[] = {"measured", "extrapolated", "not reachable", "no image"};

std::string percent(double share) { return fmt::format("{:.3g}", 100 * share); }

json settings_of(const TunedMethod& method) {
    json all = json::array();
    for (const Trial& trial : method.trials) {
        json values = json::array();
        for (std::size_t d = 0; d < method.space.axes().size(); ++d) {
            const TuningAxis& axis = method.space.axes()[d];
            const auto value = method.space.effective(trial.setting, d);
            values.push_back(!value ? json(nullptr) : axis.words.empty() ? json(*value) : json(axis.text(*value)));
        }
        all.push_back({{"label", method.space.label(trial.setting).text()},
                       {"values", values},
                       {"seconds", number_to_json(trial.time.seconds)},
                       {"measured", trial.time.is_measured}});
    }
    return all;
}

json parameters_of(const SearchSpace& space) {
    json all = json::array();
    for (const TuningAxis& axis : space.axes())
        for (const Parameter& p : find_method(space.base().name).parameters)
            if (p.name == axis.name)
                all.push_back({{"name", axis.name},
                               {"unit", p.unit},
                               {"sentence", p.sentence},
                               {"words", axis.words.empty() ? json(nullptr) : json(axis.words)}});
    return all;
}

/// The label of a setting, with the samples a pixel to the target if its verdict knows them.
std::string label_to_paste(const TuningResult& result, const FinalSetting& f) {
    const MethodLabel label = result.label(f);
    const auto& [state, interval] = std::pair(f.verdict.state, f.verdict.seconds.interval);
    const bool is_known =
        state == Verdict::measured || (state == Verdict::extrapolated && interval && std::isfinite(interval->hi));
    return is_known ? with_value(label, "spp", std::to_string(f.verdict.passes)).text() : label.text();
}

/// An extrapolated time: a bound or a guess within twice the runs' own time says no more than the runs do.
std::string extrapolated_text(const Verdict& verdict) {
    const double lo = verdict.seconds.interval->lo, value = verdict.seconds.value, least = 2 * verdict.seconds_of_error;
    if (std::isfinite(verdict.seconds.interval->hi)) return fmt::format(" after {} s", with_interval(verdict.seconds));
    const std::string bound = lo >= least ? fmt::format(" after at least {} s", short_number(lo)) : "";
    if (!(value > lo && value >= least && std::isfinite(value))) return bound;
    return fmt::format("{} perhaps {} s", bound.empty() ? " after" : bound + ",", short_number(value));
}

/// "5 % after 1.32 s (1.20 to 1.45), measured", "5 % after at least 17.9 s, extrapolated from 8 % after 4 s", "5 % not
/// reached: 6 % after 4 s", "5 % not reached: these settings have an error floor of 16.1 (15.8 to 16.4) %, 16.3 % after
/// 3 s".
std::string time_text(const TuningResult& result, const FinalSetting& f) {
    const Verdict& verdict = f.verdict;
    const std::string end =
        fmt::format("{} % after {} s", percent(verdict.error), short_number(verdict.seconds_of_error));
    const std::string some = verdict.state == Verdict::extrapolated && verdict.reached > 0
                                 ? fmt::format(", {} of {} runs have reached it", verdict.reached, verdict.runs)
                                 : "";
    const std::string runs = some + (!f.is_fresh ? ", by the run that chose it" : verdict.runs == 1 ? ", one run" : "");
    switch (verdict.state) {
        case Verdict::measured:
            return fmt::format("{} after {} s, measured{}", result.target, with_interval(verdict.seconds), runs);
        case Verdict::extrapolated: {
            const std::string time = extrapolated_text(verdict);
            return time.empty() ? fmt::format("{} not reached: {}{}", result.target, end, runs)
                                : fmt::format("{}{}, extrapolated from {}{}", result.target, time, end, runs);
        }
        case Verdict::not_reachable:
            return fmt::format("{} not reached: these settings have an error floor of {} %, {}{}", result.target,
                               with_interval(verdict.floor, percent), end, runs);
        case Verdict::no_image:
            break;
    }
    return "no run was measured";
}

/// time_text() and the light that the method leaves out.
std::string verdict_text(const TuningResult& result, const FinalSetting& f) {
    const std::string left_out = words_of(result.methods[f.method].left_out);
    return time_text(result, f) + (left_out.empty() ? "" : ", leaves out " + left_out);
}

/// How long a setting takes beside `best`, which has reached the target: "1.50 (1.43 to 1.57) times as long", "over
/// 3.00 times as long".
std::string factor_text(const FinalSetting& setting, const FinalSetting& best) {
    if (setting.verdict.state == Verdict::no_image) return "not measured";
    if (setting.verdict.state != Verdict::measured) {
        const double factor = setting.verdict.seconds_of_error / best.verdict.seconds.value;
        return factor > 1 ? fmt::format("over {} times as long", short_number(factor)) : "not reached";
    }
    const SampleMean a = sample_mean(setting.verdict.log_times), b = sample_mean(best.verdict.log_times);
    Estimate factor{std::exp(a.value - b.value), std::nullopt};
    if (setting.verdict.runs > 1 && best.verdict.runs > 1) {
        const double half = half_width({a.variance, b.variance}, interval_tail);
        factor.interval = Interval{factor.value * std::exp(-half), factor.value * std::exp(half)};
    }
    const bool is_tie = !factor.interval || (factor.interval->lo <= 1 && factor.interval->hi >= 1);
    return fmt::format("{} times as long{}", with_interval(factor),
                       is_tie ? ", not significantly different from the best" : "");
}

/// The lines between the label to paste and the verdicts.
std::vector<std::string> tuning_lines(const TuningResult& result) {
    const FinalSetting* best = result.best();
    if (!best) return {};
    const std::string runs = !best->is_fresh ? "by the run that chose it"
                             : best->verdict.runs == 1
                                 ? "one fresh seed"
                                 : fmt::format("{} fresh seeds, 95 % interval", best->verdict.runs);
    std::vector<std::string> lines = {
        fmt::format("seconds to {}: {}, {}", result.target, with_interval(best->verdict.seconds), runs)};
    for (const auto& [error, seconds] : result.along_the_way)
        lines.push_back(fmt::format("seconds to {:g} %: {}", 100 * error, with_interval(seconds)));
    for (const FinalSetting& f : result.finals)
        if (f.is_best && &f != best)
            lines.push_back(fmt::format("{}: {}", result.label(f).text(), factor_text(f, *best)));
    for (const FinalSetting& of_method : result.finals) {
        if (!of_method.is_best || of_method.verdict.state != Verdict::measured) continue;
        for (const FinalSetting& f : result.finals)
            if (f.method == of_method.method && !f.is_best)
                lines.push_back(fmt::format("{} with the defaults: {}", result.methods[f.method].space.base().text(),
                                            factor_text(f, of_method)));
    }
    return lines;
}

}  // namespace

const FinalSetting* TuningResult::best() const {
    const bool any_is_whole = std::ranges::any_of(methods, [](const TunedMethod& m) { return m.left_out.empty(); });
    for (const FinalSetting& f : finals)
        if (f.is_best && f.verdict.state == Verdict::measured && !(any_is_whole && !methods[f.method].left_out.empty()))
            return &f;
    return nullptr;
}

std::string tuning_text(const TuningResult& result) {
    std::string text;
    if (const FinalSetting* best = result.best()) text += label_to_paste(result, *best) + "\n";
    for (const auto& line : tuning_lines(result))
        text += line + "\n";
    for (const auto& note : result.notes)
        text += "cut: " + note + "\n";
    for (const FinalSetting& f : result.finals)
        if (f.is_best) text += fmt::format("{}: {}\n", label_to_paste(result, f), verdict_text(result, f));
    return text;
}

std::string tuning_json(const TuningResult& result) {
    json methods = json::array(), best = nullptr;
    for (const FinalSetting& f : result.finals) {
        if (!f.is_best) continue;
        if (&f == result.best()) best = methods.size();
        const TunedMethod& method = result.methods[f.method];
        const Interval interval = f.verdict.seconds.interval.value_or(Interval{NAN, NAN});
        methods.push_back({{"base", method.space.base().text()},
                           {"label", result.label(f).text()},
                           {"paste", label_to_paste(result, f)},
                           {"state", state_names[f.verdict.state]},
                           {"verdict", verdict_text(result, f)},
                           {"seconds", number_to_json(f.verdict.seconds.value)},
                           {"lo", number_to_json(interval.lo)},
                           {"hi", number_to_json(interval.hi)},
                           {"parameters", parameters_of(method.space)},
                           {"settings", settings_of(method)}});
    }
    const json all = {{"scene", result.scene},         {"target", result.target}, {"used_seconds", result.used_seconds},
                      {"minutes", result.minutes},     {"methods", methods},      {"best", best},
                      {"lines", tuning_lines(result)}, {"cuts", result.notes}};
    return all.dump(1) + "\n";
}

}  // namespace gib
