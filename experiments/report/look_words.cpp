#include "experiments/report/look_words.h"

#include "experiments/analysis/contest.h"
#include "experiments/report/error_words.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>

namespace gib {

namespace {

Field error_of(const Contender& c, const TableRow& total) {
    if (c.logs.empty()) return {State::no_image, c.first_image};
    return total.statistics ? resolved({c.mean, {}}, total.noise_floor) : Field{State::not_judged};
}

/// The layers whose mean energy differs from the reference's, "total, caustic".
std::string different_energy(const Analysis& analysis, const EqualTimeLook& look) {
    std::string names;
    for (const TableRow& row : analysis.rows)
        if (row.scene == look.scene && row.method == look.method && row.has_verdict(FootingVerdict::differs))
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

SceneLook scene_look(const Analysis& analysis, const std::string& scene) {
    const Contest contest(analysis, scene);
    if (contest.methods() == 0) return {};
    SceneLook all{contest.equal_time()};
    const auto ranking = contest.after(all.seconds);
    const bool has_best = contest.is_judged() && ranking.size() > 1;
    for (const Contender& c : ranking) {
        const auto look = std::ranges::find_if(analysis.looks,
                                               [&](const auto& l) { return l.scene == scene && l.method == c.method; });
        const TableRow* total = analysis.row(scene, c.method, Layer::total);
        if (look == analysis.looks.end() || !total) continue;
        const bool is_late = c.standing == Standing::no_image;
        all.methods.push_back(
            {.look = *look,
             .standing = has_best || is_late ? c.standing : Standing::open,
             .error = error_of(c, *total),
             .beside = has_best ? beside_text(ranking, c) : "",
             .flip = look->flip && !is_late ? measured(*look->flip) : Field{},
             .kind = error_kind(*total),
             .missing = left_out(*total),
             .energy = different_energy(analysis, *look),
             .shown = fmt::format("{}{} pass{}, {} s", look->is_final ? "final image, " : "", look->passes,
                                  look->passes == 1 ? "" : "es", short_number(look->seconds))});
    }
    return all;
}

}  // namespace gib
