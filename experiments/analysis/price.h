#pragma once
// The price of accuracy of a method: the law of its error against time, the time to an error, and the cost of halving it.

#include "experiments/analysis/curves.h"
#include "experiments/metrics/price_law.h"
#include "experiments/metrics/time_to_error.h"

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
/// (delete-one jackknife over the runs, in the logarithm). Empty if the error was never twice as large, or if the
/// last error is not above the noise floor.
std::optional<Estimate> last_halving(const Runs& cells, Layer layer, double noise_floor);
/// Sets the members of a judged row that come from the curves of its cells: times, law, last halving.
void add_curve_numbers(TableRow& row, const Runs& cells);

/// The part of a law's floor that is bias^2, taken from the relative bias^2 of
/// the final images. The rest is variance that more time does not remove, such as
/// that of a fixed photon map. 0 without a law, without an estimate of bias^2, or if the method is unbiased.
double floor_bias2(const TableRow& row);

/// Whether a law describes its points well enough to be extrapolated to this time [s].
bool law_reaches(const PriceLaw& law, double seconds);
/// The time [s] to target_errors[target]: measured if all seeds have reached it; else what the law says. No seed of a row
/// with State::never has an error below the floor that is named.
Field time_field(const TableRow& row, std::size_t target);
/// The factor by which the time has to grow to halve the error of the final image, by the law.
Field next_halving_field(const TableRow& row);
/// The floor of the law, as a squared error.
Field floor_field(const TableRow& row);
/// The part of a resolved floor that is bias^2, with the interval of the final images' bias^2.
Field floor_bias_field(const TableRow& row);

}  // namespace gib
