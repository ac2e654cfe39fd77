#pragma once
// Where theory gives the bias of a method, which a few seeds measure badly.

#include "experiments/analysis/table_row.h"

namespace gib {

/// Whether bias^2 of this row is 0 by theory, so that all of its error is variance. The method has to declare itself
/// unbiased, and it has to sample every path of the component, or of all components for the row of the total: its label
/// sets no max_depth, no effect and none of these components (`components_left_out`, names separated by `;`) is left
/// out, and no sample was dropped because it was not finite.
bool is_unbiased(const TableRow& row, const std::string& components_left_out);

}  // namespace gib
