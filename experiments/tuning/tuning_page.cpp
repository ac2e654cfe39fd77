#include "experiments/tuning/tuning_page.h"

#include "common/core/files.h"
#include "experiments/system/progress.h"
#include "experiments/text/embedded_files.h"
#include "experiments/text/html.h"
#include "experiments/text/json_record.h"
#include "experiments/text/numbers.h"
#include "experiments/text/template_text.h"
#include "experiments/tuning/tuning_text.h"
#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

using nlohmann::json;

namespace {

using kainjow::mustache::data;
using kainjow::mustache::list;
using kainjow::mustache::object;

json values_of(const MethodLabel& label, const TunedMethod& method) {
    json values = json::array();
    for (const TuningAxis& axis : method.axes)
        values.push_back(effective_value(label, axis));
    return values;
}

json parameters_of(const TunedMethod& method) {
    json all = json::array();
    const auto& declared = find_method(method.base.name).parameters;
    for (const TuningAxis& axis : method.axes) {
        const auto p =
            std::find_if(declared.begin(), declared.end(), [&](const Parameter& d) { return d.name == axis.name; });
        all.push_back({{"name", axis.name},
                       {"unit", p->unit},
                       {"sentence", p->sentence},
                       {"words", axis.words.empty() ? json(nullptr) : json(axis.words)}});
    }
    return all;
}

json settings_of(const TunedMethod& method) {
    json all = json::array();
    for (const Trial& trial : method.trials)
        all.push_back({{"label", trial.label.text()},
                       {"values", values_of(trial.label, method)},
                       {"seconds", number_to_json(trial.time.seconds)},
                       {"measured", trial.time.is_measured}});
    return all;
}

json best_of(const TuningResult& result) {
    if (!result.has_best()) return nullptr;
    const FinalSetting& best = result.best();
    const Estimate seconds = seconds_of(best);
    return {{"method", best.method},
            {"label", best.label.text()},
            {"paste", label_to_paste(result)},
            {"values", values_of(best.label, result.methods[best.method])},
            {"seconds", seconds.value},
            {"seconds_lo", seconds.interval->lo},
            {"seconds_hi", seconds.interval->hi},
            {"measured", true}};
}

json numbers_of(const TuningResult& result) {
    json methods = json::array(), tuned = json::array(), finals = json::array();
    for (const TunedMethod& method : result.methods) {
        methods.push_back(method.base.text());
        tuned.push_back({{"parameters", parameters_of(method)},
                         {"settings", method.axes.empty() ? json::array() : settings_of(method)}});
    }
    for (const FinalSetting& final_one : result.finals)
        finals.push_back({{"label", final_one.label.text()},
                          {"standing", result.has_best() ? standing_text(result, final_one) : ""}});
    return {{"scene", result.scene},
            {"target", result.target},
            {"target_error", result.target_error},
            {"used_seconds", result.used_seconds},
            {"methods", methods},
            {"best", best_of(result)},
            {"tuned", tuned},
            {"finals", finals},
            {"notes", result.notes}};
}

/// A value and its interval for a field: "12.3" and "11.0 to 14.1".
object estimate_data(const Estimate& e) {
    return {{"value", short_number(e.value)},
            {"interval", fmt::format("{} to {}", short_number(e.interval->lo), short_number(e.interval->hi))}};
}

list times_data(const TuningResult& result) {
    list times;
    const auto add = [&](const std::string& error, const Estimate& seconds) {
        object field = estimate_data(seconds);
        field["error"] = error;
        times.push_back(field);
    };
    add(result.target, seconds_of(result.best()));
    for (const auto& [error, seconds] : times_along_the_way(result))
        if (error != result.target_error) add(fmt::format("{:g} %", 100 * error), seconds);
    return times;
}

object row_data(const TuningResult& result, const FinalSetting& other) {
    object row = {{"value", "not reached"}, {"interval", ""}, {"tie", false}};
    if (!other.log_times.empty()) {
        const Estimate factor = factor_between(other, result.best());
        row = estimate_data(factor);
        row["tie"] = holds_one(factor);
    } else if (other.cells.empty()) {
        row["value"] = "not measured";
    }
    row["label"] = other.label.text();
    return row;
}

/// The settings one step from the best, and the other ones.
list tables_data(const TuningResult& result) {
    list steps, others;
    for (const FinalSetting& f : result.finals) {
        if (&f == &result.best()) continue;
        object row = row_data(result, f);
        const std::string change = change_of(result, f);
        const bool is_step = f.method == result.best().method && !change.empty() && change != "the defaults";
        row["change"] = is_step || !change.empty() ? change : result.methods[f.method].base.name;
        (is_step ? steps : others).push_back(row);
    }
    list tables;
    if (!steps.empty())
        tables.push_back(object{{"heading", "One step from the cheapest settings"},
                                {"words", "How the time grows when one setting is halved, doubled or changed."},
                                {"first", "change"},
                                {"rows", steps}});
    if (!others.empty())
        tables.push_back(object{{"heading", "Other settings"},
                                {"words", "Runners-up, the defaults and other methods, measured with the same seeds."},
                                {"first", "settings of"},
                                {"rows", others}});
    return tables;
}

list methods_data(const TuningResult& result) {
    list methods;
    for (std::size_t m = 0; m < result.methods.size(); ++m) {
        const TunedMethod& method = result.methods[m];
        if (method.axes.empty()) continue;
        const auto never = std::count_if(method.trials.begin(), method.trials.end(),
                                         [](const Trial& t) { return !std::isfinite(t.time.seconds); });
        methods.push_back(object{
            {"number", std::to_string(m)},
            {"label", method.base.text()},
            {"target", result.target},
            {"never",
             never == 0 ? "" : fmt::format("Not shown: {} that never reach it, because of their bias.", never)}});
    }
    return methods;
}

data page_data(const TuningResult& result) {
    const std::string title = fmt::format("Cheapest settings: {} to {}", result.scene, result.target);
    list gains;
    if (result.has_best())
        for (const Speedup& speedup : speedups(result))
            gains.push_back(sentence_of(result, speedup));
    data page = object{{"title", title},
                       {"plain_title", html_escape(title)},
                       {"style", std::string(embedded_file("report_page/page.css"))},
                       {"used", duration_text(result.used_seconds)},
                       {"asked", duration_text(60 * result.minutes)},
                       {"target", result.target},
                       {"best", false},
                       {"notes", list(result.notes.begin(), result.notes.end())},
                       {"any_gains", !gains.empty()},
                       {"gains", gains},
                       {"methods", methods_data(result)},
                       {"tables", list{}},
                       {"data", script_safe_json(numbers_of(result).dump())},
                       {"scripts", embedded_scripts({"chart.js", "report_page/core.js", "report_page/charts.js",
                                                     "report_page/tuning.js"})}};
    if (!result.has_best()) return page;
    page["best"] = object{{"label", label_to_paste(result)},
                          {"times", times_data(result)},
                          {"seeds", std::to_string(result.best().log_times.size())}};
    page["tables"] = tables_data(result);
    return page;
}

}  // namespace

std::string tuning_json(const TuningResult& result) { return numbers_of(result).dump(1) + "\n"; }

std::string tuning_html(const TuningResult& result) {
    return filled(embedded_file("report_page/tuning.html"), page_data(result), sentence_html);
}

std::string write_tuning_page(const TuningResult& result, const std::string& folder) {
    write_file(folder + "/tune.json", tuning_json(result));
    write_file(folder + "/tune.html", tuning_html(result));
    return folder + "/tune.html";
}

}  // namespace gib
