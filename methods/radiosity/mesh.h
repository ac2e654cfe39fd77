#pragma once
// Patches are made by repeated halving of the sides of charts that can reflect diffusely. The halves form a binary
// tree whose leaves are the patches of a solution; below them a leaf may be halved further for display only. A
// one-sided material reflects on its front, a two-sided one on both sides, each of which has its own patches. Above
// the sides the tree goes on: clusters of sides (Smits, Arvo and Greenberg 1994, "A Clustering Algorithm for Radiosity
// in Complex Environments"), so that one node at the top holds the whole scene.

#include "methods/radiosity/chart.h"

#include <unordered_map>

namespace gib {

inline constexpr std::uint32_t no_node = ~0u;

struct PatchNode {
    std::uint32_t side;      ///< number of the side; for a cluster, of its first side
    std::uint32_t side_end;  ///< one past the last side
    std::uint32_t parent = no_node;
    std::uint32_t child = no_node;           ///< the first of two; none: a leaf
    std::array<ChartPoint, 4> corners = {};  ///< a triangle has three
    PatchPolygon polygon = {};               ///< its front is the side's; a cluster has no vertices
    double area = 0;               ///< area that is not covered; of a cluster: the sum over its sides [scene units^2]
    Vec3d center = Vec3d::Zero();  ///< centre of the polygon, or the mean of the sides' centres
    double radius = 0;             ///< largest distance of a vertex from `center` [scene units]
    std::uint8_t across = 0, along = 0;  ///< halvings of u and v so far
    bool dark = false;                   ///< no light gets there: inside a closed block

    bool is_leaf() const { return child == no_node; }
    bool is_cluster() const { return polygon.count == 0; }
    int corner_count() const { return polygon.count; }
    /// The share of a patch that is not covered.
    double uncovered() const { return area / polygon.area; }
    /// The area that is seen from far away in the direction `w`; of a patch.
    double area_towards(const Vec3d& w) const { return dark ? 0 : area * std::max(0.0, polygon.normal.dot(w)); }
};

struct PatchSide {
    std::uint32_t chart;
    bool back;
    std::uint32_t root = no_node;
};

/// A place at which irradiance is evaluated.
struct PatchVertex {
    std::uint32_t leaf;  ///< a patch that has it as a corner
    ChartPoint at;
    Vec2d uv;  ///< place where irradiance is evaluated: at a border of the chart a little inside
};

class PatchMesh {
public:
    /// Makes patches whose edges are at most `size` long [scene units].
    PatchMesh(const Charts& charts, double size);

    const Charts& charts() const { return charts_; }
    double size() const { return size_; }
    /// The sides of charts; those of a cluster are neighbours.
    const std::vector<PatchSide>& sides() const { return sides_; }
    /// A parent comes before its children; the first node holds all.
    const std::vector<PatchNode>& nodes() const { return nodes_; }
    const Chart& chart_of(const PatchNode& node) const { return charts_[sides_[node.side].chart]; }
    std::size_t leaf_count() const;

    /// The point of the node's surface at s in the unit square, with normals on the node's side. Uniform s give
    /// uniform points.
    SurfaceHit point_on(const PatchNode& node, const Vec2d& s) const;
    /// The point at uv of the side's chart, with normals on that side.
    SurfaceHit point_of_side(const PatchSide& side, const Vec2d& uv) const;
    Vec2d middle_of(const PatchNode& node) const;
    /// The point at a node's corner, moved by the share `inset` of the way to its middle.
    SurfaceHit inside_corner(const PatchNode& node, int corner, double inset) const;

    /// Says of each leaf whether it is dark, and which share of it is not covered by what stands on it. Areas become
    /// those of the uncovered parts. An inner node is dark if both halves are.
    void set_exposure(const std::vector<bool>& dark, const std::vector<double>& uncovered);

    /// Halves a leaf; its children are the last two nodes.
    void split(std::uint32_t node);

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
    /// Whether the back or the front of a chart can reflect diffusely.
    static bool reflects(const Charts& charts, const Chart& chart, bool back);

private:
    /// The node of a range of sides: a cluster, or the root of one side.
    PatchNode node_of(std::uint32_t first, std::uint32_t end);
    void split_cluster(std::uint32_t node);
    void finish(PatchNode& node) const;
    bool is_fine_enough(const PatchNode& node) const;

    const Charts& charts_;
    double size_;
    std::vector<PatchSide> sides_;
    std::vector<std::array<std::uint32_t, 2>> sides_of_chart_;  ///< front and back, or no_node
    std::vector<PatchNode> nodes_;
};

/// The corners of all leaves; leaves of a side share them. A corner that lies inside an edge of a larger leaf (a
/// T-junction) is bound to the mean of that edge's ends, so that interpolated values have no cracks.
class PatchVertices {
public:
    explicit PatchVertices(const PatchMesh& mesh);

    const std::vector<PatchVertex>& vertices() const { return vertices_; }
    const std::array<std::uint32_t, 4>& of_leaf(std::uint32_t node) const { return corners_[node]; }

    struct Bound {
        std::uint32_t vertex, first, second;
    };
    /// Sorted, so that both ends of a corner's edge have their final values before the corner takes their mean.
    const std::vector<Bound>& bound() const { return bound_; }

private:
    using VertexIndex = std::unordered_map<std::uint64_t, std::uint32_t>;  ///< by key_of()
    void bind(const PatchMesh& mesh, const std::vector<VertexIndex>& of_side);

    std::vector<PatchVertex> vertices_;
    std::vector<std::array<std::uint32_t, 4>> corners_;  ///< by node; unused for inner nodes
    std::vector<Bound> bound_;
};

}  // namespace gib
