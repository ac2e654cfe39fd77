#include "experiments/report/words.h"

#include "experiments/analysis/contest.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/analysis/table_row.h"
#include "experiments/report/field_text.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>

namespace gib {

namespace {

/// "`a`, `b` and 3 more"
std::string named(const std::vector<std::string>& methods) {
    constexpr std::size_t most = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(most, methods.size()); ++i)
        text += fmt::format("{}`{}`", i > 0 ? ", " : "", methods[i]);
    return methods.size() > most ? fmt::format("{} and {} more", text, methods.size() - most) : text;
}

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

std::string left_out(const TableRow& row) {
    const std::string effects = words_of(row.effects_missing);
    if (row.components_missing.empty()) return effects;
    return effects + (effects.empty() ? "" : "; ") + "light of " + words_of(row.components_missing);
}

std::string error_kind(const TableRow& row) {
    const Field share = bias_share_field(row);
    const auto [value, detail] = text_of(share, " %");
    switch (share.state) {
        case State::unbiased:
            return "noise: the method is unbiased";
        case State::below:
            // The scatter of few seeds may put the whole interval below zero.
            if (share.value < 0.005) return "noise; no bias found";
            return fmt::format("{}bias {} of the squared error",
                               share.value < 0.5 ? "noise; " : "bias or noise: not resolved, ", value);
        case State::measured:
            return share.interval->lo >= 0.5 ? fmt::format("bias: {} of the squared error, {}", value, detail)
                                             : fmt::format("{}noise; bias is {} of the squared error, {}",
                                                           share.interval->hi < 0.5 ? "" : "bias and ", value, detail);
        case State::cannot_be_told:
            return row.statistics->bias2 && row.statistics->bias2->interval ? "bias or noise: not resolved"
                                                                            : "bias or noise: two seeds would tell";
        default:
            return "";
    }
}

std::string words_of(const Doubts& doubts) {
    std::string text;
    if (!doubts.ties.empty()) text = doubts.one_seed ? "one seed does not tell" : "tie with " + named(doubts.ties);
    if (!doubts.open.empty()) text += (text.empty() ? "not run longer: " : "; not run longer: ") + named(doubts.open);
    return text;
}

std::string doubts(const std::vector<Contender>& ranking) {
    const Contender* best = best_of(ranking);
    return best ? words_of(doubts_about(best->method, ranking)) : "";
}

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
