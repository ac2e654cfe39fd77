#include "experiments/report/error_words.h"

#include "experiments/text/numbers.h"
#include "experiments/text/spaced.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

std::string percent(double share) {
    const double value = 100 * std::clamp(share, 0.0, 1.0);
    return value > 0 && value < 1 ? fmt::format("{:.1g}", value) : fmt::format("{:.0f}", value);
}

}  // namespace

std::string left_out(const TableRow& row) {
    const std::string effects = spaced(row.effects_missing);
    if (row.components_missing.empty()) return effects;
    return effects + (effects.empty() ? "" : "; ") + "light of " + spaced(row.components_missing);
}

std::string error_kind(const TableRow& row) {
    if (!row.statistics) return "";
    if (row.is_unbiased) return "noise: the method is unbiased";
    const auto& [bias2, variance] = std::pair(row.statistics->bias2, row.statistics->variance);
    if (!bias2 || !variance || !bias2->interval) return "bias or noise: two seeds would tell";
    const double sum = at_least_zero(bias2->value) + at_least_zero(variance->value);
    if (!(sum > 0) || !std::isfinite(sum)) return "";
    const double share = bias2->value / sum, lo = bias2->interval->lo / sum, hi = bias2->interval->hi / sum;
    if (lo > 0 && share < 0.5)
        return fmt::format("noise; bias is {} % of the squared error, {} to {}", percent(share), percent(lo),
                           percent(hi));
    if (lo > 0)
        return fmt::format("bias: {} % of the squared error, {} to {}", percent(share), percent(lo), percent(hi));
    if (hi < 0.5) return fmt::format("noise; bias below {} % of the squared error", percent(hi));
    if (hi < 1) return fmt::format("bias or noise: not resolved, bias below {} % of the squared error", percent(hi));
    return "bias or noise: not resolved";
}

}  // namespace gib
