#pragma once
// `gibench tune`: the settings of each method with the least time to an error on one scene.

#include "experiments/tuning/tune_options.h"

#include <iosfwd>

namespace gib {

/// Searches, measures the best settings with fresh seeds and prints them to `out`, the best label first. Every round of
/// the search is an experiment in a folder of its own, `NUMBER-METHOD-ROUND`, and the final measurement one in `final`; the same
/// command goes on after an interruption. The folder also gets `tune.html`, the page of the tuning, and `tune.json` with
/// its numbers. Returns the exit code: 0 found, 1 no method reached the target, 130 interrupted. Throws InputError.
int tune(const TuneOptions& options, std::ostream& out);

/// Throws InputError if the target, a method or a variation is wrong.
void check_tuning(const TuneOptions& options);

}  // namespace gib
