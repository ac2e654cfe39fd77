#pragma once
// How the time that the search leaves is divided among the final runs.

#include <vector>

namespace gib {

/// Seconds for each of several runs, of which run i wants `wanted[i]`, so that together they take at most `seconds`, with
/// `besides` more for each: what they want, or an even share of what those that want less leave.
std::vector<double> shared_seconds(const std::vector<double>& wanted, double seconds, double besides);
/// The same for runs that need `needed[i]` at most for what they are made for; infinite: unknown. Where even shares give none of
/// them what it needs, the one that needs least has it, if that is no more than four fifths of the time.
std::vector<double> promising_seconds(const std::vector<double>& wanted, const std::vector<double>& needed,
                                      double seconds, double besides);

}  // namespace gib
