#pragma once
// The numbers of a row as fields: the size of its error and the part of it that is bias, and the price of accuracy,
// which is the law of the error against time, the time to an error, and the cost of halving it.

#include "experiments/analysis/curves.h"
#include "experiments/analysis/table_row.h"
#include "experiments/metrics/price_law.h"

#include <optional>
#include <vector>

namespace gib {

/// The law of a layer, fitted to mean_curve(). The start of the law is the runs' mean preparation time [s].
/// `noise_floor` is the relative squared error that is lost in the reference's own noise.
std::optional<PriceLaw> price_law_of(const Runs& cells, Layer layer, double noise_floor);
/// The curve of error against time of each run, with the reference's own variance subtracted; an error is 0 if that
/// variance exceeds it. NaN stays NaN.
std::vector<std::vector<CurvePoint>> error_curves(const Runs& cells, Layer layer);
/// The measured factor by which time grew for the last halving of a method's error: the time of the last point of its
/// mean curve over the time at which the mean error was twice as large. From 3 runs on it has a 95 % interval
/// (delete-one jackknife over the runs, in the logarithm). Empty if the error was never twice as large, if the last
/// error is not above the noise floor, or if the interval is too wide to say anything.
std::optional<Estimate> last_halving(const Runs& cells, Layer layer, double noise_floor);
/// Sets the members of a row that come from the curves of its cells: times, law, last halving.
void add_curve_numbers(TableRow& row, const Runs& cells);

/// Whether a law describes its points well enough to be extrapolated to this time [s].
bool law_reaches(const PriceLaw& law, double seconds);
/// The time [s] to target_errors[target]: measured if all seeds have reached it; else what the law says. No seed of a
/// row with State::never has an error below the floor that is named.
Field time_field(const TableRow& row, std::size_t target);
/// The factor by which the time has to grow to halve the error of the final image, by the law.
Field next_halving_field(const TableRow& row);
/// The slope of the law; inconclusive where the law misses the points, or where they do not determine it.
Field slope_field(const TableRow& row);
/// The floor of the law, as a squared error.
Field floor_field(const TableRow& row);

/// The least squared error that a reference's layer can measure: its noise floor, and at least twice the standard error
/// of the variance that is subtracted from errors.
double least_resolved(const ReferenceLayer& layer, const Denominators& denominators);
/// rel_mse with its interval, less the reference's own variance; unclipped.
std::optional<Estimate> corrected_rel_mse(const TableRow& row);
/// corrected_rel_mse() as a field; State::below_noise up to the noise floor.
Field relative_error_field(const TableRow& row);
/// The mean squared error less the reference's own variance [radiance^2]; empty where that is larger.
Field corrected_mse_field(const TableRow& row);
/// The squared bias [radiance^2]: 0 by theory, or below the upper end of its interval where this reaches 0.
Field bias2_field(const TableRow& row);
/// The share of unsampled light in the squared relative error; 0 if it is below a tenth.
double unsampled_share(const TableRow& row);
/// The variance over the seeds [radiance^2]; inconclusive if unsampled_share() is above 0.
Field variance_field(const TableRow& row);
/// The share of bias^2 in the squared relative error, with the interval of the relative bias^2.
Field bias_share_field(const TableRow& row);

/// Whether bias^2 of this row is 0 by theory, so that all of its error is variance, unless the images contradict it
/// (TableRow::contradicted_in). The method has to declare itself
/// unbiased, and it has to sample every path of the component, or of all components for the row of the total: its label
/// sets no max_depth, no effect and none of these components is left out, and no sample was dropped because it was not
/// finite.
bool is_unbiased_by_theory(const TableRow& row, const Components& components_left_out);

}  // namespace gib
