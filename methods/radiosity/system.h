#pragma once
// The equation system of radiosity and its solvers.
//
// Unknown is what patches reflect: X = B1 + rho K X with B1 = rho E_direct, and (K X)_i = 1 / A_i sum_j G_ij X_j over
// the links of leaf i and of the groups that it is in, of which X is the mean (pushing and pulling). E = K X is the
// indirect irradiance. G is symmetric, so multiplied by A / rho the system is symmetric and positive definite: (A /
// rho - G) X = A E_direct.
//
// Light of at most n reflections is the start of the Neumann series, B1 + rho K B1 + ... + (rho K)^(n - 1) B1, which
// exists where the system has no solution: in a closed scene that absorbs nothing. So it is summed, not solved for; a
// solution less its longer paths, X - (rho K)^n X, would take one product more, and be that sum only once X has
// converged.

#include "methods/radiosity/links.h"

#include <array>
#include <memory>
#include <string_view>

namespace gib {

enum class RadiositySolver { hierarchical, gauss_seidel, shooting, conjugate_gradient, direct };
inline constexpr std::array<std::string_view, 5> radiosity_solver_names = {"hierarchical", "gauss_seidel", "shooting",
                                                                           "conjugate_gradient", "direct"};

/// By node of the mesh; the values of leaves count, those of groups are their means.
using PatchColors = std::vector<Colord>;

class RadiositySystem {
public:
    /// `light` must outlive this; later halvings of the mesh's leaves do not change it. `normalise`: the scene is
    /// closed, so that a row of K sums up to 1 but for errors of visibility and quadrature; these are scaled away,
    /// symmetrically.
    RadiositySystem(const PatchMesh& mesh, const PatchLight& light, const std::vector<PatchLink>& links,
                    bool normalise);

    std::size_t size() const { return leaves_.size(); }
    std::size_t node_count() const { return node_count_; }
    const std::vector<std::uint32_t>& leaves() const { return leaves_; }
    double area(std::uint32_t node) const { return areas_[node]; }
    const Colord& reflectance(std::uint32_t leaf) const { return light_.reflectance[leaf]; }
    /// B1 [W/m^2].
    Colord first_reflection(std::uint32_t leaf) const { return light_.reflectance[leaf] * light_.irradiance[leaf]; }
    const LinkTable& links() const { return table_; }

    /// E = K X [W/m^2] of all leaves; the values of groups in X do not count.
    PatchColors irradiance(PatchColors X) const;
    /// Fills the values of groups with the means of their halves.
    void pull(PatchColors& X) const;
    /// Power [W] of |values| over the leaves, by channel.
    Colord power(const PatchColors& values) const;

    /// How far sums of rows of K are from 1 before they were scaled: the mean and the largest distance, weighted by
    /// area.
    struct Closure {
        double mean = 0, largest = 0;
    };
    const Closure& closure() const { return closure_; }
    bool is_closed() const { return !scales_.empty(); }
    double scale(std::uint32_t node) const { return scales_.empty() ? 1.0 : scales_[node]; }

private:
    void normalise_rows();
    std::vector<double> row_sums() const;

    const PatchLight& light_;
    std::size_t node_count_;
    std::vector<double> areas_;
    std::vector<std::uint32_t> leaves_;
    std::vector<std::uint32_t> parents_, children_;
    LinkTable table_;
    std::vector<double> scales_;  ///< of leaves: G_ij counts as s_i G_ij s_j
    Closure closure_;
};

class RadiositySolution {
public:
    virtual ~RadiositySolution() = default;
    /// One sweep: about as much work as one product with K.
    virtual void sweep() = 0;
    /// X so far; of all nodes.
    const PatchColors& radiosity() const { return X_; }
    /// X as it should be shown: while power is not yet shot, with an estimate of what it will add.
    virtual PatchColors shown() const { return X_; }
    /// What X lacks to solve the system, over what is reflected first: power, the largest of the channels.
    double residual() const { return residual_; }
    int sweeps() const { return sweeps_; }

protected:
    explicit RadiositySolution(const RadiositySystem& system);
    Colord residual_power(const PatchColors& residual) const;
    void measure_residual();

    const RadiositySystem& system_;
    PatchColors X_, first_;
    Colord first_power_;
    double residual_ = 1;
    int sweeps_ = 0;
};

/// `system` must outlive it. Throws InputError where light is reflected for ever, absorbed by less than
/// least_absorption: of a closed scene at once, where conjugate gradients or Cholesky's factors find it in a sweep.
std::unique_ptr<RadiositySolution> start_solution(const RadiositySystem& system, RadiositySolver solver);
/// The light of at most `reflections` reflections. A sweep doubles how many are summed; the residual is 0 once all are.
std::unique_ptr<RadiositySolution> start_series(const RadiositySystem& system, int reflections);

/// The share of reflected light that has to be lost on its way to the next patch, at least. Rows of K are known to
/// 1e-7, by which the share is in doubt, and with it the solution: by a tenth at ten times as much.
inline constexpr double least_absorption = 1e-6;

/// [bytes] that the direct solver's matrix takes.
double direct_solver_bytes(double patches);

}  // namespace gib
