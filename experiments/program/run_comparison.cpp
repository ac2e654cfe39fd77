#include "experiments/program/run_comparison.h"

#include "common/core/parallel.h"
#include "experiments/analysis/analysis.h"
#include "experiments/analysis/ranking.h"
#include "experiments/analysis/warnings.h"
#include "experiments/report/words.h"
#include "experiments/results/quantities.h"
#include "experiments/system/interrupt.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

namespace gib {

namespace {

/// A number of a cell in both runs, as contenders.
struct Pair {
    Change change;
    Contender before, after;
};

/// One scene in both runs.
class ScenePairs {
public:
    ScenePairs(const Analysis& before, const Analysis& after, const std::string& scene)
        : scene_(scene), before_(before, scene), after_(after, scene) {}

    bool has_both(const std::string& method) const {
        return before_.cells().count(method) > 0 && after_.cells().count(method) > 0;
    }

    /// The errors of the methods at equal time, and their times to each error. The scatter is that of all methods in
    /// both runs.
    std::vector<std::vector<Pair>> all(const std::vector<std::string>& methods) const {
        std::vector<std::vector<Pair>> numbers = {errors(methods, Change::Of::error)};
        for (std::size_t t = 0; t < target_errors.size(); ++t) {
            const auto ranking = before_.to_error(t), later = after_.to_error(t);
            std::vector<Pair> times;
            for (const std::string& method : methods)
                add(method, ranking, later, Change::Of::seconds, target_errors[t], times);
            set_scatter_of(times);
            numbers.push_back(std::move(times));
        }
        return numbers;
    }

    /// The errors of the methods at equal time, or at equal passes (with_passes_for_seconds()).
    std::vector<Pair> errors(const std::vector<std::string>& methods, Change::Of of) const {
        std::vector<Pair> errors;
        for (const std::string& method : methods) {
            const double seconds =
                std::min(mean_seconds(before_.cells().at(method)), mean_seconds(after_.cells().at(method)));
            add(method, before_.after(seconds), after_.after(seconds), of, seconds, errors);
        }
        set_scatter_of(errors);
        return errors;
    }

private:
    static const Contender* known(const std::string& method, const std::vector<Contender>& ranking) {
        for (const Contender& c : ranking)
            if (c.method == method && !c.logs.empty() && c.known == Contender::Known::equal) return &c;
        return nullptr;
    }

    void add(const std::string& method, const std::vector<Contender>& before, const std::vector<Contender>& after,
             Change::Of of, double at, std::vector<Pair>& pairs) const {
        const Contender *a = known(method, before), *b = known(method, after);
        if (!a || !b) return;
        pairs.push_back({{.scene = scene_, .method = method, .of = of, .at = at}, *a, *b});
        // Errors are at least the larger noise floor of both references.
        if (of != Change::Of::seconds) {
            const double floor = std::max(before_.noise_floor(), after_.noise_floor());
            Pair& pair = pairs.back();
            for (auto [c, is_floor] : {std::pair(&pair.before, &pair.change.before_is_floor),
                                       std::pair(&pair.after, &pair.change.after_is_floor)})
                if (floor > 0 && c->mean <= floor) {
                    c->mean = floor;
                    std::ranges::fill(c->logs, std::log(floor));
                    *is_floor = true;
                }
        }
    }

    static void set_scatter_of(std::vector<Pair>& pairs) {
        std::vector<Contender> all;
        for (const Pair& pair : pairs)
            all.insert(all.end(), {pair.before, pair.after});
        set_scatter(all);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            pairs[i].before = std::move(all[2 * i]);
            pairs[i].after = std::move(all[2 * i + 1]);
        }
    }

    std::string scene_;
    Contest before_, after_;
};

/// Sets the factor, where the interval misses the truth with probability `tail` at most, and the verdict if there is
/// none yet.
void judge(Pair& pair, double tail) {
    Change& change = pair.change;
    const double squares = change.of == Change::Of::seconds ? 1 : 2;  // contenders have squared errors
    const std::vector<VarianceTerm> terms = difference_terms(pair.before, pair.after);
    const double log_factor = (pair.after.log_mean - pair.before.log_mean) / squares;
    const double half = half_width(terms, tail) / squares;
    change.before = std::pow(pair.before.mean, 1 / squares);
    change.after = std::pow(pair.after.mean, 1 / squares);
    change.factor.value = change.after / change.before;
    if (std::isfinite(half))
        change.factor.interval = Interval{std::min(change.factor.value, std::exp(log_factor - half)),
                                          std::max(change.factor.value, std::exp(log_factor + half))};
    if (change.verdict != ChangeVerdict::inconclusive || !change.factor.interval) return;
    // A machine that is slower by `same_speed` has errors at equal time that are larger by its root, but none at equal
    // passes.
    const double same = change.of == Change::Of::error_at_passes ? 1 : std::pow(same_speed, 1 / squares);
    if (change.factor.interval->hi < 1 / same) change.verdict = ChangeVerdict::better;
    if (change.factor.interval->lo > same) change.verdict = ChangeVerdict::worse;
}

/// The processors that measured a method, and the number of threads.
std::string machine_of(const Analysis& analysis, const std::string& scene, const std::string& method) {
    std::string text = std::to_string(analysis.index.threads);
    if (const TableRow* row = analysis.row(scene, method, Layer::total))
        for (const std::string& cpu : row->cpus)
            text += ";" + cpu;
    return text;
}

const IndexScene* scene_named(const Analysis& analysis, const std::string& name) {
    const auto found = std::ranges::find(analysis.index.scenes, name, &IndexScene::name);
    return found == analysis.index.scenes.end() ? nullptr : &*found;
}

/// The verdict on seconds of a method that do not compare; `inconclusive` of others.
ChangeVerdict verdict_on_machines(const Analysis& before, const Analysis& after, const Change& change) {
    const auto machine = [&](const Analysis& run) { return machine_of(run, change.scene, change.method); };
    const auto is_busy = [&](const Analysis& run) {
        return !busy_sign(run, change.method, cells_by_method(run, change.scene).at(change.method)).empty();
    };
    if (machine(before) != machine(after)) return ChangeVerdict::other_machine;
    return is_busy(before) || is_busy(after) ? ChangeVerdict::busy_machine : ChangeVerdict::inconclusive;
}

/// The errors at equal passes of those methods whose seconds do not compare.
std::vector<Pair> errors_at_passes(const Analysis& before, const Analysis& after, const std::string& scene,
                                   std::vector<std::string> methods) {
    std::erase_if(methods, [&](const std::string& method) {
        return verdict_on_machines(before, after, {.scene = scene, .method = method}) == ChangeVerdict::inconclusive;
    });
    if (methods.empty()) return {};
    const Analysis passes_before = with_passes_for_seconds(before), passes_after = with_passes_for_seconds(after);
    return ScenePairs(passes_before, passes_after, scene).errors(methods, Change::Of::error_at_passes);
}

/// The short names of the labels that only `run` has.
std::map<std::string, std::string> own_labels(const Analysis& run, const Analysis& other) {
    std::map<std::string, std::string> own;
    for (const TableRow& row : run.rows)
        own[row.method] = row.name;
    for (const TableRow& row : other.rows)
        own.erase(row.method);
    return own;
}

/// The beginning of a short name: the `label` of the experiment file, else the method's name.
std::string begin_of_name(const Analysis& run, const std::string& label) {
    const auto given = run.index.given_names.find(label);
    return given == run.index.given_names.end() ? label.substr(0, label.find(' ')) : given->second;
}

using LabelPairs = std::map<std::string, std::string>;  // label in the old run, by the label in the new run

/// The methods whose settings have changed, by their short names, or else by the beginnings of these.
LabelPairs changed_labels(const Analysis& before, const Analysis& after) {
    auto old_labels = own_labels(before, after), new_labels = own_labels(after, before);
    LabelPairs pairs;
    const auto pair_by = [&](const auto& key_of) {
        std::map<std::string, std::pair<std::vector<std::string>, std::vector<std::string>>> alike;
        for (const auto& [label, name] : old_labels)
            alike[key_of(before, label, name)].first.push_back(label);
        for (const auto& [label, name] : new_labels)
            alike[key_of(after, label, name)].second.push_back(label);
        for (const auto& [key, labels] : alike) {
            if (key.empty() || labels.first.size() != 1 || labels.second.size() != 1) continue;
            pairs[labels.second.front()] = labels.first.front();
            old_labels.erase(labels.first.front());
            new_labels.erase(labels.second.front());
        }
    };
    pair_by([](const Analysis&, const std::string&, const std::string& name) { return name; });
    pair_by(
        [](const Analysis& run, const std::string& label, const std::string&) { return begin_of_name(run, label); });
    return pairs;
}

/// The new run with the labels of the old one.
Analysis with_old_labels(Analysis after, const LabelPairs& pairs) {
    const auto rename = [&](std::string& method) {
        if (const auto found = pairs.find(method); found != pairs.end()) method = found->second;
    };
    for (TableRow& row : after.rows)
        rename(row.method);
    for (Cell& cell : after.cells)
        rename(cell.method);
    for (std::string& label : after.index.externals)
        rename(label);
    return after;
}

/// The short name of a method, if both runs have the same; else the label.
std::string name_in_both(const Analysis& before, const Analysis& after, const Change& change) {
    const TableRow *a = before.row(change.scene, change.method, Layer::total),
                   *b = after.row(change.scene, change.method, Layer::total);
    return a && b && a->name == b->name && !a->name.empty() ? a->name : change.method;
}

/// Says which cells only one of the runs has.
void remark_missing(const Analysis& in, const Analysis& missing_in, const char* which, RunComparison& comparison) {
    for (const TableRow& row : in.rows)
        if (row.layer == Layer::total && !missing_in.row(row.scene, row.method, Layer::total))
            comparison.remarks.push_back(fmt::format("{}, {}: only in the {} run", row.scene, row.method, which));
}

/// Says which methods have a bias although they are declared unbiased.
void remark_contradicted(const Analysis& in, const char* which, RunComparison& comparison) {
    for (const TableRow& row : in.rows)
        if (row.layer == Layer::total && !row.contradicted_in.empty()) {
            comparison.remarks.push_back(fmt::format("{}, {}: in the {} run {}", row.scene,
                                                     row.name.empty() ? row.method : row.name, which,
                                                     contradiction(in, row)));
            comparison.has_contradictions = true;
        }
}

Analysis analysis_in(const std::string& path) {
    Analysis analysis = analyse(ResultFolder(path));
    for (const std::string& what : analysis.damage)
        std::cerr << "warning: " << what << "\n";
    for (const Warning& warning : analysis.warnings)
        if (warning.kind == Warning::Kind::busy_machine)
            std::cerr << fmt::format("warning: {}: {}\n", path, warning.sentence);
    return analysis;
}

/// "error after 1.20 s", "error, 16 passes" or "seconds to 5 %"
std::string quantity(const Change& change) {
    if (change.of == Change::Of::error_at_passes) return fmt::format("error, {:.4g} passes", change.at);
    return change.of == Change::Of::error ? fmt::format("error after {} s", short_number(change.at))
                                          : fmt::format("seconds to {:g} %", 100 * change.at);
}

/// Says which of both errors is the noise floor instead; empty if none is.
std::string floor_remark(const Change& change) {
    if (!change.before_is_floor && !change.after_is_floor) return "";
    return fmt::format("; {} raised to the references' noise floor", !change.after_is_floor   ? "old"
                                                                     : change.before_is_floor ? "both"
                                                                                              : "new");
}

std::string value_text(const Change& change, double value) {
    return change.of == Change::Of::seconds ? short_number(value) : percent_text(value) + " %";
}

std::size_t count_of(const RunComparison& comparison, ChangeVerdict verdict) {
    return static_cast<std::size_t>(
        std::ranges::count_if(comparison.changes, [&](const Change& change) { return change.verdict == verdict; }));
}

std::string summary(const RunComparison& comparison) {
    if (comparison.changes.empty()) return "nothing to compare: the runs share no cell with an error\n";
    std::string text;
    for (const auto verdict : {ChangeVerdict::better, ChangeVerdict::worse, ChangeVerdict::inconclusive,
                               ChangeVerdict::busy_machine, ChangeVerdict::other_machine})
        if (const std::size_t count = count_of(comparison, verdict); count > 0 || verdict <= ChangeVerdict::worse)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name_of(verdict));
    const std::size_t count = comparison.changes.size();
    return fmt::format("{} number{}: {}\n", count, count == 1 ? "" : "s", text);
}

}  // namespace

const char* name_of(ChangeVerdict verdict) {
    constexpr const char* names[] = {"better", "worse", "inconclusive", "other machine",
                                     "inconclusive: the machine was busy"};
    return names[static_cast<std::size_t>(verdict)];
}

RunComparison compare_runs(const Analysis& before, const Analysis& new_run) {
    const LabelPairs changed = changed_labels(before, new_run);
    const Analysis after = with_old_labels(new_run, changed);
    RunComparison comparison;
    std::vector<Pair> pairs;
    for (const std::string& scene : scenes_of(before)) {
        const IndexScene *old_scene = scene_named(before, scene), *new_scene = scene_named(after, scene);
        if (old_scene && new_scene) {
            const Differences unlike = differences(quantities_of(before.index, *old_scene, before.unjudged(scene)),
                                                   quantities_of(after.index, *new_scene, after.unjudged(scene)));
            if (!unlike.all.empty()) {
                comparison.remarks.push_back(fmt::format("{}: not compared, because {}", scene, unlike.all));
                continue;
            }
            if (!unlike.noted.empty()) comparison.remarks.push_back(fmt::format("{}: {}", scene, unlike.noted));
        }
        const ScenePairs both(before, after, scene);
        std::vector<std::string> methods;
        for (const std::string& method : before.index.methods)
            if (both.has_both(method)) methods.push_back(method);
        auto numbers = both.all(methods);
        numbers.insert(numbers.begin() + 1, errors_at_passes(before, after, scene, methods));
        for (const std::string& method : methods)
            for (const auto& of_all : numbers)
                for (const Pair& pair : of_all)
                    if (pair.change.method == method) pairs.push_back(pair);
    }
    for (Pair& pair : pairs) {
        Change& change = pair.change;
        if (change.of != Change::Of::error_at_passes) change.verdict = verdict_on_machines(before, after, change);
        judge(pair, change_tail / static_cast<double>(pairs.size()));
        change.name = name_in_both(before, after, change);
        const auto found = std::ranges::find(changed, change.method, &LabelPairs::value_type::second);
        change.method_after = found == changed.end() ? change.method : found->first;
        comparison.changes.push_back(change);
    }
    for (const auto& [new_label, old_label] : changed)
        comparison.remarks.push_back(fmt::format("{}: its settings differ: `{}` in the old run, `{}` in the new run",
                                                 begin_of_name(before, old_label), old_label, new_label));
    remark_contradicted(before, "old", comparison);
    remark_contradicted(new_run, "new", comparison);
    remark_missing(before, after, "old", comparison);
    remark_missing(after, before, "new", comparison);
    return comparison;
}

CsvTable change_table(const RunComparison& comparison) {
    CsvTable table{{"scene", "method", "number", "at", "before", "after", "factor", "factor_lo", "factor_hi", "verdict",
                    "label", "before_is_floor", "after_is_floor", "method_after"},
                   {}};
    constexpr const char* names[] = {"error", "error_at_passes", "seconds"};  // in the order of Change::Of
    const auto yes = [](bool is_so) { return is_so ? "yes" : ""; };
    for (const Change& c : comparison.changes)
        table.add({c.scene, c.method, names[static_cast<std::size_t>(c.of)], csv_number(c.at), csv_number(c.before),
                   csv_number(c.after), csv_number(c.factor.value),
                   c.factor.interval ? csv_number(c.factor.interval->lo) : "",
                   c.factor.interval ? csv_number(c.factor.interval->hi) : "", name_of(c.verdict), c.name,
                   yes(c.before_is_floor), yes(c.after_is_floor), c.method_after});
    return table;
}

std::string change_text(const RunComparison& comparison) {
    std::string text;
    const Change* last = nullptr;
    for (const Change& c : comparison.changes) {
        if (!last || last->scene != c.scene || last->method != c.method)
            text += fmt::format("{}, {}\n", c.scene, c.name);
        text +=
            fmt::format("  {:<20}{:>9} -> {:<9} {:<24} {}{}\n", quantity(c), value_text(c, c.before),
                        value_text(c, c.after), "x " + with_interval(c.factor), name_of(c.verdict), floor_remark(c));
        last = &c;
    }
    for (const std::string& remark : comparison.remarks)
        text += remark + "\n";
    return text + summary(comparison);
}

int compare_runs(const CompareRunsOptions& options, std::ostream& out) {
    RunComparison comparison;
    with_threads(0, [&] { comparison = compare_runs(analysis_in(options.before), analysis_in(options.after)); });
    out << (options.csv ? change_table(comparison).text() : change_text(comparison));
    if (options.csv)
        for (const std::string& remark : comparison.remarks)
            std::cerr << remark << "\n";
    const bool has_failed =
        comparison.changes.empty() || comparison.has_contradictions || count_of(comparison, ChangeVerdict::worse) > 0;
    return options.fail_if_worse && has_failed ? exit_failed : 0;
}

}  // namespace gib
