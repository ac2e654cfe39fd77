#include "experiments/report/look_words.h"

#include "experiments/analysis/contest.h"
#include "experiments/report/error_words.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>

namespace gib {

namespace {

Field error_of(const EqualTimeLook& look, const TableRow& total) {
    if (!look.error2) return {State::no_image, look.first_seconds};
    if (!total.statistics) return {State::not_judged};
    if (*look.error2 <= total.noise_floor) return {State::not_resolved, total.noise_floor, std::nullopt, Unit::root};
    return measured(*look.error2, Unit::root);
}

/// The layers whose mean energy differs from the reference's, "total, caustic".
std::string different_energy(const Analysis& analysis, const EqualTimeLook& look) {
    std::string names;
    for (const TableRow& row : analysis.rows)
        if (row.scene == look.scene && row.method == look.method && row.footing &&
            row.footing->verdict == FootingVerdict::differs)
            names += (names.empty() ? "" : ", ") + std::string(name_of(row.layer));
    return names;
}

std::string beside_text(const std::vector<Contender>& ranking, const Contender& c) {
    switch (c.standing) {
        case Standing::best: {
            const std::string doubt = doubts(ranking);
            return doubt.empty() ? "best" : "best, " + doubt;
        }
        case Standing::tie:
            return "tie with the best";
        case Standing::open:
            return "not run longer";
        case Standing::incomplete:
            return "leaves out light";
        default:
            return "";
    }
}

}  // namespace

std::vector<LookWords> look_words(const Analysis& analysis, const std::string& scene) {
    std::vector<LookWords> all;
    const Contest contest(analysis, scene);
    if (contest.methods() == 0) return all;
    const auto ranking = contest.after(contest.equal_time());
    for (const Contender& c : ranking) {
        const auto look = std::find_if(analysis.looks.begin(), analysis.looks.end(),
                                       [&](const auto& l) { return l.scene == scene && l.method == c.method; });
        const TableRow* total = analysis.row(scene, c.method, Layer::total);
        if (look == analysis.looks.end() || !total) continue;
        LookWords words{.look = *look, .error = error_of(*look, *total), .kind = error_kind(*total)};
        if (contest.is_judged() && ranking.size() > 1) {
            words.beside = beside_text(ranking, c);
            words.is_best = c.standing == Standing::best;
            words.is_tie = c.standing == Standing::tie;
        }
        if (look->flip && look->error2) words.flip = measured(*look->flip);
        words.missing = left_out(*total);
        words.energy = different_energy(analysis, *look);
        words.shown = fmt::format("{}{} pass{}, {} s", look->is_final ? "final image, " : "", look->passes,
                                  look->passes == 1 ? "" : "es", short_number(look->image_seconds));
        all.push_back(std::move(words));
    }
    return all;
}

}  // namespace gib
