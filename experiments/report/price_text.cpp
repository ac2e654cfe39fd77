#include "experiments/report/price_text.h"

#include "common/core/math.h"
#include "experiments/text/markdown.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// No time is extrapolated beyond `farthest_extrapolation` times the measured span, or if a point misses the law by
/// more than the share `largest_misfit` of its squared error.
constexpr double farthest_extrapolation = 100, largest_misfit = 0.5;

/// Whether a law describes its points well enough to be extrapolated.
bool law_holds(const PriceLaw& law) { return law.misfit <= largest_misfit; }

std::vector<const TableRow*> totals_of(const Analysis& analysis, const std::string& scene) {
    std::vector<const TableRow*> rows;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.component == total_name && row.statistics) rows.push_back(&row);
    return rows;
}

std::string with_interval(const Estimate& e) {
    if (!e.interval) return short_number(e.value);
    return fmt::format("{} ({} to {})", short_number(e.value), short_number(e.interval->lo),
                       short_number(e.interval->hi));
}

bool overlap(const Estimate& a, const Estimate& b) {
    return !a.interval || !b.interval || (a.interval->lo <= b.interval->hi && b.interval->lo <= a.interval->hi);
}

std::string percent(double share) { return percent_text(share) + " %"; }

/// A text with the component that has the largest part of a method's squared error after `seconds`, and its share of
/// the sum over components; empty if there is none.
std::string largest_part(const Analysis& analysis, const std::vector<const Cell*>& cells, const std::string& scene,
                         double seconds) {
    double sum = 0, largest = 0;
    std::string name;
    for (const auto& component : components_of(analysis, scene)) {
        if (component == total_name) continue;
        const auto error2 = mean_error2_after(cells, component, seconds);
        if (!error2 || !(*error2 > 0)) continue;
        sum += *error2;
        if (*error2 > largest) largest = *error2, name = component;
    }
    return sum > 0 ? fmt::format("{:.0f} % of its squared error in `{}`", 100 * largest / sum, name) : "";
}

/// A text with the error of a method after `seconds`, the component that has most of it and the effects that the
/// method leaves out. It says why the method is behind one that has reached its target by then.
std::string what_keeps(const Analysis& analysis, const CellsByMethod& methods, const TableRow& row, double seconds) {
    const auto& cells = methods.at(row.method);
    const auto error = relative_rmse_after(cells, total_name, seconds, analysis.noise_floor(row.scene, total_name));
    std::vector<std::string> parts;
    if (!error)
        parts.push_back(mean_error2_after(cells, total_name, seconds) ? "below what the reference resolves"
                                                                      : "no image yet");
    else parts.push_back(percent(*error));
    if (error)
        if (const auto part = largest_part(analysis, cells, row.scene, seconds); !part.empty()) parts.push_back(part);
    if (!row.effects_missing.empty()) parts.push_back("leaves out " + row.effects_missing);
    return fmt::format("{}", fmt::join(parts, ", "));
}

/// For each method name other than the winner's, the row of the label that comes closest to the target.
std::vector<const TableRow*> best_of_other_names(const std::vector<const TableRow*>& rows, const TableRow& winner,
                                                 std::size_t target, const CellsByMethod& methods, double seconds) {
    const auto name_of_method = [](const TableRow& row) { return row.method.substr(0, row.method.find(' ')); };
    const auto rank = [&](const TableRow& row) {
        const auto error = mean_error2_after(methods.at(row.method), total_name, seconds);
        return std::pair(row.times[target] ? row.times[target]->value : INFINITY, error.value_or(INFINITY));
    };
    std::vector<const TableRow*> best;
    for (const TableRow* row : rows) {
        if (name_of_method(*row) == name_of_method(winner)) continue;
        const auto same = std::find_if(best.begin(), best.end(), [&](const TableRow* other) {
            return name_of_method(*other) == name_of_method(*row);
        });
        if (same == best.end()) best.push_back(row);
        else if (rank(*row) < rank(**same)) *same = row;
    }
    return best;
}

std::string time_text(const Analysis& analysis, const TableRow& row, std::size_t target) {
    if (!is_target_resolved(analysis, row.scene, total_name, target)) return "not resolved";
    return row.times[target] ? with_interval(*row.times[target]) : unmeasured_time(row, target_errors[target]);
}

std::string answer_with_winner(const Analysis& analysis, const CellsByMethod& methods,
                               const std::vector<const TableRow*>& rows, std::vector<const TableRow*> reached,
                               std::size_t target) {
    std::stable_sort(reached.begin(), reached.end(), [&](const TableRow* a, const TableRow* b) {
        return a->times[target]->value < b->times[target]->value;
    });
    const TableRow& winner = *reached.front();
    const double seconds = winner.times[target]->value;
    std::string text = fmt::format("`{}` is the cheapest at {} %: {} s", winner.method, target_names[target],
                                   with_interval(*winner.times[target]));
    if (winner.prepare_seconds > 0.1 * seconds)
        text += fmt::format(", of which {} s are preparation", short_number(winner.prepare_seconds));
    text += ".";
    if (reached.size() > 1) {
        const TableRow& next = *reached[1];
        text += fmt::format(" `{}` takes {} times as long{}.", next.method,
                            short_number(next.times[target]->value / seconds),
                            overlap(*winner.times[target], *next.times[target]) ? " (the intervals overlap)" : "");
    }
    for (const TableRow* other : best_of_other_names(rows, winner, target, methods, seconds)) {
        const bool said = reached.size() > 1 && other == reached[1];
        const std::string time = said ? "" : time_text(analysis, *other, target);
        text += fmt::format(" After {} s `{}` has {}{}.", short_number(seconds), other->method,
                            what_keeps(analysis, methods, *other, seconds),
                            time.empty() ? ""
                                         : fmt::format("; {} %: {}{}", target_names[target], time,
                                                       time.back() == ')' && time.find("never") == 0 ? "" : " s"));
    }
    return text;
}

std::string answer_without_winner(const Analysis& analysis, const CellsByMethod& methods,
                                  const std::vector<const TableRow*>& rows, std::size_t target) {
    const TableRow* closest = nullptr;
    double least = INFINITY;
    for (const TableRow* row : rows) {
        const auto error2 = mean_error2_after(methods.at(row->method), total_name, row->seconds);
        if (error2 && *error2 < least) least = *error2, closest = row;
    }
    const double noise_floor = analysis.noise_floor(rows.front()->scene, total_name);
    if (!is_target_resolved(analysis, rows.front()->scene, total_name, target))
        return fmt::format("The reference does not resolve {} %, only {}.", target_names[target],
                           percent(std::sqrt(noise_floor)));
    std::string text = fmt::format("No method reached {} %.", target_names[target]);
    if (!closest) return text;
    text += fmt::format(" The closest is `{}` with {} after {} s", closest->method,
                        least > noise_floor ? percent(std::sqrt(least))
                                            : fmt::format("an error below {}, all that the reference resolves,",
                                                          percent(std::sqrt(noise_floor))),
                        short_number(closest->seconds));
    if (const auto part = largest_part(analysis, methods.at(closest->method), closest->scene, closest->seconds);
        !part.empty())
        text += ", " + part;
    const std::string time = unmeasured_time(*closest, target_errors[target]);
    return text + (time.empty() ? "." : fmt::format("; {} %: {}.", target_names[target], time));
}

/// The floor as relative errors in percent, "2.30 (1.90 to 2.70): bias 1.10, fixed noise 2.02". A floor whose
/// interval reaches 0 is not resolved.
std::string floor_text(const TableRow& row) {
    if (!row.law) return "";
    const auto& [floor, interval] = row.law->floor;
    if (!interval) return floor > 0 ? percent_text(std::sqrt(floor)) : "0";
    const std::string upper = percent_text(std::sqrt(at_least_zero(interval->hi)));
    if (!(interval->lo > 0)) return "below " + upper;
    const double bias2 = floor_bias2(row);
    return fmt::format("{} ({} to {}): bias {}, fixed noise {}", percent_text(std::sqrt(floor)),
                       percent_text(std::sqrt(interval->lo)), upper, percent_text(std::sqrt(bias2)),
                       percent_text(std::sqrt(floor - bias2)));
}

std::string price_list(const Analysis& analysis, const std::vector<const TableRow*>& rows) {
    std::string text = "| method | preparation |";
    for (const char* name : target_names)
        text += fmt::format(" {} % |", name);
    text +=
        " last halving | next halving (extrapolated) | floor % | slope | worst point off the law | MiB |\n|---|---:|";
    for (std::size_t i = 0; i < target_names.size(); ++i)
        text += "---|";
    text += "---|---|---|---|---:|---:|\n";
    for (const TableRow* row : rows) {
        text += fmt::format("| {} | {} |", markdown_text(row->method), short_number(row->prepare_seconds));
        for (std::size_t t = 0; t < target_names.size(); ++t)
            text += fmt::format(" {} |", time_text(analysis, *row, t));
        text += fmt::format(" {} | {} | {} | {} | {} | {:.0f} |\n",
                            row->last_halving ? with_interval(*row->last_halving) : "", next_halving_text(*row),
                            floor_text(*row), row->law ? with_interval(row->law->slope) : "",
                            row->law ? fmt::format("{:.0f} %", 100 * row->law->misfit) : "", row->peak_rss_mib);
    }
    return text;
}

std::string crossover_table(const std::vector<Crossover>& changes) {
    std::string text =
        "\n## When the best method changes\n\nFrom these seconds on the method is closer to the reference than all "
        "others, by 5 % at least before the next change; 95 % intervals over the seeds.\n\n"
        "| scene | from second | method | relative RMSE % there | before |\n|---|---|---|---:|---|\n";
    for (const auto& change : changes)
        text += fmt::format("| {} | {} | {} | {} | {} |\n", markdown_text(change.scene),
                            with_interval({change.seconds, change.interval}), markdown_text(change.method),
                            change.relative_rmse > 0 ? percent_text(change.relative_rmse) : "below the reference's",
                            change.before.empty() ? "no image yet" : markdown_text(change.before));
    return text;
}

}  // namespace

bool is_target_resolved(const Analysis& analysis, const std::string& scene, const std::string& component,
                        std::size_t target) {
    return sqr(target_errors[target]) > analysis.noise_floor(scene, component);
}

std::string next_halving_text(const TableRow& row) {
    if (!row.law || !law_holds(*row.law)) return "";
    const PriceLaw& price = *row.law;
    const auto time = price.extrapolate(price.law.error2(price.last_seconds) / 4);
    if (!time) return "never: floor";
    const double factor = time->seconds / price.last_seconds;
    if (factor > farthest_extrapolation) return fmt::format("over {:.0f}", farthest_extrapolation);
    if (time->at_least) return "at least " + short_number(factor);
    return with_interval(*price.next_halving);
}

std::string unmeasured_time(const TableRow& row, double target) {
    if (!row.law || !law_holds(*row.law)) return "";
    const auto time = row.law->extrapolate(target * target);
    if (!time) return fmt::format("never (floor {})", percent(std::sqrt(row.law->floor.value)));
    // A time within the measured span is no extrapolation: the first image was better already, or the points scatter
    // about the law.
    if (time->seconds <= row.law->last_seconds || time->seconds > farthest_extrapolation * row.law->last_seconds)
        return "";
    return fmt::format("{}{} (extrapolated)", time->at_least ? "at least " : "", short_number(time->seconds));
}

std::vector<PriceAnswer> price_answers(const Analysis& analysis) {
    std::vector<PriceAnswer> answers;
    for (const auto& scene : scenes_of(analysis)) {
        const auto rows = totals_of(analysis, scene);
        const CellsByMethod methods = cells_by_method(analysis, scene);
        if (rows.size() < 2) continue;
        for (const std::size_t target : asked_targets) {
            std::vector<const TableRow*> reached;
            std::copy_if(rows.begin(), rows.end(), std::back_inserter(reached),
                         [&](const TableRow* row) { return row->times[target].has_value(); });
            answers.push_back({scene, target_errors[target],
                               reached.empty()
                                   ? answer_without_winner(analysis, methods, rows, target)
                                   : answer_with_winner(analysis, methods, rows, std::move(reached), target)});
        }
    }
    return answers;
}

std::string price_text(const Analysis& analysis) {
    std::string text;
    const auto answers = price_answers(analysis);
    if (!answers.empty()) text += "\n## Which method is cheapest, and why\n\n";
    for (const auto& answer : answers)
        text += fmt::format("- {}: {}\n", markdown_text(answer.scene), answer.text);
    bool first = true;
    for (const auto& scene : scenes_of(analysis)) {
        const auto rows = totals_of(analysis, scene);
        if (rows.empty()) continue;
        if (first)
            text +=
                "\n## Price list\n\nSeconds until the relative RMSE, the reference's own error subtracted, is at the "
                "percentage above; 95 % intervals over the seeds. The law of the squared error against time t is "
                "floor^2 + c (t - preparation)^-slope; what it says beyond the measured span is marked as "
                "extrapolated. "
                "Halving: the factor by which time grows.\n";
        first = false;
        text += fmt::format("\n### {}\n\n{}", markdown_text(scene), price_list(analysis, rows));
    }
    const auto changes = crossovers(analysis);
    return changes.empty() ? text : text + crossover_table(changes);
}

}  // namespace gib
