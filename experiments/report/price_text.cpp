#include "experiments/report/price_text.h"

#include "common/core/math.h"
#include "experiments/report/error_words.h"
#include "experiments/text/numbers.h"
#include "experiments/text/spaced.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// No time is extrapolated beyond `farthest_extrapolation` times the measured span, or if a point misses the law by
/// more than the share `largest_misfit` of its squared error.
constexpr double farthest_extrapolation = 100, largest_misfit = 0.5;

/// Whether a law describes its points well enough to be extrapolated.
bool law_holds(const PriceLaw& law) { return law.misfit <= largest_misfit; }

/// time_text() of a target that is resolved and that no run has reached.
std::string unmeasured_time(const TableRow& row, double target) {
    if (!row.law || !law_holds(*row.law)) return "not reached";
    const auto time = row.law->extrapolate(target * target);
    if (!time) return fmt::format("never (floor {} %)", percent_text(std::sqrt(row.law->floor.value)));
    // A time within the measured span is no extrapolation: the first image was better already, or the points scatter
    // about the law.
    if (time->seconds <= row.law->last_seconds || time->seconds > farthest_extrapolation * row.law->last_seconds)
        return "not reached";
    return fmt::format("{}{} (extrapolated)", time->at_least ? "at least " : "", short_number(time->seconds));
}

std::vector<const TableRow*> totals_of(const Analysis& analysis, const std::string& scene) {
    std::vector<const TableRow*> rows;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.component == total_name && row.statistics) rows.push_back(&row);
    return rows;
}

/// Names that are separated by `;`, as in "`caustic`, `indirect`".
std::string quoted(const std::string& names) {
    std::string text = "`";
    for (const char c : names)
        text += c == ';' ? std::string("`, `") : std::string(1, c);
    return text + "`";
}

double final_error2(const CellsByMethod& methods, const TableRow& row) {
    return mean_error2_after(methods.at(row.method), total_name, INFINITY).value_or(INFINITY);
}

bool overlap(const Estimate& a, const Estimate& b) {
    return !a.interval || !b.interval || (a.interval->lo <= b.interval->hi && b.interval->lo <= a.interval->hi);
}

/// A text with the components' shares of the sum of their squared errors after `seconds`, largest first, without those
/// below half a percent; empty if there is none.
std::string parts_of_error(const Analysis& analysis, const std::vector<const Cell*>& cells, const std::string& scene,
                           double seconds) {
    double sum = 0;
    std::vector<std::pair<double, std::string>> parts;
    for (const auto& component : components_of(analysis, scene)) {
        if (component == total_name) continue;
        const auto error2 = mean_error2_after(cells, component, seconds);
        if (!error2 || !(*error2 > 0)) continue;
        sum += *error2;
        parts.emplace_back(*error2, component);
    }
    std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::string text;
    for (const auto& [error2, component] : parts)
        if (error2 >= 0.005 * sum)
            text += fmt::format(", {:.0f} % {}in `{}`", 100 * error2 / sum, text.empty() ? "of its squared error " : "",
                                component);
    return text;
}

std::string in_brackets(const std::string& text) { return text.empty() ? "" : " (" + text + ")"; }

/// Says how large the error of a method is after `seconds` (if infinite: that of its final images, as in the table of
/// errors), which component has most of it, what the method leaves out and, if `with_time`, when it reaches the target:
/// why it is behind one that has reached the target by then.
std::string what_keeps(const Analysis& analysis, const CellsByMethod& methods, const TableRow& row, std::size_t target,
                       double seconds, bool with_time) {
    const auto& cells = methods.at(row.method);
    std::string text =
        fmt::format("fter {} s `{}` has ", short_number(std::isinf(seconds) ? row.seconds : seconds), row.method);
    if (const auto error = relative_rmse_after(cells, total_name, seconds, row.noise_floor))
        text += percent_text(*error) + " %" + parts_of_error(analysis, cells, row.scene, seconds) +
                in_brackets(error_kind(row));
    else if (mean_error2_after(cells, total_name, seconds)) text += "an error below what the reference resolves";
    else text += "no image yet";
    if (!row.effects_missing.empty()) text += ", leaves out " + spaced(row.effects_missing);
    if (!row.components_missing.empty()) text += ", leaves out light of " + quoted(row.components_missing);
    const std::string time = with_time ? time_text(row, target) : "";
    return text + (time.empty() ? "." : fmt::format("; seconds to {} %: {}.", target_names[target], time));
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
    if (const std::string kind = error_kind(winner); !kind.empty()) text += fmt::format(" Its error: {}.", kind);
    if (reached.size() > 1) {
        const TableRow& next = *reached[1];
        text += fmt::format(" `{}` takes {} times as long{}.", next.method,
                            short_number(next.times[target]->value / seconds),
                            overlap(*winner.times[target], *next.times[target]) ? " (the intervals overlap)" : "");
    }
    for (const TableRow* other : best_of_other_names(rows, winner, target, methods, seconds))
        text +=
            " A" + what_keeps(analysis, methods, *other, target, seconds, reached.size() < 2 || other != reached[1]);
    return text;
}

std::string answer_without_winner(const Analysis& analysis, const CellsByMethod& methods,
                                  const std::vector<const TableRow*>& rows, std::size_t target) {
    if (!is_target_resolved(target, rows.front()->noise_floor))
        return fmt::format("The reference does not resolve {} %, only {} %.", target_names[target],
                           percent_text(std::sqrt(rows.front()->noise_floor)));
    const TableRow& closest = *closest_row(analysis, rows.front()->scene);
    const bool any_reached =
        std::any_of(rows.begin(), rows.end(), [&](const TableRow* row) { return row->times[target].has_value(); });
    return fmt::format("No method {}reached {} %. Closest: a{}", any_reached ? "with all light of the scene " : "",
                       target_names[target], what_keeps(analysis, methods, closest, target, INFINITY, true));
}

}  // namespace

bool reaches(const TableRow& row, std::size_t target) {
    return row.times[target].has_value() && row.effects_missing.empty() && row.components_missing.empty();
}

const TableRow* closest_row(const Analysis& analysis, const std::string& scene) {
    const CellsByMethod methods = cells_by_method(analysis, scene);
    const auto rank = [&](const TableRow& row) {
        const bool incomplete = !row.effects_missing.empty() || !row.components_missing.empty();
        return std::pair(incomplete, final_error2(methods, row));
    };
    const TableRow* closest = nullptr;
    for (const TableRow* row : totals_of(analysis, scene))
        if (!closest || rank(*row) < rank(*closest)) closest = row;
    return closest;
}

std::string time_text(const TableRow& row, std::size_t target) {
    if (!row.statistics) return "";
    if (!is_target_resolved(target, row.noise_floor)) return "not resolved";
    return row.times[target] ? with_interval(*row.times[target]) : unmeasured_time(row, target_errors[target]);
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

std::optional<Estimate> next_halving(const TableRow& row) {
    if (!row.law || !law_holds(*row.law) || !row.law->next_halving) return std::nullopt;
    return row.law->next_halving->value > farthest_extrapolation ? std::nullopt : row.law->next_halving;
}

std::vector<PriceAnswer> price_answers(const Analysis& analysis) {
    std::vector<PriceAnswer> answers;
    for (const auto& scene : scenes_of(analysis)) {
        const auto rows = totals_of(analysis, scene);
        const CellsByMethod methods = cells_by_method(analysis, scene);
        if (const std::string unjudged = analysis.unjudged(scene); !unjudged.empty() && methods.size() > 1) {
            answers.push_back({scene, "No method is the cheapest: the reference does not judge the light of " +
                                          quoted(unjudged) + "."});
            continue;
        }
        if (rows.size() < 2) continue;
        for (const std::size_t target : asked_targets) {
            std::vector<const TableRow*> reached;
            std::copy_if(rows.begin(), rows.end(), std::back_inserter(reached),
                         [&](const TableRow* row) { return reaches(*row, target); });
            answers.push_back({scene, reached.empty()
                                          ? answer_without_winner(analysis, methods, rows, target)
                                          : answer_with_winner(analysis, methods, rows, std::move(reached), target)});
        }
    }
    return answers;
}

}  // namespace gib
