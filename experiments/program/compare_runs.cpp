#include "experiments/program/compare_runs.h"

#include "common/core/parallel.h"
#include "experiments/analysis/analysis.h"
#include "experiments/report/field_text.h"
#include "experiments/system/interrupt.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

namespace gib {

namespace {

Analysis analysis_in(const std::string& path) {
    Analysis analysis = analyse(ResultFolder(path));
    for (const std::string& what : analysis.damage)
        std::cerr << "warning: " << what << "\n";
    for (const Warning& warning : analysis.warnings)
        if (warning.kind == Warning::Kind::busy_machine)
            std::cerr << fmt::format("warning: {}: {}\n", path, warning.sentence);
    return analysis;
}

/// "error after 1.20 s" or "seconds to 5 %"
std::string quantity(const Change& change) {
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
    return change.of == Change::Of::error ? percent_text(value) + " %" : short_number(value);
}

std::size_t count_of(const RunComparison& comparison, ChangeVerdict verdict) {
    return static_cast<std::size_t>(
        std::ranges::count_if(comparison.changes, [&](const Change& change) { return change.verdict == verdict; }));
}

std::string summary(const RunComparison& comparison) {
    if (comparison.changes.empty()) return "nothing to compare: the runs share no cell with an error\n";
    std::string text;
    for (const auto verdict :
         {ChangeVerdict::better, ChangeVerdict::worse, ChangeVerdict::cannot_be_told, ChangeVerdict::other_machine})
        if (const std::size_t count = count_of(comparison, verdict); count > 0 || verdict <= ChangeVerdict::worse)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name_of(verdict));
    return fmt::format("{} numbers: {}\n", comparison.changes.size(), text);
}

}  // namespace

CsvTable change_table(const RunComparison& comparison) {
    CsvTable table{{"scene", "method", "number", "at", "before", "after", "factor", "factor_lo", "factor_hi", "verdict",
                    "label", "before_is_floor", "after_is_floor"},
                   {}};
    const auto yes = [](bool is_so) { return is_so ? "yes" : ""; };
    for (const Change& c : comparison.changes)
        table.add({c.scene, c.method, c.of == Change::Of::error ? "error" : "seconds", csv_number(c.at),
                   csv_number(c.before), csv_number(c.after), csv_number(c.factor.value),
                   c.factor.interval ? csv_number(c.factor.interval->lo) : "",
                   c.factor.interval ? csv_number(c.factor.interval->hi) : "", name_of(c.verdict), c.name,
                   yes(c.before_is_floor), yes(c.after_is_floor)});
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
    const bool has_failed = comparison.changes.empty() || count_of(comparison, ChangeVerdict::worse) > 0;
    return options.fail_if_worse && has_failed ? exit_failed : 0;
}

}  // namespace gib
