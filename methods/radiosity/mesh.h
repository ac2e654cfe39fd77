#pragma once
// Patches: the sides of charts that can reflect diffusely, halved again and again. Halves are a binary tree whose
// leaves are the patches of a solution; below them a leaf may be halved further for display only. A side is what
// reflects: of a one-sided material the front, of a two-sided one both, each with its own patches.

#include "common/core/error.h"
#include "methods/radiosity/chart.h"

#include <unordered_map>

namespace gib {

inline constexpr std::uint32_t no_node = ~0u;

struct PatchNode {
    std::uint32_t side;
    std::uint32_t parent = no_node;
    std::uint32_t child = no_node;       ///< the first of two; none: a leaf
    std::array<ChartPoint, 4> corners;   ///< of a triangle three
    PatchPolygon polygon;                ///< its chords; its front is the side's
    double area = 0;                     ///< of the surface itself [scene units^2]
    Vec3d center = Vec3d::Zero();        ///< the polygon's
    double radius = 0;                   ///< of the polygon's vertices around it
    double sagitta = 0;                  ///< of the surface's middle over the polygon, positive in front
    double spread = 0;                   ///< the largest angle between normals of the surface here [rad]
    std::uint8_t across = 0, along = 0;  ///< halvings of u and v so far

    bool is_leaf() const { return child == no_node; }
    int corner_count() const { return polygon.count; }
};

struct PatchSide {
    std::uint32_t chart;
    bool back;
    std::uint32_t root;
};

/// A place at which irradiance is evaluated.
struct PatchVertex {
    std::uint32_t leaf;  ///< a patch that it belongs to
    ChartPoint at;
    Vec2d uv;  ///< of the place itself: on a border of the chart a little inside
};

class PatchMesh {
public:
    /// Patches whose edges are at most `size` long [scene units], and which bend by `max_spread` at most. Throws
    /// InputError if nodes would take more than `most_nodes`.
    PatchMesh(const Charts& charts, double size, std::size_t most_nodes);

    const Charts& charts() const { return charts_; }
    const std::vector<PatchSide>& sides() const { return sides_; }
    const std::vector<PatchNode>& nodes() const { return nodes_; }
    std::size_t leaf_count() const;

    /// The point of the node's surface at s in the unit square, uniform but for the chart's distortion; its normals
    /// on the node's side.
    SurfaceHit point_on(const PatchNode& node, const Vec2d& s) const;
    /// The same at a place of the side's chart.
    SurfaceHit point_of_side(const PatchSide& side, const Vec2d& uv) const;
    Vec2d middle_of(const PatchNode& node) const;

    /// Halves a leaf; its children are the last two nodes.
    void split(std::uint32_t node);

    /// Where a hit that is seen from wo lies; empty where there is no patch.
    struct Place {
        std::uint32_t leaf;
        Vec2d uv;
    };
    std::optional<Place> locate(const SurfaceHit& hit, const Vec3& wo) const;
    /// The weights of a leaf's corners at a place.
    std::array<double, 4> weights(const PatchNode& leaf, const Vec2d& uv) const;

    /// How many nodes a mesh of this size would have, without making one.
    static double estimated_nodes(const Charts& charts, double size);
    /// The side of a chart that reflects, if it does.
    static bool reflects(const Charts& charts, const Chart& chart, bool back);

private:
    void finish(PatchNode& node) const;
    bool is_fine_enough(const PatchNode& node, double size) const;

    const Charts& charts_;
    std::vector<PatchSide> sides_;
    std::vector<std::array<std::uint32_t, 2>> sides_of_chart_;  ///< front and back, or no_node
    std::vector<PatchNode> nodes_;
};

/// The corners of all leaves, each once in a side. A corner that lies inside an edge of a larger leaf (a T-junction)
/// is bound to the mean of that edge's ends, so that what is interpolated has no cracks.
class PatchVertices {
public:
    explicit PatchVertices(const PatchMesh& mesh);

    const std::vector<PatchVertex>& vertices() const { return vertices_; }
    const std::array<std::uint32_t, 4>& of_leaf(std::uint32_t node) const { return corners_[node]; }

    struct Bound {
        std::uint32_t vertex, first, second;
    };
    /// In an order in which each takes its value from final ones.
    const std::vector<Bound>& bound() const { return bound_; }

private:
    using VertexIndex = std::unordered_map<std::uint64_t, std::uint32_t>;  ///< by key_of()
    void bind(const PatchMesh& mesh, const std::vector<VertexIndex>& of_side);

    std::vector<PatchVertex> vertices_;
    std::vector<std::array<std::uint32_t, 4>> corners_;  ///< by node; unused ones of inner nodes
    std::vector<Bound> bound_;
};

}  // namespace gib
