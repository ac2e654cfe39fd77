#pragma once
// The choice of the number of photons in an estimate by a test of noise or bias: from few photons outwards, the disc
// grows as long as its estimate agrees with those of all smaller discs, within what their noise explains.
//
// Source: Lepskii 1991, "On a Problem of Adaptive Estimation in Gaussian White Noise"; for photon maps compare Schregle
// 2003, "Bias Compensation for Photon Maps", whose bisection compares with one mean instead of all smaller discs.
//
// Derivation: n photons lie inside a disc whose rim is the next one, so for evenly spread photons its area A is a
// Gamma(n + 1) variable, and for nested discs of i < j photons A_i / A_j is a Beta variable whatever the density. The
// cube root of a Gamma variable is nearly normal (Wilson and Hilferty 1931, "The Distribution of Chi-square"), hence,
// with the unskewed densities D = (n + 1) / A, (D_j / D_i)^(1/3) has the mean 1 - v and the variance v,
//     v = q / 9 (1 / i - 1 / j),
// where q >= 1 is the mean square of the photons' powers over their squared mean. (For areas alone, Var(D_i / D_j) =
// q (1 / i - 1 / j) to first order.) Discs agree if the cube root lies within sqrt(kappa^2 + 2 log(k / n)) standard
// deviations, n the photons of the disc that would be settled for: the chance to settle for it without need falls by n
// / k, as its variance is larger by k / n.
//
// Cost on evenly spread photons (k = 500; tests/methods/parts/density/bias_compensation_test.cpp): the rare false alarms raise the mean by
// 0.3 to 0.5 %, below the bound of 1 % that is tested, and the standard deviation from 0.045 to 0.065.
// Where the surface ends inside the disc, the areas are those before that correction: such discs may stop early.

#include <cstddef>
#include <span>

namespace gib {

/// One disc: of the photons that count in it, how many, the sums of their weights and squared weights, and its area (of
/// the part on the surface).
struct NestedDisc {
    std::size_t photons;
    double weight, squared_weight;
    double area;
};

/// Photons of the smallest disc.
inline constexpr std::size_t smallest_disc = 16;
/// More than k = 1e6 photons need.
inline constexpr std::size_t most_discs = 40;
/// The number of photons of the disc after that with `photons`.
std::size_t next_disc(std::size_t photons);

/// The index of the largest disc that agrees with all smaller ones; the discs are in increasing order, not empty.
std::size_t largest_agreeing_disc(std::span<const NestedDisc> discs);

}  // namespace gib
