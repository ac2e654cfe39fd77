#pragma once
// Merging: a vertex of the camera's walk takes the light of the vertices of light walks around it, as if they lay on the
// same point. This is the density estimate of photon mapping, weighed against all other techniques (technique_sums.h).
// Sources: Georgiev et al. 2012, "Light Transport Simulation with Vertex Connection and Merging"; Hachisuka et al. 2012, "A
// Path Space Extension for Robust Light Transport Simulation".

#include "methods/parts/density/biased_film.h"
#include "methods/parts/density/kernel.h"
#include "methods/parts/kd_tree/kd_tree.h"
#include "methods/parts/photons/photon.h"
#include "methods/parts/vertices/light_paths.h"
#include "methods/vcm/merge_rule.h"

namespace gib {

/// The data of a light walk's vertex but its position: those of a photon, and what the weights need. 40 bytes.
struct LightVertexData : PhotonPayload {
    double d_vcm = 0, d_vc = 0;  ///< technique_sums.h
    PathClass path_class;
    bool on_surface = true, has_first_samples = true;  ///< PathVertex
};

/// A vertex of a light's walk. Its power is in units of LightPaths::power; in a medium it is divided by sigma_s.
struct LightVertex : LightVertexData {
    using Payload = LightVertexData;
    Vec3 p;

    LightVertex() = default;
    LightVertex(const Vec3& position, const LightVertexData& data) : LightVertexData(data), p(position) {}
    explicit LightVertex(const PathVertex& vertex);
};

extern template KdTree<LightVertex>::KdTree(const std::vector<LightVertex>& points);

/// The cells of a grid that some point reaches with its radius, the largest of all places: one bit for each, by a hash of the
/// cell (Teschner et al. 2003, "Optimized Spatial Hashing for Collision Detection of Deformable Objects"). No point reaches
/// most places, and a look-up in the tree waits for memory at each level.
class CellsInReach {
public:
    CellsInReach() = default;
    CellsInReach(const KdTree<LightVertex>& points, const MergeRadii& radii);
    /// False only if p lies within the radius of no point.
    bool any_within(const Vec3& p) const { return bits_[bit(cell_of(p.cast<double>()))]; }

private:
    using Cell = Eigen::Matrix<std::int64_t, 3, 1>;
    Cell cell_of(const Vec3d& p) const { return (p / edge_).array().floor().cast<std::int64_t>(); }
    std::size_t bit(const Cell& cell) const {
        const auto hash = static_cast<std::uint64_t>(cell.x()) * 73856093 ^
                          static_cast<std::uint64_t>(cell.y()) * 19349663 ^
                          static_cast<std::uint64_t>(cell.z()) * 83492791;
        return hash & (bits_.size() - 1);
    }

    double edge_ = 0;  ///< of a cell [scene units]
    std::vector<bool> bits_;
};

/// The vertices of the light walks of one pass.
class LightVertexMap {
public:
    LightVertexMap() = default;
    /// Follows the light paths of a pass, as many as `rule` says; adds the rays traced to `rays`. The result is the
    /// same for any number of threads. Throws InputError if the vertices would need more memory than there is.
    LightVertexMap(const Scene& scene, const LightPaths& paths, const PathRules& rules, const MergeRule& rule,
                   std::uint64_t seed, std::uint64_t& rays);

    const KdTree<LightVertex>& vertices() const { return vertices_; }

    /// Adds the light of all vertices around `eye`, weighed, and the estimate of its bias, to the sample. Paths have at
    /// most as many edges as the rules allow. With N light paths of power P, which have been scattered to the vertex from the
    /// direction w_i, radiance is the sum of f(w_i) |cos_s| / |cos_g| P K(d) / (phi N), with the cosines of the shading and the
    /// geometric normal, and the share phi of the kernel's disc that lies on the surface (density_estimate.h), which is taken
    /// to be 1 where the radius of the place is the largest. In a medium the phase function stands for f and the cosines, and
    /// phi is the share of the ball in sight.
    void merge(const PathVertex& eye, MergeRule::AlongCamera& along, const PathRules& rules, const MergeRadii& radii,
               Kernel kernel, RayQueries& rays, NumberStream& u, BiasedSample& sample) const;

private:
    KdTree<LightVertex> vertices_;
    CellsInReach cells_;
    double power_of_path_ = 0;  ///< P / N for a vertex of power 1 [W]
};

}  // namespace gib
