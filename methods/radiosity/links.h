#pragma once
// The links of hierarchical radiosity: which patches, groups of patches or clusters of surfaces exchange light, and how
// much. Source: Hanrahan, Salzman and Aupperle 1991, "A Rapid Hierarchical Radiosity Algorithm", with the error of a
// link weighted by the light that the link carries (their BF refinement).
//
// A link between p and q stands for all light between them. If both are patches or groups of patches of one side, the
// light is taken as evenly spread over both, and the exchange is G = A_p F_pq V = A_q F_qp V [scene units^2], where V is
// the share of rays between them that pass. If one is a cluster, its sides differ in direction. Then all of them see the
// other end in one direction w at one distance r, and sides i and j of the two ends exchange
// G_ij = V A_i (n_i . w) A_j (-n_j . w) / (pi r^2) where both cosines are positive (alpha links of Smits, Arvo and
// Greenberg 1994). A link is stored once for both directions, so reciprocity is exact.

#include "methods/radiosity/light.h"

namespace gib {

struct PatchLink {
    std::uint32_t p, q;  ///< nodes
    float exchange;      ///< G [scene units^2]; with a cluster V / (pi r^2) [scene units^-2]
    float visible;       ///< V; between patches, of the light between the parts of their areas to which light gets
};

/// Finds the links that replace those between all pairs of leaves, by refinement from the top of the mesh's tree.
/// `error`: that of a link over the mean irradiance; 0 links every two leaves: the matrix of Goral et al. 1984. Adds the rays traced
/// to `rays`.
std::vector<PatchLink> link_patches(const PatchMesh& mesh, const PatchLight& light, double error, std::uint64_t seed,
                                    std::uint64_t& rays, const StageTimes& stages);

}  // namespace gib
