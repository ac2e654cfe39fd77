#pragma once
// The links of hierarchical radiosity say which patches, or groups of them, exchange light, and how much. Source:
// Hanrahan, Salzman and Aupperle 1991, "A Rapid Hierarchical Radiosity Algorithm"; the error of a link is weighted by
// the light that the link carries (their BF refinement).
//
// A link between p and q stands for all light between them, which is taken as evenly spread over both. Its exchange
// is G = A_p F(p -> q) V = A_q F(q -> p) V [scene units^2], where V is the share of rays between them that pass. A
// link is stored once for both directions, so reciprocity is exact.

#include "methods/method.h"
#include "methods/radiosity/mesh.h"

namespace gib {

/// The light of patches before it is exchanged, by node of a mesh.
struct PatchLight {
    std::vector<Colord> irradiance;   ///< of leaves: direct [W/m^2]
    std::vector<Colord> reflectance;  ///< of leaves: mean
    /// Radiosity of all nodes, with an estimate of the light from other patches; mean of the channels [W/m^2].
    std::vector<double> expected;
    std::vector<double> spread;  ///< standard deviation of `expected` over the leaves of a node [W/m^2]
    double mean_irradiance = 0;  ///< over all patches, including that estimate [W/m^2]
};

struct PatchLink {
    std::uint32_t p, q;  ///< nodes; equal for the light that a hollow patch sends to itself
    float exchange;      ///< [scene units^2]
    bool clear;          ///< all rays between them pass
};

struct LinkSettings {
    double error;     ///< a link may be wrong by this share of the mean irradiance
    bool refine_all;  ///< link leaves only, which gives the full system
    std::uint64_t seed;
    double most_bytes;  ///< for links and what is made of them; more is an InputError
};

struct PatchLinks {
    std::vector<PatchLink> links;
    std::uint64_t rays = 0;
};

/// Finds the links between all sides by refinement. Throws InputError if they take more than `settings.most_bytes`.
PatchLinks link_patches(const PatchMesh& mesh, const PatchLight& light, const LinkSettings& settings,
                        const StageTimes* stages = nullptr);

/// Weights of the standard deviation of radiosity over a group (its stray) against the error that a link may make:
/// one for links, one for the display of irradiance, where accuracy costs less. Stray errs to one side, so less of it
/// is allowed. Measured in cornell-box.xml with the defaults at 16 samples: the weight 16 makes 57 thousand links and
/// leaves 1.38 % relative RMSE of indirect light, its mean 2.9 % too low; 64 makes 112 thousand links, takes 46 %
/// longer in all and leaves 1.17 %, 2.0 % too low. For the display, 8 saves 9 % of the time and errs no more there,
/// 512 takes 48 % longer and leaves 1.31 %.
inline constexpr double stray_weight = 16, shown_stray_weight = 64;

/// The links of each node.
class LinkTable {
public:
    struct Entry {
        std::uint32_t other;
        float exchange;
        bool clear;
    };
    LinkTable(const std::vector<PatchLink>& links, std::size_t nodes);
    std::span<const Entry> of(std::uint32_t node) const {
        return {entries_.data() + begin_[node], begin_[node + 1] - begin_[node]};
    }
    /// The memory that a link takes in this table and in the list of links [bytes].
    static constexpr double bytes_per_link = sizeof(PatchLink) + 2 * sizeof(Entry);

private:
    std::vector<std::size_t> begin_;
    std::vector<Entry> entries_;
};

/// The share V of the light between two nodes that nothing blocks, estimated by n rays. `key` seeds
/// their random numbers.
double visibility_between(RayQueries& rays, const PatchMesh& mesh, const PatchNode& p, const PatchNode& q,
                          std::uint32_t n, std::uint64_t key);
/// The share of the light between a point and a node that nothing blocks, estimated by n rays.
double visibility_from(RayQueries& rays, const PatchMesh& mesh, const SurfaceHit& point, const PatchNode& q,
                       std::uint32_t n, std::uint64_t key);
/// The area of a patch over that of its chord polygon if the patch is convex, so that light from outside meets all of
/// it; else 1.
double area_correction(const PatchNode& node);

}  // namespace gib
