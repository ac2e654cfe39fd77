#pragma once
// The choice of the number of photons in an estimate by a test of noise or bias: from few photons outwards, the disc grows
// as long as its estimate agrees with those of all smaller discs, within what their noise explains.
//
// Source: Lepskii 1991, "On a Problem of Adaptive Estimation in Gaussian White Noise"; for photon maps compare Schregle
// 2003, "Bias Compensation for Photon Maps", whose bisection compares with one mean instead of all smaller discs.
//
// Derivation: let E_i = S_i / A_i be the estimates of nested discs through photons k_i < k_j, of areas A_i, A_j. For evenly
// spread photons A_i / A_j is a Beta(k_i, k_j - k_i) variable, whatever the density, and
//     Var(E_i / E_j) = (k_j - k_i) / ((k_j - 1) (k_i - 2))  ~  1 / k_i - 1 / k_j
// for equal powers; powers w whose mean square is q >= 1 times their squared mean raise it to q (1 / k_i - 1 / k_j). The test is
// on log(E_i / E_j), which is far less skewed than the ratio. Discs agree if it is within `kappa` standard deviations.
// The constants: see bias_compensation.cpp.
//
// Bias on evenly spread photons: the rule stops early by chance with a small probability p_j at each disc, where |E_j / E - 1| is
// about z(p_j) / sqrt(k_j); tests/density_estimate_test.cpp states and checks a bound.

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
