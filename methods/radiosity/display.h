#pragma once
// The display of a solution: irradiance is computed once more over the links, at the corners of patches, and
// interpolated between them. The solution itself has only the mean of each patch; corners that average the means of
// their neighbours would be accurate to first order in the patch's size at best, and less at borders. Source:
// Lischinski, Tampieri and Greenberg 1993, "Combining Hierarchical Radiosity and Discontinuity Meshing", whose second
// step does this for each pixel.

#include "methods/radiosity/system.h"

namespace gib {

struct DisplaySettings {
    bool adapt;    ///< halve patches further where irradiance changes over them
    double links;  ///< allowed error of a link, as a share of the mean irradiance
    std::uint64_t seed;
};

class RadiosityDisplay {
public:
    /// `seen` are PatchLinks::seen. The other arguments must outlive this; `mesh` is halved further.
    RadiosityDisplay(PatchMesh& mesh, const RadiositySystem& system, const PatchLight& light,
                     const std::vector<PatchLink>& seen, const DisplaySettings& settings);

    /// Computes the irradiance of all corners from X [W/m^2], the radiosity of all nodes of the solution.
    void show(const PatchColors& X);
    /// Halves the patches over which the irradiance changes much, and computes it at the new corners as well.
    void refine(const PatchColors& X);

    /// Indirect irradiance [W/m^2] at a hit seen from wo; 0 where there is no patch.
    Color irradiance(const SurfaceHit& hit, const Vec3& wo) const;
    /// Indirect irradiance at the hit plus the mean direct irradiance of its patch [W/m^2].
    Color whole_irradiance(const SurfaceHit& hit, const Vec3& wo) const;

    const PatchMesh& mesh() const { return mesh_; }
    const PatchVertices& vertices() const { return *vertices_; }
    const std::vector<Color>& vertex_irradiance() const { return irradiance_; }
    /// The patch of the solution that a leaf of the mesh lies in.
    std::uint32_t solved_patch(std::uint32_t leaf) const;
    std::uint64_t rays() const { return rays_; }

private:
    /// The irradiance of a corner is the sum of factor times value over the terms of its row. Values are the radiosity
    /// of the solution's nodes, then what clusters send over each entry of its links.
    struct Term {
        std::uint32_t value;
        float factor;
    };
    struct Viewpoint {
        SurfaceHit hit;
        Vec3d p, n;
        std::uint64_t key;
    };
    struct Row {
        std::size_t begin;
        std::uint32_t count;
        float scale;
    };
    void add_rows();
    void look_at_corners();
    /// Adds a term for a node of patches, or terms for its halves if radiosity varies too much over the node. `visible`
    /// is the share of light that nothing blocks; if negative, rays find it. Returns the share of the hemisphere.
    double add_terms(RayQueries& rays, const Viewpoint& from, std::uint32_t node, double visible,
                     std::vector<Term>& row) const;
    double add_rays(RayQueries& rays, const Viewpoint& from, std::uint32_t node, double factor,
                    std::vector<Term>& row) const;
    /// Returns the share of the hemisphere that the row sees.
    double irradiance_row(RayQueries& rays, const PatchVertex& vertex, std::vector<Term>& row) const;
    bool changes_over(std::uint32_t leaf, double allowed) const;

    PatchMesh& mesh_;
    const RadiositySystem& system_;
    const PatchLight& light_;
    LinkTable links_;
    DisplaySettings settings_;
    PatchColors areas_shown_;  ///< by entry of links_: the area that a cluster shows, as RadiositySystem::sent()
    std::optional<PatchVertices> vertices_;
    std::vector<Row> rows_;  ///< by vertex
    std::vector<Term> terms_;
    /// By node: a bit for each corner of a leaf that nothing separates from the leaf's middle.
    std::vector<std::uint8_t> seen_corners_;
    std::vector<Color> irradiance_;                              ///< by vertex
    std::vector<std::unordered_map<std::uint64_t, Row>> known_;  ///< by side: rows of corners of earlier meshes
    std::uint64_t rays_ = 0;
};

}  // namespace gib
