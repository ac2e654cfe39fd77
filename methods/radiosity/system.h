#pragma once
// The system of linear equations of radiosity (Goral, Torrance, Greenberg and Battaile 1984).
//
// Goral et al. write B_i = E_i + rho_i sum_j F_ij B_j. Here the unknown X_i is the radiosity that patch i reflects
// [W/m^2], and the emitted light is the direct light that was reflected once, B1 = rho E_direct:
//     X = B1 + rho K X,   (K X)_i = sum_j F_ij X_j = 1 / A_i sum_j G_ij X_j,
// where the transport operator K gives the indirect irradiance E = K X. The sum runs over the links of leaf i and of
// all groups and clusters that contain it (Hanrahan et al. 1991: gather; pull of X up to the groups, push of E down to
// the leaves). G is symmetric, because a link is stored once.

#include "methods/radiosity/links.h"

#include <span>

namespace gib {

/// Values by node of the mesh; those of leaves count, those of groups are means over their leaves.
using PatchColors = std::vector<Colord>;

class RadiositySystem {
public:
    /// `mesh` and `light` must outlive this. `is_closed` says that the scene is closed. A row of K then sums up to 1
    /// except for errors of visibility and quadrature, which a symmetric scaling removes.
    RadiositySystem(const PatchMesh& mesh, const PatchLight& light, const std::vector<PatchLink>& links,
                    bool is_closed);

    std::size_t node_count() const { return mesh_.nodes().size(); }
    const std::vector<std::uint32_t>& leaves() const { return mesh_.leaves(); }
    /// The area to which light gets, A_i [scene units^2].
    double area(std::uint32_t node) const { return light_.area[node]; }
    /// E_direct [W/m^2].
    const Colord& direct_irradiance(std::uint32_t leaf) const { return light_.irradiance[leaf]; }
    const Colord& reflectance(std::uint32_t leaf) const { return light_.reflectance[leaf]; }
    /// B1 [W/m^2].
    Colord first_reflection(std::uint32_t leaf) const { return light_.reflectance[leaf] * light_.irradiance[leaf]; }

    struct Link {
        std::uint32_t other;
        float exchange, visible;  ///< as PatchLink has them
    };
    std::span<const Link> links_of(std::uint32_t node) const {
        return {links_.data() + first_link_[node], first_link_[node + 1] - first_link_[node]};
    }
    /// s_i: s_i G_ij s_j takes the place of G_ij. It is 1 unless the scene is closed.
    double scale(std::uint32_t leaf) const { return scales_[leaf]; }

    /// E = K X [W/m^2] of all leaves; the values of groups in X are ignored.
    PatchColors irradiance(PatchColors X) const;
    /// K X once more for display: light that arrives at the groups around a leaf is taken at the leaf's centre, instead
    /// of being constant over the group (Lischinski, Tampieri and Greenberg 1993, second step).
    PatchColors irradiance_at_centres(PatchColors X) const;
    /// Power [W] of |values| over the leaves, by channel.
    Colord power(const PatchColors& values) const;

    /// How far the row sums of K were from 1 before scaling: the mean, weighted by area, and the largest distance.
    struct Closure {
        double mean = 0, largest = 0;
    };
    const Closure& closure() const { return closure_; }
    bool is_closed() const { return is_closed_; }

private:
    void sort_links(const std::vector<PatchLink>& links);
    void normalise_rows();
    PatchColors ones() const { return PatchColors(node_count(), Colord::Ones()); }
    bool has_cluster(std::uint32_t p, std::uint32_t q) const;
    Vec3d direction(std::uint32_t from, std::uint32_t to) const;
    void pull(PatchColors& X) const;
    Colord sent_towards(std::uint32_t node, const Vec3d& w, const PatchColors& X) const;
    PatchColors sent_over_clusters(const PatchColors& X) const;
    PatchColors gathered(const PatchColors& X) const;
    PatchColors gathered_at_centres(PatchColors X) const;

    const PatchMesh& mesh_;
    const PatchLight& light_;
    bool is_closed_;
    std::vector<std::size_t> first_link_;  ///< by node
    std::vector<Link> links_;
    bool has_clusters_ = false;   ///< whether some link has one
    std::vector<double> scales_;  ///< by node
    Closure closure_;
};

}  // namespace gib
