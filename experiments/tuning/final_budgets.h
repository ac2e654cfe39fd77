#pragma once
// How the time that the search leaves is divided among the final runs.

#include <vector>

namespace gib {

/// Seconds for each of several runs, of which run i wants `wanted[i]`, so that together they take at most `seconds`, with
/// `besides` more for each: what they want, or an even share of what those that want less leave.
std::vector<double> shared_seconds(const std::vector<double>& wanted, double seconds, double besides);
/// The same for runs that need `needed[i]` at most for what they are made for; infinite: unknown. Where even shares give fewer than
/// two of them what they need, those that need least have it, one and then another, if it is no more than four fifths of the time
/// that is left. Two, because the first may fail: what a few seeds have reached is missed by another one where noise is rare and bright.
std::vector<double> promising_seconds(const std::vector<double>& wanted, const std::vector<double>& needed,
                                      double seconds, double besides);

}  // namespace gib
