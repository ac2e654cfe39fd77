#include "experiments/report/look_words.h"

#include "experiments/report/error_words.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gib {

namespace {

std::vector<const TableRow*> rows_of(const Analysis& analysis, const EqualTimeLook& look) {
    std::vector<const TableRow*> rows;
    for (const TableRow& row : analysis.rows)
        if (row.scene == look.scene && row.method == look.method) rows.push_back(&row);
    return rows;
}

std::string error_text(const EqualTimeLook& look, const TableRow& total) {
    if (!total.statistics) return "not judged";
    if (!look.error2) return "no image yet";
    if (*look.error2 <= total.noise_floor) return fmt::format("below {}", percent_text(std::sqrt(total.noise_floor)));
    return percent_text(std::sqrt(*look.error2));
}

/// The components whose mean energy differs from the reference's, "total, caustic".
std::string different_energy(const std::vector<const TableRow*>& rows) {
    std::string names;
    for (const TableRow* row : rows)
        if (row->footing && row->footing->verdict == FootingVerdict::differs)
            names += (names.empty() ? "" : ", ") + row->component;
    return names;
}

/// Orders looks: those with all light first, then by error.
std::pair<bool, double> rank(const EqualTimeLook& look, const TableRow& total) {
    const bool incomplete = !total.effects_missing.empty() || !total.components_missing.empty();
    return {incomplete, look.error2.value_or(std::numeric_limits<double>::infinity())};
}

}  // namespace

std::vector<LookWords> look_words(const Analysis& analysis, const std::string& scene) {
    std::vector<std::pair<std::pair<bool, double>, LookWords>> ranked;
    for (const EqualTimeLook& look : analysis.looks) {
        if (look.scene != scene) continue;
        const auto rows = rows_of(analysis, look);
        const auto found =
            std::find_if(rows.begin(), rows.end(), [](const auto* r) { return r->component == total_name; });
        if (found == rows.end()) continue;
        const TableRow& total = **found;
        LookWords words{.look = look, .error = error_text(look, total), .kind = error_kind(total)};
        if (look.flip) words.flip = fmt::format("{:.3f}", *look.flip);
        words.missing = left_out(total);
        words.energy = different_energy(rows);
        words.shown = fmt::format("{}{} pass{}, {} s", look.is_final ? "final image, " : "", look.passes,
                                  look.passes == 1 ? "" : "es", short_number(look.image_seconds));
        ranked.emplace_back(rank(look, total), std::move(words));
    }
    std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<LookWords> all;
    for (auto& [key, words] : ranked)
        all.push_back(std::move(words));
    return all;
}

}  // namespace gib
