#pragma once
// The verdict of a run for a terminal.

#include "experiments/analysis/table_row.h"

#include <string>

namespace gib {

/// A table of at most 12 lines of 80 columns: for each scene and error the seconds of the methods and what their error
/// consists of. If they do not fit, only the best method of each. Empty if there is no verdict.
std::string terminal_verdict(const Analysis& analysis);

}  // namespace gib
