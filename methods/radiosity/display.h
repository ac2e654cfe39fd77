#pragma once
// A solution as it is seen: irradiance at the corners of patches, gathered anew over the links, and interpolated
// between them. Patches of the solution only have means; the corners of a mean's neighbours would be of first order
// in the patch's size at best, and worse at borders. Source: the second step of Galerkin methods, Lischinski,
// Tampieri and Greenberg 1993, "Combining Hierarchical Radiosity and Discontinuity Meshing", there by pixel.

#include "methods/radiosity/system.h"

namespace gib {

struct DisplaySettings {
    bool adapt;      ///< halve patches further where irradiance changes over them
    bool normalise;  ///< the scene is closed: rows sum up to 1
    double links;    ///< allowed error of a link, a share of the mean irradiance
    std::uint64_t seed;
    double most_bytes;  ///< of rows; beyond: InputError
};

class RadiosityDisplay {
public:
    /// All must outlive this; `mesh` is halved further.
    RadiosityDisplay(PatchMesh& mesh, const RadiositySystem& system, const PatchLight& light,
                     const DisplaySettings& settings);

    /// Takes X, of all nodes of the solution.
    void show(const PatchColors& X);
    /// Halves patches over which the irradiance shown now changes much, and shows them.
    void refine(const PatchColors& X);

    /// Indirect irradiance [W/m^2] at a hit seen from wo; 0 where there is no patch.
    Color irradiance(const SurfaceHit& hit, const Vec3& wo) const;
    /// The same with the direct irradiance of the patch there.
    Color whole_irradiance(const SurfaceHit& hit, const Vec3& wo) const;

    const PatchMesh& mesh() const { return mesh_; }
    const PatchVertices& vertices() const { return *vertices_; }
    const std::vector<Color>& vertex_irradiance() const { return irradiance_; }
    /// The patch of the solution that a leaf of the mesh lies in.
    std::uint32_t solved_patch(std::uint32_t leaf) const;
    std::uint64_t rays() const { return rays_; }

private:
    struct Term {
        std::uint32_t node;
        float factor;
    };
    struct Viewpoint {
        const SurfaceHit& hit;
        Vec3d p, n;
        std::uint64_t key;
    };
    struct Row {
        std::size_t begin;
        std::uint32_t count;
    };
    void add_rows();
    void look_at_corners();
    double factor_to(RayQueries& rays, const Viewpoint& from, std::uint32_t node, bool clear) const;
    /// Adds terms for a node, or for its halves where its light strays too far over it.
    void add_terms(RayQueries& rays, const Viewpoint& from, std::uint32_t node, bool clear,
                   std::vector<Term>& row) const;
    void irradiance_row(RayQueries& rays, const PatchVertex& vertex, std::vector<Term>& row) const;
    bool changes_over(std::uint32_t leaf, double allowed) const;

    PatchMesh& mesh_;
    const RadiositySystem& system_;
    const PatchLight& light_;
    DisplaySettings settings_;
    std::size_t solved_nodes_;
    std::optional<PatchVertices> vertices_;
    std::vector<Row> rows_;  ///< by vertex
    std::vector<Term> terms_;
    /// By node: bits of a leaf's corners that nothing separates from its middle.
    std::vector<std::uint8_t> seen_corners_;
    std::vector<Color> irradiance_;                              ///< by vertex
    std::vector<std::unordered_map<std::uint64_t, Row>> known_;  ///< by side: rows of corners of earlier meshes
    std::uint64_t rays_ = 0;
};

}  // namespace gib
