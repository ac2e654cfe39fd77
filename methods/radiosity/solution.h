#pragma once
// Solutions of X = B1 + rho K X (system.h).
//
// By iteration over links (Hanrahan et al. 1991), with conjugate gradients (Hestenes and Stiefel 1952): rho K is self-adjoint for the
// product <X, Y> = sum of A_i X_i Y_i / rho_i, because A_i K_ij = A_j K_ji, and 1 - rho K is positive if some light is
// absorbed. The sum of reflections, B1 + rho K B1 + ..., would take 1 / (1 - rho) times as many products with K.
//
// Where max_depth limits paths, it is that sum up to the reflections that it allows. It exists even in a closed scene that
// absorbs nothing.
//
// Directly, as Goral et al. 1984 solve: the matrix is (1 - rho_i F_ij). With D = sqrt(rho / A) and X = D Y it becomes
// symmetric, (1 - D G D) Y = D A E_direct, so Cholesky's factors take the place of Gauss's elimination.

#include "methods/radiosity/system.h"

#include <array>
#include <string_view>

namespace gib {

enum class RadiositySolver { hierarchical, direct };
inline constexpr std::array<std::string_view, 2> radiosity_solver_names = {"hierarchical", "direct"};

/// The least share of light that has to be absorbed at a reflection. The row sums of K are known to 1e-7, so this
/// share is uncertain by 1e-7, and the solution, which is in proportion to its reciprocal, by a tenth at this limit.
inline constexpr double least_absorption = 1e-6;

class RadiositySolution {
public:
    static constexpr double small_residual = 1e-4;

    /// `system` must outlive this. With `reflections`, only light of at most so many reflections is summed, whatever
    /// the solver. Throws InputError if light is reflected for ever, because less than least_absorption is absorbed: at
    /// once for a closed scene, else in the sweep that finds it.
    RadiositySolution(const RadiositySystem& system, RadiositySolver solver,
                      std::optional<int> reflections = std::nullopt);

    /// Solves directly, or takes eight steps of conjugate gradients, or adds as many reflections again as are summed, but
    /// at least 8, until the residual is small.
    void sweep();
    /// X of all leaves after the sweeps so far [W/m^2].
    const PatchColors& radiosity() const { return X_; }
    /// Power of the last reflection that was added, or of B1 + rho K X - X, over that of B1; the largest of the
    /// channels. 0 once all reflections that the limit allows are summed.
    double residual() const { return residual_; }
    bool has_converged() const { return residual_ <= small_residual; }
    int sweeps() const { return sweeps_; }

private:
    void add_reflections();
    void iterate();
    /// rho K X.
    PatchColors reflected(PatchColors X) const;
    /// <a, b>, by channel.
    Colord product(const PatchColors& a, const PatchColors& b) const;
    void solve_directly();
    void solve_channel(int c);
    double share_of_first(const PatchColors& values) const;

    const RadiositySystem& system_;
    RadiositySolver solver_;
    std::optional<int> reflections_;
    PatchColors X_;
    PatchColors term_;   ///< (rho K)^(n - 1) B1
    PatchColors r_, p_;  ///< residual and direction of conjugate gradients
    Colord first_power_;
    double residual_ = 0;
    int summed_ = 1, sweeps_ = 0;
};

}  // namespace gib
