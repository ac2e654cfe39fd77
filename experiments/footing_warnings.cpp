#include "experiments/footing_warnings.h"

#include "experiments/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

std::string sentence(const TableRow& row) {
    const Estimate& excess = row.footing->excess;
    const std::string what = fmt::format("{}, {}: `{}`", row.scene, row.method, row.component);
    if (!std::isfinite(excess.value)) return what + " is not finite";
    if (!excess.interval)
        return fmt::format("{} has {:+.2f} % of mean energy against the reference; one seed tells no error", what,
                           100 * excess.value);
    const std::string interval =
        fmt::format("({:+.2f} to {:+.2f})", 100 * excess.interval->lo, 100 * excess.interval->hi);
    if (row.footing->verdict == FootingVerdict::unresolved)
        return fmt::format("{} cannot be told to agree within {:.0f} % in mean energy: {:+.2f} % {}", what,
                           100 * footing_tolerance, 100 * excess.value, interval);
    return fmt::format("{} is too {}: {:+.2f} % {} of mean energy{}", what, excess.value > 0 ? "bright" : "dark",
                       100 * excess.value, interval,
                       row.effects_missing.empty() ? "" : "; the method leaves out " + row.effects_missing);
}

}  // namespace

std::vector<FootingWarning> footing_warnings(const Analysis& analysis) {
    std::vector<FootingWarning> warnings;
    for (const TableRow& row : analysis.rows)
        if (row.footing && row.footing->verdict != FootingVerdict::agrees)
            warnings.push_back(
                {row.scene, row.method, row.component, row.footing->verdict == FootingVerdict::differs, sentence(row)});
    std::stable_partition(warnings.begin(), warnings.end(), [](const auto& w) { return w.differs; });
    return warnings;
}

std::string footing_text(const Analysis& analysis) {
    std::size_t checked = 0;
    for (const TableRow& row : analysis.rows)
        checked += row.footing.has_value();
    if (checked == 0) return "";
    const auto warnings = footing_warnings(analysis);
    const auto differing = static_cast<std::size_t>(
        std::count_if(warnings.begin(), warnings.end(), [](const auto& w) { return w.differs; }));
    std::string text = fmt::format(
        "\n## Equal footing\n\nMean energy against the reference's, 99 % intervals: of {} components {} agree within "
        "{:.0f} %, {} differ, {} cannot be told.\n\n",
        checked, checked - warnings.size(), 100 * footing_tolerance, differing, warnings.size() - differing);
    for (const auto& warning : warnings)
        text += fmt::format("- {}{}.\n", warning.differs ? "Warning: " : "", warning.text);
    return text;
}

}  // namespace gib
