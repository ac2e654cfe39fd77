#include "experiments/report_summary.h"

#include "experiments/comparison.h"
#include "experiments/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

const TableRow* row_of(const Analysis& analysis, const std::string& scene, const std::string& method,
                       const std::string& component) {
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.method == method && row.component == component) return &row;
    return nullptr;
}

std::string seconds_text(const Estimate& e) {
    return e.interval ? fmt::format("{} s ({} to {})", short_number(e.value), short_number(e.interval->lo),
                                    short_number(e.interval->hi))
                      : short_number(e.value) + " s";
}

/// Share of bias in the squared error; 0 where it is not known, or not told from none.
double bias_share(const TableRow& row) {
    const auto& s = row.statistics;
    if (!s || !s->bias2 || !(s->mse.value > 0) || (s->bias2->interval && !(s->bias2->interval->lo > 0))) return 0;
    return std::clamp(s->bias2->value / s->mse.value, 0.0, 1.0);
}

/// The component with the largest part of a method's squared error.
const TableRow* worst_component(const Analysis& analysis, const std::string& scene, const std::string& method) {
    const TableRow* worst = nullptr;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.method == method && row.component != total_name && row.statistics &&
            std::isfinite(row.statistics->rel_mse_corrected) &&
            (!worst || row.statistics->rel_mse_corrected > worst->statistics->rel_mse_corrected))
            worst = &row;
    return worst;
}

/// What a method's error is made of: "noise, 93 % of it in caustic".
std::string makeup(const Analysis& analysis, const std::string& scene, const std::string& method) {
    const TableRow* total = row_of(analysis, scene, method, total_name);
    if (!total || !total->statistics) return "not known";
    const double bias = bias_share(*total);
    std::string text = !total->statistics->bias2 ? "noise or bias"
                       : bias > 0.5 ? fmt::format("mostly bias ({:.0f} % of the squared error)", 100 * bias)
                       : bias > 0.1 ? fmt::format("noise, and {:.0f} % bias", 100 * bias)
                                    : "noise";
    const TableRow* worst = worst_component(analysis, scene, method);
    const double whole = total->statistics->rel_mse_corrected;
    if (worst && whole > 0)
        text += fmt::format(", {:.0f} % of it in {}", 100 * std::min(1.0, worst->statistics->rel_mse_corrected / whole),
                            worst->component);
    return text;
}

/// "after 2.1 s, its error in caustic is 6.1 times as large": where two methods differ most at equal time.
std::string largest_difference(const Analysis& analysis, const std::string& scene, const std::string& best,
                               const std::string& other) {
    const TableRow* worst = worst_component(analysis, scene, other);
    if (!worst) return "";
    for (const EqualTimeRow& row : equal_time_rows(analysis)) {
        if (row.scene != scene || row.component != worst->component) continue;
        double of_best = 0, of_other = 0;
        for (const auto& entry : row.entries) {
            if (entry.method == best) of_best = entry.relative_rmse;
            if (entry.method == other) of_other = entry.relative_rmse;
        }
        if (of_best > 0 && of_other > 1.1 * of_best)
            return fmt::format("; after {} s its error in {} is {} times as large", short_number(row.seconds),
                               row.component, short_number(of_other / of_best));
    }
    return "";
}

/// `targets`: their names.
std::string none_reaches(const Analysis& analysis, const std::string& scene, const std::string& targets) {
    const TableRow* best = nullptr;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.component == total_name && row.statistics &&
            std::isfinite(row.statistics->rel_mse.value) &&
            (!best || row.statistics->rel_mse.value < best->statistics->rel_mse.value))
            best = &row;
    if (!best) return fmt::format("{} %: nothing was measured.", targets);
    return fmt::format("{} %: no method gets there. The closest is {} with {} % after {} s; its error is {}.", targets,
                       best->method, percent_text(std::sqrt(best->statistics->rel_mse.value)),
                       short_number(best->seconds), makeup(analysis, scene, best->method));
}

}  // namespace

std::vector<Offer> offers(const Analysis& analysis, const std::string& scene, std::size_t target) {
    std::vector<Offer> found;
    for (const TableRow& row : analysis.rows)
        if (row.scene == scene && row.component == total_name && row.times[target])
            found.push_back({row.method, *row.times[target]});
    std::stable_sort(found.begin(), found.end(),
                     [](const Offer& a, const Offer& b) { return a.seconds.value < b.seconds.value; });
    return found;
}

std::vector<std::string> cheapest_sentences(const Analysis& analysis, const std::string& scene,
                                            const std::vector<std::size_t>& targets) {
    std::vector<std::string> sentences;
    std::string never;
    for (const std::size_t t : targets)
        if (offers(analysis, scene, t).empty())
            never += (never.empty() ? "" : " % and ") + std::string(target_names[t]);
        else sentences.push_back(cheapest_sentence(analysis, scene, t));
    if (!never.empty()) sentences.push_back(none_reaches(analysis, scene, never));
    return sentences;
}

std::string cheapest_sentence(const Analysis& analysis, const std::string& scene, std::size_t target) {
    const auto found = offers(analysis, scene, target);
    if (found.empty()) return none_reaches(analysis, scene, target_names[target]);
    const Offer& best = found.front();
    std::string text =
        fmt::format("{} %: {} is cheapest, {}.", target_names[target], best.method, seconds_text(best.seconds));
    if (found.size() == 1) return text + " No other method gets there.";
    const Offer& next = found[1];
    const bool apart =
        best.seconds.interval && next.seconds.interval && best.seconds.interval->hi < next.seconds.interval->lo;
    text += fmt::format(" Next is {} with {}, {} times as long{}. Why: the error of {} is {}{}.", next.method,
                        short_number(next.seconds.value) + " s", short_number(next.seconds.value / best.seconds.value),
                        apart || !best.seconds.interval ? "" : " (the intervals overlap: this may be chance)",
                        next.method, makeup(analysis, scene, next.method),
                        largest_difference(analysis, scene, best.method, next.method));
    if (best.method != next.method)
        text += fmt::format(" That of {} is {}.", best.method, makeup(analysis, scene, best.method));
    return text;
}

}  // namespace gib
