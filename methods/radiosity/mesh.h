#pragma once
// The patches of radiosity and the hierarchy above them.
//
// The sides of charts that can reflect diffusely are halved until no edge is longer than asked. The halves form a
// binary tree whose leaves are the patches of the solution ("elements" of Hanrahan et al. 1991) and whose inner nodes
// are groups of patches. A one-sided material reflects on its front, a two-sided one on both sides, each of which has
// its own patches. Above the sides the tree goes on with clusters of sides (Smits, Arvo and Greenberg 1994, "A
// Clustering Algorithm for Radiosity in Complex Environments"), so that the first node holds the whole scene.

#include "methods/radiosity/chart.h"

namespace gib {

inline constexpr std::uint32_t no_node = ~0u;

struct PatchNode {
    std::uint32_t side;      ///< number of the side; for a cluster, of its first side
    std::uint32_t side_end;  ///< one past the last side
    std::uint32_t parent = no_node;
    std::uint32_t child = no_node;      ///< the first of two, which follow each other; none: a leaf
    std::array<Vec2d, 4> corners = {};  ///< on the chart; a triangle has three
    PatchPolygon polygon = {};          ///< its front is the side's; a cluster has no vertices
    double area = 0;                    ///< A [scene units^2]; of a cluster: the sum over its sides
    Vec3d center = Vec3d::Zero();       ///< centre of the polygon, or the mean of the sides' centres
    double radius = 0;                  ///< largest distance of a vertex from `center` [scene units]

    bool is_leaf() const { return child == no_node; }
    bool is_cluster() const { return polygon.count == 0; }
    std::size_t corner_count() const { return static_cast<std::size_t>(polygon.count); }
};

struct PatchSide {
    std::uint32_t chart;
    bool back;
    double area;                   ///< [scene units^2]
    Vec3d center = Vec3d::Zero();  ///< centre of the chart [scene units]
    double radius = 0;             ///< largest distance of a corner from `center` [scene units]
    std::uint32_t root = no_node;  ///< node of the whole side
};

class PatchMesh {
public:
    /// Makes patches whose edges are at most `size` long [scene units]. `charts` must outlive this.
    PatchMesh(const Charts& charts, double size);

    const Charts& charts() const { return charts_; }
    double size() const { return size_; }
    /// The sides of charts; those of a cluster are neighbours.
    const std::vector<PatchSide>& sides() const { return sides_; }
    /// A parent comes before its children; the first node holds all.
    const std::vector<PatchNode>& nodes() const { return nodes_; }
    const std::vector<std::uint32_t>& leaves() const { return leaves_; }
    const Chart& chart_of(const PatchNode& node) const { return charts_[sides_[node.side].chart]; }

    /// The point of the node's surface at s in the unit square, with normals on the node's side. Uniform s give
    /// uniform points of the flat patch.
    SurfaceHit point_on(const PatchNode& node, const Vec2d& s) const;
    /// The point at uv of the side's chart, with normals on that side.
    SurfaceHit point_of_side(const PatchSide& side, const Vec2d& uv) const;

    struct Place {
        std::uint32_t leaf;
        Vec2d uv;  ///< coordinates on the chart
    };
    /// The patch of a hit that is seen from wo; empty where there is no patch.
    std::optional<Place> locate(const SurfaceHit& hit, const Vec3& wo) const;
    /// The weights of a leaf's corners for linear interpolation at uv (bilinear if it has four corners).
    std::array<double, 4> weights(const PatchNode& leaf, const Vec2d& uv) const;

    /// An estimate of the number of patches of a mesh with edges of `size` [scene units], without making one.
    static double estimated_patches(const Charts& charts, double size);

private:
    void add_side(std::uint32_t chart, bool back);
    /// The node of a range of sides: a cluster, or the root of one side.
    PatchNode node_of(std::uint32_t first, std::uint32_t end) const;
    void split_cluster(std::uint32_t node);
    void split_patch(std::uint32_t node);
    void add_children(std::uint32_t node, PatchNode first, PatchNode second);
    void finish(PatchNode& node) const;
    /// The longer edges along u and along v of a node with four corners [scene units].
    Vec2d lengths_of(const PatchNode& quad) const;
    bool is_fine_enough(const PatchNode& node) const;

    const Charts& charts_;
    double size_;
    std::vector<PatchSide> sides_;
    std::vector<std::array<std::uint32_t, 2>> sides_of_chart_;  ///< front and back, or no_node
    std::vector<PatchNode> nodes_;
    std::vector<std::uint32_t> leaves_;
};

}  // namespace gib
