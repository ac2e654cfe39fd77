#include "experiments/analysis/footing_warnings.h"

#include "experiments/analysis/left_out.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace gib {

namespace {

/// A share in percent with its interval, as in "-0.40 % (-3.10 to +2.30)".
std::string signed_percent(const Estimate& e) {
    return fmt::format("{:+.2f} %", 100 * e.value) +
           (e.interval ? fmt::format(" ({:+.2f} to {:+.2f})", 100 * e.interval->lo, 100 * e.interval->hi) : "");
}

std::string component_text(const TableRow& row) {
    const Estimate& excess = row.footing->excess;
    return fmt::format("`{}` {}", name_of(row.layer),
                       std::isfinite(excess.value) ? signed_percent(excess) : "is not finite");
}

/// The two rows that differ most surely from each other, among
/// the rows of one component that the reference cannot judge.
struct Disagreement {
    const TableRow *more = nullptr, *less = nullptr;
    Estimate difference;  ///< with an interval
    double sureness = 0;  ///< difference / half the width of its interval
};

void consider(const TableRow& a, const TableRow& b, std::optional<Disagreement>& surest) {
    const Footing pair = a.footing->against(*b.footing);
    if (pair.verdict != FootingVerdict::differs || !pair.excess.interval) return;
    if (pair.excess.value < 0) return consider(b, a, surest);
    const double half = pair.excess.interval->hi - pair.excess.value;
    const double sureness = half > 0 ? pair.excess.value / half : std::numeric_limits<double>::infinity();
    if (!surest || sureness > surest->sureness)
        surest = Disagreement{.more = &a, .less = &b, .difference = pair.excess, .sureness = sureness};
}

/// The rows that the reference cannot judge, by scene and component.
using UnresolvedRows = std::map<std::pair<std::string, Layer>, std::vector<const TableRow*>>;

std::vector<Warning> disagreements(const UnresolvedRows& groups) {
    std::vector<Warning> warnings;
    for (const auto& [key, rows] : groups) {
        std::optional<Disagreement> surest;
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                consider(*rows[i], *rows[j], surest);
        if (!surest) continue;
        warnings.push_back(
            {.kind = Warning::Kind::energy_differs,
             .scene = key.first,
             .layer = key.second,
             .sentence = fmt::format(
                 "`{}` differs between methods where the reference cannot judge: {} has {} of mean energy over {}",
                 name_of(key.second), surest->more->method, signed_percent(surest->difference), surest->less->method)});
    }
    return warnings;
}

}  // namespace

std::vector<Warning> footing_warnings(const Analysis& analysis) {
    std::vector<Warning> differing;
    UnresolvedRows groups;
    const TableRow* last = nullptr;
    for (const TableRow& row : analysis.rows) {
        // A method that leaves out light of the component differs for a reason that is known; equal images tell nothing, nor do
        // those that have not met some light.
        if (row.has_verdict(FootingVerdict::unresolved) && row.effects_missing.empty() &&
            !row.components_missing.touches(row.layer) && row.footing->excess.interval && !row.footing->misses_light)
            groups[{row.scene, row.layer}].push_back(&row);
        if (!row.has_verdict(FootingVerdict::differs)) continue;
        // Rows of one method are joined in one sentence.
        if (last && last->scene == row.scene && last->method == row.method)
            differing.back().sentence += ", " + component_text(row);
        else
            differing.push_back(
                {.kind = Warning::Kind::energy_differs,
                 .scene = row.scene,
                 .sentence = fmt::format(
                     "{}{} differs from the reference in mean energy: {}", row.method,
                     row.effects_missing.empty() ? "" : ", which leaves out " + words_of(row.effects_missing) + ",",
                     component_text(row))});
        last = &row;
    }
    for (auto& warning : disagreements(groups))
        differing.push_back(std::move(warning));
    return differing;
}

}  // namespace gib
