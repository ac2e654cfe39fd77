#pragma once
// The links of hierarchical radiosity say which patches, groups of patches, or clusters of surfaces exchange light,
// and how much. Source: Hanrahan, Salzman and Aupperle 1991, "A Rapid Hierarchical Radiosity Algorithm"; the error of
// a link is weighted by the light that the link carries (their BF refinement).
//
// A link between p and q stands for all light between them. If both are patches, or halves of one chart's side, the
// light is taken as evenly spread over both, and the exchange is G = A_p F(p -> q) V = A_q F(q -> p) V [scene units^2],
// where V is the share of rays between them that pass. If one is a cluster, its sides differ in direction. Then all of
// them see the other end in one direction w at one distance r, and sides i and j of the two ends exchange
// G_ij = V A_i (n_i . w) A_j (-n_j . w) / (pi r^2) where both cosines are positive (the light that arrives at a cluster
// is pushed down with its sides' cosines: Smits, Arvo and Greenberg 1994, "A Clustering Algorithm for Radiosity in
// Complex Environments", alpha links). A link is stored once for both directions, so reciprocity is exact.

#include "methods/method.h"
#include "methods/radiosity/mesh.h"

namespace gib {

/// The light of patches before it is exchanged, by node of a mesh.
struct PatchLight {
    std::vector<Colord> irradiance;   ///< direct irradiance of leaves [W/m^2]
    std::vector<Colord> reflectance;  ///< mean reflectance of leaves
    /// Radiosity of all nodes, with an estimate of the light from other patches; mean of the channels [W/m^2].
    std::vector<double> expected;
    std::vector<double> spread;  ///< standard deviation of `expected` over the leaves of a node [W/m^2]
    std::vector<Vec3d> middle;   ///< mean position over the leaves of a node, weighted by `expected` [scene units]
    double mean_irradiance = 0;  ///< mean over all patches, including that estimate [W/m^2]
    /// The points of leaves, evenly distributed, `samples` for each. Direct light was sampled there, and rays that
    /// test visibility start and end there.
    std::vector<SurfacePoint> points;
    std::vector<std::uint32_t> first_point;  ///< by node
    std::uint32_t samples = 0;

    /// A point of a node, chosen evenly by the number u in [0, 1), and the leaf that it lies on.
    struct Choice {
        std::uint32_t leaf;
        const SurfacePoint& point;
    };
    Choice point_of(const PatchMesh& mesh, std::uint32_t node, double u) const;
};

struct PatchLink {
    std::uint32_t p, q;  ///< nodes
    float exchange;      ///< G [scene units^2]; with a cluster V / (pi r^2) [scene units^-2]
    float visible;       ///< V
};

struct LinkSettings {
    double error;     ///< a link may be wrong by this share of the mean irradiance
    bool refine_all;  ///< link leaves only, which gives the full system
    std::uint64_t seed;
};

struct PatchLinks {
    std::vector<PatchLink> links;
    /// The pairs, above the links, between which visibility was found: exchange is 0.
    std::vector<PatchLink> seen;
    std::uint64_t rays = 0;
};

/// Finds the links that replace those between all pairs of leaves, by refinement from the top of the mesh's tree.
PatchLinks link_patches(const PatchMesh& mesh, const PatchLight& light, const LinkSettings& settings,
                        const StageTimes* stages = nullptr);

/// The links of each node.
class LinkTable {
public:
    struct Entry {
        std::uint32_t other;
        float exchange, visible;
        Vec3 towards;  ///< unit, from the node to the other if one of the two is a cluster; else zero
        bool has_cluster() const { return !towards.isZero(0); }
    };
    LinkTable(const std::vector<PatchLink>& links, const std::vector<PatchNode>& nodes);
    std::span<const Entry> of(std::uint32_t node) const {
        return {entries_.data() + begin_[node], begin_[node + 1] - begin_[node]};
    }
    std::size_t size() const { return entries_.size(); }
    std::size_t number_of(const Entry& entry) const { return static_cast<std::size_t>(&entry - entries_.data()); }

private:
    std::vector<std::size_t> begin_;
    std::vector<Entry> entries_;
};

/// The share V of the light between two nodes that nothing blocks, estimated by n rays. `key` seeds
/// their random numbers.
double visibility_between(RayQueries& rays, const PatchMesh& mesh, const PatchLight& light, std::uint32_t p,
                          std::uint32_t q, std::uint32_t n, std::uint64_t key);
/// The share of light that passes between two points.
double passing(RayQueries& rays, const SurfacePoint& from, const SurfacePoint& to);
/// The light between two points in proportion to other points: the kernel of form factors, with a bound without which
/// one pair of many could decide. `area` is that of the smaller patch [scene units^2]. Where patches touch, most light
/// takes the shortest ways.
double light_between(const SurfacePoint& from, const SurfacePoint& to, double area);

}  // namespace gib
