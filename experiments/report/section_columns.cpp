#include "experiments/report/section_columns.h"

#include <cmath>

namespace gib {

namespace {

using RowRef = const TableRow&;

Field low_frequencies_field(RowRef row) {
    if (!row.noise) return {};
    // The estimate of a power is unbiased, and may be negative where there is little.
    return row.noise->low_ratio > 0 ? measured(row.noise->low_ratio) : Field{State::below_noise};
}

/// An error that ignores outliers, of images whose error is that of few pixels.
template <auto member, Unit unit>
Field robust_field(RowRef row) {
    if (row.layer != Layer::total || !row.robust || !is_decided_by_outliers(*row.robust)) return {};
    const double value = (*row.robust).*member;
    return std::isfinite(value) ? measured(value, unit) : Field{};
}

Field misfit_field(RowRef row) {
    return row.law ? measured(row.is_unbiased ? row.law->floorless_misfit : row.law->misfit, Unit::share) : Field{};
}

}  // namespace

std::string SectionColumn::meaning() const {
    if (!sentence.empty()) return sentence;
    for (const RowColumn& c : row_columns())
        if (c.name == column) return c.sentence;
    return "";
}

const std::vector<SectionColumn>& section_columns() {
    static const std::vector<SectionColumn> columns = {
        {in_errors, "seconds", "seconds", [](RowRef r) { return measured(r.seconds); }},
        {in_errors, "relative RMSE %", "rel_mse_corrected", relative_error_field,
         "root of the mean of (x - r)^2 / (r^2 + epsilon) over pixels and channels. Components are divided by the r^2 "
         "+ "
         "epsilon of the total"},
        {in_noise, "mean squared error [radiance^2]", "", corrected_mse_field, "of bias^2 and variance"},
        {in_noise, "bias^2 [radiance^2]", "bias2", bias2_field,
         "part of the mean squared error that remains when many seeds are averaged"},
        {in_noise, "variance [radiance^2]", "variance", variance_field},
        {in_noise, "share of bias^2 %", "", bias_share_field, "share of bias^2 in the square of the relative RMSE"},
        {in_errors, "bias or noise", "", error_kind,
         "whether averaging many images would remove the error: noise yes, bias no. The percentage is the share of "
         "bias^2; its interval is in the table of bias and noise. A method that is declared unbiased has noise alone, "
         "unless its mean energy contradicts that"},
        {in_noise, "noise centroid [cycles per pixel]", "noise_centroid",
         [](RowRef r) { return r.noise ? measured(r.noise->centroid) : Field{}; }},
        {in_noise, "low frequencies [white noise = 1]", "noise_low_ratio", low_frequencies_field},
        {in_prices, "seconds to 10 %", "seconds_to_10pct", time_to<0>, "", 0},
        {in_prices, "seconds to 5 %", "seconds_to_5pct", time_to<1>, "", 1},
        {in_prices, "seconds to 2 %", "seconds_to_2pct", time_to<2>, "", 2},
        {in_prices, "seconds to 1 %", "seconds_to_1pct", time_to<3>, "", 3},
        {in_prices, "seconds to 0.5 %", "seconds_to_0.5pct", time_to<4>, "", 4},
        {in_errors, "samples not finite", "nonfinite",
         [](RowRef r) { return measured(static_cast<double>(r.nonfinite), Unit::whole); }},
        {in_prices, "memory MiB", "peak_rss_mib", [](RowRef r) { return measured(r.peak_rss_mib, Unit::whole); }},
        {in_prices, "seconds of preparation", "prepare_seconds", [](RowRef r) { return measured(r.prepare_seconds); }},
        {in_errors, "FLIP [0 to 1]", "flip", [](RowRef r) { return r.flip ? measured(*r.flip) : Field{}; }},
        {in_errors, "missing effects", "", left_out,
         "light transport that the scene calls for and the method leaves out"},
        {in_errors, "passes", "passes", passes_of},
        {in_laws, "cost of the last halving [times the seconds]", "",
         [](RowRef r) { return r.last_halving ? measured(*r.last_halving) : Field{}; },
         "factor by which time grew while the error fell to half, as measured"},
        {in_laws, "error floor %", "", floor_field, "relative RMSE that remains however long the method runs"},
        {in_laws, "slope", "", slope_field, "slope of the law; independent samples have 1"},
        {in_laws, "largest deviation from the law %", "", misfit_field,
         "largest relative deviation of a measured squared error"},
        {in_laws, "cost of the next halving [times the seconds]", "", next_halving_field,
         "factor by which time would grow for half the final error, extrapolated by the law"},
        {in_outliers, "median %", "", robust_field<&RobustError::median, Unit::root>,
         "root of the median of the pixels' squared relative errors"},
        {in_outliers, "relative RMSE without them %", "", robust_field<&RobustError::trimmed, Unit::root>,
         "root of the mean of the pixels' squared relative errors without the worst 0.1 % of the pixels"},
        {in_outliers, "share of the worst %", "", robust_field<&RobustError::share, Unit::percent>,
         "share of the squared relative error that the worst 0.1 % of the pixels hold"}};
    return columns;
}

}  // namespace gib
