#pragma once
// The error of a row as fields: how large it is, and which part of it is bias.

#include "experiments/analysis/table_row.h"

#include <optional>

namespace gib {

/// The squared error that a reference's layer resolves: its noise floor, and at least twice the standard error of its own
/// variance, which is subtracted from errors. Where few groups have the bright pixels, this is more.
double least_resolved(const ReferenceLayer& layer, const Denominators& denominators);
/// rel_mse with its interval, less the reference's own variance; unclipped.
std::optional<Estimate> corrected_rel_mse(const TableRow& row);
/// The same, not resolved where it is not above the noise floor.
Field relative_error_field(const TableRow& row);
/// The squared bias [radiance^2]: 0 by theory, or below the upper end of its interval where this reaches 0.
Field bias2_field(const TableRow& row);
/// The share of bias^2 in bias^2 + variance, with the interval of bias^2.
Field bias_share_field(const TableRow& row);

/// Whether bias^2 of this row is 0 by theory, so that all of its error is variance. The method has to declare itself
/// unbiased, and it has to sample every path of the component, or of all components for the row of the total: its label
/// sets no max_depth, no effect and none of these components is left out, and no sample was dropped because it was not
/// finite.
bool is_unbiased(const TableRow& row, const Components& components_left_out);

}  // namespace gib
