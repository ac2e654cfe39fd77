#include "experiments/report/error_words.h"

#include "experiments/analysis/error_fields.h"
#include "experiments/analysis/left_out.h"
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

}  // namespace

std::string left_out(const TableRow& row) { return words_of({row.effects_missing, row.components_missing}); }

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

}  // namespace gib
