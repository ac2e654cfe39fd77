#include "experiments/analysis/error_fields.h"

#include "experiments/plan/filter_label.h"
#include "methods/method.h"

#include <algorithm>
#include <cmath>

namespace gib {

double least_resolved(const ReferenceLayer& layer, const Denominators& denominators) {
    const double variance = denominators.variance_of(layer).variance.variance;
    const double floor = noise_floor_of(layer, denominators);
    return std::isfinite(variance) ? std::max(floor, 2 * std::sqrt(variance)) : floor;
}

std::optional<Estimate> corrected_rel_mse(const TableRow& row) {
    if (!row.statistics) return std::nullopt;
    const auto& s = *row.statistics;
    const double own = s.rel_mse.value - s.rel_mse_corrected;
    Estimate corrected{s.rel_mse_corrected, std::nullopt};
    if (s.rel_mse.interval) corrected.interval = Interval{s.rel_mse.interval->lo - own, s.rel_mse.interval->hi - own};
    return corrected;
}

Field relative_error_field(const TableRow& row) {
    if (!row.statistics) return {State::not_judged};
    return resolved(*corrected_rel_mse(row), row.noise_floor);
}

Field bias2_field(const TableRow& row) {
    if (!row.statistics || !row.statistics->bias2) return {};
    return row.is_unbiased ? Field{State::unbiased} : positive(*row.statistics->bias2);
}

Field bias_share_field(const TableRow& row) {
    if (!row.statistics) return {};
    if (row.is_unbiased) return {State::unbiased};
    const auto& [bias2, variance] = std::pair(row.statistics->bias2, row.statistics->variance);
    if (!bias2 || !variance || !bias2->interval) return {State::cannot_be_told};
    const double sum = std::max(bias2->value, 0.0) + std::max(variance->value, 0.0);
    if (!(sum > 0) || !std::isfinite(sum)) return {};
    const auto share = [sum](double part) { return std::clamp(part / sum, 0.0, 1.0); };
    if (!(bias2->interval->lo > 0) && share(bias2->interval->hi) >= 1) return {State::cannot_be_told};
    return positive({share(bias2->value), Interval{share(bias2->interval->lo), share(bias2->interval->hi)}},
                    Unit::share);
}

bool is_unbiased(const TableRow& row, const Components& components_left_out) {
    const MethodLabel label = MethodLabel::parse(row.method);
    const auto& methods = method_registry();
    const auto method = std::ranges::find_if(methods, [&](const auto& m) { return m.name == label.name; });
    if (method == methods.end() || !method->unbiased || !row.effects_missing.empty() || row.nonfinite > 0) return false;
    if (std::ranges::any_of(label.values, [](const auto& v) { return v.first == "max_depth"; })) return false;
    if (!filter_of(label).empty()) return false;
    return !components_left_out.touches(row.layer);
}

}  // namespace gib
