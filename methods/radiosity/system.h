#pragma once
// The system of linear equations of radiosity (Goral et al. 1984), and its solvers.
//
// The unknown X is the radiosity that patches reflect [W/m^2]: X = B1 + rho K X with B1 = rho E_direct. The transport
// operator K gives indirect irradiance E = K X: (K X)_i = 1 / A_i sum_j G_ij X_j over the links of leaf i and of all
// groups and clusters that contain it. The X of a group is the mean over the group (push and pull of Hanrahan et al.
// 1991). A cluster sends the sum over its sides of their radiosity times the area that each shows (links.h). G is
// symmetric, so the system times A / rho is symmetric and positive definite: (A / rho - G) X = A E_direct.
//
// Light of at most n reflections is a partial sum of the Neumann series, B1 + rho K B1 + ... + (rho K)^(n - 1) B1. It
// exists even where the system has no solution, in a closed scene that absorbs nothing. It is therefore summed and
// not derived from a solution X: X - (rho K)^n X, the solution less its longer paths, takes one product more and is
// that sum only once X has converged.

#include "methods/radiosity/links.h"

#include <array>
#include <memory>
#include <string_view>

namespace gib {

enum class RadiositySolver { hierarchical, gauss_seidel, shooting, conjugate_gradient, direct };
inline constexpr std::array<std::string_view, 5> radiosity_solver_names = {"hierarchical", "gauss_seidel", "shooting",
                                                                           "conjugate_gradient", "direct"};

/// Values by node of the mesh; those of leaves count, those of groups are means over their leaves.
using PatchColors = std::vector<Colord>;

class RadiositySystem {
public:
    /// `mesh` and `light` must outlive this; later halvings of the mesh's leaves do not change it. `normalise` says that
    /// the scene is closed. A row of K then sums up to 1 except for errors of visibility and quadrature, which a
    /// symmetric scaling removes.
    RadiositySystem(const PatchMesh& mesh, const PatchLight& light, const std::vector<PatchLink>& links,
                    bool normalise);

    std::size_t size() const { return leaves_.size(); }
    const PatchMesh& mesh() const { return mesh_; }
    std::size_t node_count() const { return children_.size(); }
    const std::vector<std::uint32_t>& leaves() const { return leaves_; }
    double area(std::uint32_t node) const { return mesh_.nodes()[node].area; }
    const Colord& reflectance(std::uint32_t leaf) const { return light_.reflectance[leaf]; }
    /// B1 [W/m^2].
    Colord first_reflection(std::uint32_t leaf) const { return light_.reflectance[leaf] * light_.irradiance[leaf]; }
    const LinkTable& links() const { return table_; }

    /// E = K X [W/m^2] of all leaves; the values of groups in X are ignored.
    PatchColors irradiance(PatchColors X) const;
    /// Fills the values of groups with the means of their halves.
    void pull(PatchColors& X) const;
    /// By entry of `links`: what the other end sends to an entry's node if one of the two is a cluster, the sum of
    /// radiosity times area shown [W]; else 0. X has values of groups.
    PatchColors sent(const LinkTable& links, const PatchColors& X) const;
    /// Power [W] of |values| over the leaves, by channel.
    Colord power(const PatchColors& values) const;

    /// How far the row sums of K were from 1 before scaling: the mean, weighted by area, and the largest distance.
    struct Closure {
        double mean = 0, largest = 0;
    };
    const Closure& closure() const { return closure_; }
    bool is_closed() const { return !scales_.empty(); }
    double scale(std::uint32_t node) const { return scales_.empty() ? 1.0 : scales_[node]; }

private:
    void normalise_rows();
    std::vector<double> row_sums() const;

    const PatchMesh& mesh_;
    const PatchLight& light_;
    std::vector<std::uint32_t> leaves_;
    std::vector<std::uint32_t> children_;  ///< the first, as of the solution
    LinkTable table_;
    std::vector<double> scales_;  ///< s by leaf: s_i G_ij s_j takes the place of G_ij
    Closure closure_;
};

class RadiositySolution {
public:
    virtual ~RadiositySolution() = default;
    /// One sweep: about as much work as one product with K.
    virtual void sweep() = 0;
    /// X of all nodes after the sweeps so far.
    const PatchColors& radiosity() const { return X_; }
    /// X for display: while there is power not yet shot, it includes an estimate of the light that this
    /// power will add.
    virtual PatchColors shown() const { return X_; }
    /// The power of the residual B1 + rho K X - X over that of B1, the largest of the channels.
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

/// Starts a solver. `system` must outlive the solution. Throws InputError if light is reflected for ever, because
/// less than least_absorption is absorbed: at once for a closed scene, else in the sweep in which conjugate gradients
/// or Cholesky's factors find it.
std::unique_ptr<RadiositySolution> start_solution(const RadiositySystem& system, RadiositySolver solver);
/// Starts the sum of the light of at most `reflections` reflections. Each sweep doubles the number of reflections in
/// the sum; the residual is 0 once all are summed.
std::unique_ptr<RadiositySolution> start_series(const RadiositySystem& system, int reflections);

/// The least share of light that has to be absorbed at a reflection. The row sums of K are known to 1e-7, so this
/// share is uncertain by 1e-7, and the solution, which is in proportion to its reciprocal, by a tenth at this limit.
inline constexpr double least_absorption = 1e-6;

}  // namespace gib
