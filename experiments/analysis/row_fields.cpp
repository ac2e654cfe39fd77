#include "experiments/analysis/row_fields.h"

#include "common/core/math.h"
#include "experiments/plan/label_checks.h"
#include "methods/method.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// No time is extrapolated beyond `farthest_extrapolation` times the measured span, or if a point misses the law by
/// more than the share `largest_misfit` of its squared error.
constexpr double farthest_extrapolation = 100, largest_misfit = 0.5;
/// The cost of the last halving is left out if the ends of its interval differ by more than this factor.
constexpr double widest_halving = 30;

/// log(time of the last point / time at which the error was twice as large), for the mean of the runs.
std::optional<double> log_last_halving(const Runs& cells, Layer layer, double noise_floor) {
    std::vector<ErrorPoint> mean;
    for (const MeanPoint& point : mean_curve(cells, layer))
        mean.push_back({point.seconds, sample_mean(point.relative).value});
    if (mean.empty() || !(mean.back().error2 > noise_floor)) return std::nullopt;
    const ErrorPoint end = mean.back();
    for (std::size_t i = mean.size() - 1; i-- > 0;) {
        const ErrorPoint &a = mean[i], &b = mean[i + 1];
        if (!(a.error2 >= 4 * end.error2)) continue;
        const double part = std::log(a.error2 / (4 * end.error2)) / std::log(a.error2 / b.error2);
        return std::log(end.seconds / a.seconds) - part * std::log(b.seconds / a.seconds);
    }
    return std::nullopt;
}

/// A lower bound below this many times the measured span is no more than "not reached".
constexpr double least_bound = 2;
/// Unsampled light is neglected for errors whose squares are this many times as large: it is half a percent of them.
constexpr double unsampled_factor = 100;

/// The field of the time to a squared error by the law, if it is beyond the measured span and not too far; `unit`
/// divides it [s]. A time within the span is no extrapolation: the first image was better already, or the points
/// scatter about the law. The law does not hold for unsampled light.
Field field_of(const TableRow& row, double error2, double unit) {
    const auto not_reached = [](const char* reason) { return Field{.state = State::not_reached, .reason = reason}; };
    if (!row.law) return not_reached("");
    if (row.unsampled >= error2) return not_reached("unsampled light");
    const PriceLaw& law = *row.law;
    const auto time = law.extrapolate(error2, row.is_unbiased);
    if (!time) return not_reached(row.seeds < 3 ? "needs three seeds" : "no law fits");
    if (time->kind == Extrapolation::Kind::never) {
        const bool contradicted = row.statistics && row.statistics->rel_mse_corrected < law.floor.value;
        return contradicted ? not_reached("the runs are below the law's error floor")
                            : Field{State::never, law.floor.value, std::nullopt, Unit::root};
    }
    if (law.misfit > largest_misfit) return not_reached("the law misses points");
    if (!(time->seconds > law.last_seconds)) return not_reached("the law puts it within the runs");
    if (!law_reaches(law, time->seconds)) return not_reached("beyond 100 times the runs");
    const double least = time->interval ? std::max(time->interval->lo, law.last_seconds) : time->seconds;
    if (!time->interval || unsampled_factor * row.unsampled > error2)
        return least > least_bound * law.last_seconds ? Field{State::at_least, least / unit}
                                                      : not_reached("the law gives no bound beyond twice the runs");
    return {State::extrapolated, time->seconds / unit, Interval{least / unit, time->interval->hi / unit}};
}

}  // namespace

std::optional<PriceLaw> price_law_of(const Runs& cells, Layer layer, double noise_floor) {
    std::vector<std::vector<ErrorPoint>> runs(cells.size());
    double start = 0;
    for (const Cell* cell : cells)
        start += cell->prepare_seconds / static_cast<double>(cells.size());
    for (const MeanPoint& point : mean_curve(cells, layer))
        for (std::size_t r = 0; r < runs.size(); ++r)
            runs[r].push_back({point.run_seconds[r], point.relative[r]});
    return fit_price_law(runs, start, noise_floor);
}

std::vector<std::vector<CurvePoint>> error_curves(const Runs& cells, Layer layer) {
    std::vector<std::vector<CurvePoint>> curves;
    for (const Cell* cell : cells) {
        curves.emplace_back();
        for (const auto& [checkpoint, errors] : cell->checkpoints)
            if (const auto error = errors.find(layer); error != errors.end())
                curves.back().push_back(
                    {checkpoint.seconds, std::sqrt(std::max(error->second.rel_mse_corrected, 0.0))});
    }
    return curves;
}

std::optional<Estimate> last_halving(const Runs& cells, Layer layer, double noise_floor) {
    const auto log_factor = log_last_halving(cells, layer, noise_floor);
    if (!log_factor) return std::nullopt;
    Estimate factor{std::exp(*log_factor), std::nullopt};
    std::vector<double> others;
    for (std::size_t r = 0; r < cells.size(); ++r)
        if (const auto other = log_last_halving(without(cells, r), layer, noise_floor)) others.push_back(*other);
    if (others.size() < std::max<std::size_t>(cells.size(), 3)) return factor;
    const Interval logs = *jackknife(*log_factor, others).interval;
    if (logs.hi - logs.lo > std::log(widest_halving)) return std::nullopt;
    factor.interval = Interval{std::exp(std::max(logs.lo, 0.0)), std::exp(logs.hi)};
    return factor;
}

void add_curve_numbers(TableRow& row, const Runs& cells) {
    const auto curves = error_curves(cells, row.layer);
    for (std::size_t t = 0; t < target_errors.size(); ++t) {
        if (!is_target_resolved(t, row.noise_floor)) continue;
        row.times[t] = time_to_error(curves, target_errors[t]);
        row.reached[t] = static_cast<int>(std::ranges::count_if(
            curves, [&](const auto& curve) { return crossing_time(curve, target_errors[t]).has_value(); }));
    }
    row.law = price_law_of(cells, row.layer, row.noise_floor);
    row.last_halving = last_halving(cells, row.layer, row.noise_floor);
}

bool law_reaches(const PriceLaw& law, double seconds) {
    return law.misfit <= largest_misfit && seconds <= farthest_extrapolation * law.last_seconds;
}

Field time_field(const TableRow& row, std::size_t target) {
    if (!row.statistics) return {};
    if (!row.has_times) return {State::no_verdict};
    if (!is_target_resolved(target, row.noise_floor))
        return {.state = State::below_noise, .reason = "this error is below the reference's noise"};
    if (row.times[target]) return measured(*row.times[target]);
    if (row.reached[target] > 0)
        return {State::some_seeds, static_cast<double>(row.reached[target]), std::nullopt, Unit::whole, row.seeds};
    Field field = field_of(row, sqr(target_errors[target]), 1);
    if (field.state != State::not_reached && field.state != State::at_least) return field;
    // A smaller error is not reached earlier than a larger one.
    for (std::size_t t = 0; t < target_errors.size(); ++t) {
        if (!(target_errors[t] > target_errors[target]) || row.times[t] || row.reached[t] > 0) continue;
        const Field larger = field_of(row, sqr(target_errors[t]), 1);
        const double bound = larger.interval ? larger.interval->lo : larger.value;
        if (larger.state != State::at_least && larger.state != State::extrapolated) continue;
        if (bound > std::max(least_bound * row.law->last_seconds, field.state == State::at_least ? field.value : 0))
            field = {State::at_least, bound};
    }
    return field;
}

Field slope_field(const TableRow& row) {
    if (!row.law) return {};
    const Estimate& slope = row.is_unbiased ? row.law->floorless_slope : row.law->slope;
    const double misfit = row.is_unbiased ? row.law->floorless_misfit : row.law->misfit;
    // From three seeds on, a slope that the curve determines has an interval.
    if (misfit > largest_misfit || (!slope.interval && row.seeds > 2)) return {State::inconclusive};
    return measured(slope);
}

Field next_halving_field(const TableRow& row) {
    if (!row.law || !law_reaches(*row.law, row.law->last_seconds)) return {};
    const PriceLaw& law = *row.law;
    const double error2 = (row.is_unbiased ? law.floorless : law.law).error2(law.last_seconds);
    const Field factor = field_of(row, error2 / 4, law.last_seconds);
    // An interval that begins at the end of the runs has no lower end.
    if (factor.interval && !(factor.interval->lo > 1)) return {State::inconclusive};
    return factor.state == State::not_reached ? Field{} : factor;
}

Field floor_field(const TableRow& row) {
    if (!row.law) return {};
    if (row.is_unbiased) return {State::unbiased};
    if (!row.floor_known || !row.law->floor.interval) return {State::inconclusive};
    Estimate floor = row.law->floor;
    // The runs have been below the fitted floor's bound where they scatter.
    if (row.statistics && row.statistics->rel_mse_corrected > floor.value)
        floor.interval->hi = std::min(floor.interval->hi, row.statistics->rel_mse_corrected);
    return positive(floor, Unit::root);
}

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
    if (!row.statistics) return {State::no_verdict};
    return resolved(*corrected_rel_mse(row), row.noise_floor);
}

Field corrected_mse_field(const TableRow& row) {
    if (!row.statistics || !std::isfinite(row.statistics->rmse_corrected)) return {};
    return measured(sqr(row.statistics->rmse_corrected));
}

Field bias2_field(const TableRow& row) {
    if (!row.statistics || !row.statistics->bias2) return {};
    return row.is_unbiased ? Field{State::unbiased} : positive(*row.statistics->bias2);
}

double unsampled_share(const TableRow& row) {
    constexpr double least = 0.1;
    if (!row.statistics || !(row.statistics->rel_mse_corrected > 0)) return 0;
    const double share = row.unsampled / row.statistics->rel_mse_corrected;
    return share < least ? 0 : std::min(share, 1.0);
}

Field variance_field(const TableRow& row) {
    if (!row.statistics || !row.statistics->variance) return {};
    return unsampled_share(row) > 0 ? Field{State::inconclusive} : measured(*row.statistics->variance);
}

Field bias_share_field(const TableRow& row) {
    if (!row.statistics) return {};
    if (row.is_unbiased) return {State::unbiased};
    const auto& bias2 = row.statistics->rel_bias2;
    if (!bias2 || !bias2->interval) return {State::inconclusive};
    const double variance = row.statistics->rel_mse_corrected - bias2->value;
    const double sum = std::max(bias2->value, 0.0) + std::max(variance, 0.0);
    if (!(sum > 0) || !std::isfinite(sum)) return {};
    const auto share = [sum](double part) { return std::clamp(part / sum, 0.0, 1.0); };
    constexpr double whole = 0.995;  // "below 100 %" says nothing
    if (!(bias2->interval->lo > 0) && share(bias2->interval->hi) >= whole) return {State::inconclusive};
    return positive({share(bias2->value), Interval{share(bias2->interval->lo), share(bias2->interval->hi)}},
                    Unit::share);
}

bool is_unbiased_by_theory(const TableRow& row, const Components& components_left_out) {
    const MethodLabel label = MethodLabel::parse(row.method);
    const auto& methods = method_registry();
    const auto method = std::ranges::find_if(methods, [&](const auto& m) { return m.name == label.name; });
    if (method == methods.end() || !method->unbiased || !row.effects_missing.empty() || row.nonfinite > 0) return false;
    if (std::ranges::any_of(label.values, [](const auto& v) { return v.first == "max_depth"; })) return false;
    if (!filter_of(label).empty()) return false;
    return !components_left_out.touches(row.layer);
}

}  // namespace gib
