#pragma once
// Says how far a run has come (`gibench status`).

#include <iosfwd>
#include <string>

namespace gib {

/// Prints how many cells of a result folder are done, running, waiting, failed and missing, and which ones. Returns the
/// exit code: 0 if all are done or still to come, 1 if one has failed or is missing. Throws InputError if the folder
/// holds no results.
int print_status(const std::string& folder, std::ostream& out);

}  // namespace gib
