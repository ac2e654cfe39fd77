#pragma once
// Which patches, or groups of them, exchange light, and how much: the links of hierarchical radiosity. Source:
// Hanrahan, Salzman and Aupperle 1991, "A Rapid Hierarchical Radiosity Algorithm", with the error of a link weighed
// by the light it carries (their BF refinement).
//
// A link between p and q stands for all light between them, evenly spread over both: its exchange is G = A_p F(p ->
// q) V = A_q F(q -> p) V [scene units^2], V the share of rays between them that pass. It is kept once, so reciprocity
// is exact.

#include "methods/method.h"
#include "methods/radiosity/mesh.h"

namespace gib {

/// What light patches have before it is exchanged, by node of a mesh.
struct PatchLight {
    std::vector<Colord> irradiance;   ///< of leaves: direct [W/m^2]
    std::vector<Colord> reflectance;  ///< of leaves: mean
    std::vector<double>
        expected;  ///< of all nodes: radiosity with an estimate of what others add, mean of the channels [W/m^2]
    std::vector<double> spread;  ///< standard deviation of `expected` over the leaves of a node [W/m^2]
    double mean_irradiance = 0;  ///< over all patches, that estimate included [W/m^2]
};

struct PatchLink {
    std::uint32_t p, q;  ///< nodes; the same for what a hollow patch sends to itself
    float exchange;      ///< [scene units^2]
    bool clear;          ///< all rays between them pass
};

struct LinkSettings {
    double error;     ///< a link may be wrong by this share of the mean irradiance
    bool refine_all;  ///< between leaves only: the full system
    std::uint64_t seed;
    double most_bytes;  ///< for links and what is made of them; beyond: InputError
};

struct PatchLinks {
    std::vector<PatchLink> links;
    std::uint64_t rays = 0;
};

PatchLinks link_patches(const PatchMesh& mesh, const PatchLight& light, const LinkSettings& settings,
                        const StageTimes* stages = nullptr);

/// How much less a group's light may stray over it than links may err: by links, and where irradiance is shown, which
/// costs less. What strays errs to one side. Measured in cornell-box.xml with the defaults at 16 samples: the weight 16
/// makes 57 thousand links and leaves 1.38 % relative RMSE of indirect light, its mean 2.9 % too low; 64 makes 112
/// thousand links, takes 46 % longer in all and leaves 1.17 %, 2.0 % too low. For what is shown, 8 saves 9 % of the
/// time and errs no more there, 512 takes 48 % longer and leaves 1.31 %.
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
    /// [bytes] that a link takes here and in its list.
    static constexpr double bytes_per_link = sizeof(PatchLink) + 2 * sizeof(Entry);

private:
    std::vector<std::size_t> begin_;
    std::vector<Entry> entries_;
};

/// The share of the light between two nodes that passes, by n rays.
double visibility_between(RayQueries& rays, const PatchMesh& mesh, const PatchNode& p, const PatchNode& q,
                          std::uint32_t n, std::uint64_t key);
/// The same from one point.
double visibility_from(RayQueries& rays, const PatchMesh& mesh, const SurfaceHit& point, const PatchNode& q,
                       std::uint32_t n, std::uint64_t key);
/// The surface of a patch over that of its polygon, which light from outside meets on a convex patch.
double area_correction(const PatchNode& node);

}  // namespace gib
