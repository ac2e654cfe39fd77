#include "methods/radiosity/mesh.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace gib {

namespace {

constexpr std::uint8_t max_halvings = 20;

ChartPoint middle(const ChartPoint& a, const ChartPoint& b) { return {(a.u + b.u) / 2, (a.v + b.v) / 2}; }

double shrunk(double length, std::uint8_t halvings) { return std::ldexp(length, -halvings); }

using Positions = std::array<Vec3d, 4>;

Positions positions(const Chart& chart, const std::array<ChartPoint, 4>& corners) {
    Positions p;
    for (std::size_t i = 0; i < 4; ++i)
        p[i] = chart.position(uv_of(corners[i]));
    return p;
}

/// The number i of the edge i -> i + 1 at which a triangle is halved: the longest in space, the first of equal ones.
std::size_t longest_edge(const Positions& p) {
    std::size_t longest = 0;
    double length2 = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double l = (p[(i + 1) % 3] - p[i]).squaredNorm();
        if (l > length2 * (1 + 1e-9)) {
            longest = i;
            length2 = l;
        }
    }
    return longest;
}

PatchPolygon polygon_of(const Chart& chart, const Positions& p, bool turned) {
    const PatchPolygon polygon =
        chart.triangle ? PatchPolygon::triangle(p[0], p[1], p[2]) : PatchPolygon::quad(p[0], p[1], p[2], p[3]);
    return turned ? polygon.flipped() : polygon;
}

/// Twice the area of the triangle a, b, c in chart coordinates; negative if it turns clockwise.
double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

Vec3d middle_of_chart(const Chart& chart) { return chart.position(Vec2d::Constant(chart.triangle ? 1.0 / 3 : 0.5)); }

double radius_of_chart(const Chart& chart) {
    double radius = 0;
    for (const Vec3d& corner : chart.corners)
        radius = std::max(radius, (corner - middle_of_chart(chart)).norm());
    return radius;
}

}  // namespace

bool PatchMesh::reflects(const Charts& charts, const Chart& chart, bool back) {
    const Material& material = charts.scene().material_of_shape(chart.shape);
    if (!material.traits().diffuse) return false;
    const SurfaceHit hit = charts.surface_at(chart, Vec2d::Constant(0.25));
    const bool flipped = hit.ns.dot(hit.ng) < 0.f;
    return hit.bsdf->traits_at(back != flipped ? -1.f : 1.f).diffuse;
}

double PatchMesh::estimated_patches(const Charts& charts, double size) {
    double patches = 0;
    for (std::size_t i = 0; i < charts.size(); ++i) {
        const Vec2d pieces = (charts[i].lengths() / size).cwiseMax(1.0);
        const int sides = (reflects(charts, charts[i], false) ? 1 : 0) + (reflects(charts, charts[i], true) ? 1 : 0);
        patches += sides * pieces.prod();
    }
    return patches;
}

PatchMesh::PatchMesh(const Charts& charts, double size) : charts_(charts), size_(size) {
    for (std::uint32_t i = 0; i < charts.size(); ++i)
        for (const bool back : {false, true})
            if (reflects(charts, charts[i], back)) sides_.push_back({i, back});
    if (!sides_.empty()) nodes_.push_back(node_of(0, static_cast<std::uint32_t>(sides_.size())));
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].is_cluster()) split_cluster(i);
        else if (!is_fine_enough(nodes_[i])) split(i);
    }
    sides_of_chart_.assign(charts.size(), {no_node, no_node});
    for (std::uint32_t i = 0; i < sides_.size(); ++i)
        sides_of_chart_[sides_[i].chart][sides_[i].back ? 1 : 0] = i;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
        if (!nodes_[i].is_cluster() && (i == 0 || nodes_[nodes_[i].parent].is_cluster()))
            sides_[nodes_[i].side].root = i;
}

PatchNode PatchMesh::node_of(std::uint32_t first, std::uint32_t end) {
    PatchNode node;
    node.side = first;
    node.side_end = end;
    const Chart& chart = charts_[sides_[first].chart];
    constexpr std::uint32_t one = chart_unit;
    if (end - first == 1) {
        node.corners = chart.triangle ? std::array<ChartPoint, 4>{{{0, 0}, {one, 0}, {0, one}, {0, one}}}
                                      : std::array<ChartPoint, 4>{{{0, 0}, {one, 0}, {one, one}, {0, one}}};
        finish(node);
        return node;
    }
    for (std::uint32_t i = first; i < end; ++i) {
        const Chart& c = charts_[sides_[i].chart];
        node.center += middle_of_chart(c) / (end - first);
        node.area +=
            polygon_of(c, {c.corners[0], c.corners[1], c.triangle ? c.corners[3] : c.corners[2], c.corners[3]}, false)
                .area;
    }
    for (std::uint32_t i = first; i < end; ++i)
        for (const Vec3d& corner : charts_[sides_[i].chart].corners)
            node.radius = std::max(node.radius, (corner - node.center).norm());
    return node;
}

/// Large charts are set apart first, so that they do not widen the clusters of small ones; then halves are taken at
/// the median of the centres along the longest extent.
void PatchMesh::split_cluster(std::uint32_t index) {
    const PatchNode node = nodes_[index];
    const auto begin = sides_.begin() + node.side, end = sides_.begin() + node.side_end;
    const auto chart_of_side = [&](const PatchSide& side) -> const Chart& { return charts_[side.chart]; };
    constexpr double large = 0.5;
    auto cut = std::stable_partition(
        begin, end, [&](const PatchSide& side) { return radius_of_chart(chart_of_side(side)) > large * node.radius; });
    if (cut == begin || cut == end) {
        Vec3d lower = Vec3d::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
        for (auto side = begin; side != end; ++side) {
            lower = lower.cwiseMin(middle_of_chart(chart_of_side(*side)));
            upper = upper.cwiseMax(middle_of_chart(chart_of_side(*side)));
        }
        Eigen::Index axis = 0;
        (upper - lower).maxCoeff(&axis);
        cut = begin + (end - begin) / 2;
        std::nth_element(begin, cut, end, [&](const PatchSide& a, const PatchSide& b) {
            const double x = middle_of_chart(chart_of_side(a))[axis], y = middle_of_chart(chart_of_side(b))[axis];
            return x != y ? x < y : std::pair(a.chart, a.back) < std::pair(b.chart, b.back);
        });
    }
    const auto middle = static_cast<std::uint32_t>(cut - sides_.begin());
    PatchNode first = node_of(node.side, middle), second = node_of(middle, node.side_end);
    first.parent = second.parent = index;
    nodes_[index].child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(first);
    nodes_.push_back(second);
}

std::size_t PatchMesh::leaf_count() const {
    return static_cast<std::size_t>(
        std::count_if(nodes_.begin(), nodes_.end(), [](const PatchNode& n) { return n.is_leaf(); }));
}

void PatchMesh::finish(PatchNode& node) const {
    const Chart& chart = chart_of(node);
    node.polygon = polygon_of(chart, positions(chart, node.corners), chart.reversed != sides_[node.side].back);
    node.area = node.polygon.area;
    for (const Vec3d& corner : node.polygon.corners())
        node.center += corner / node.polygon.count;
    for (const Vec3d& corner : node.polygon.corners())
        node.radius = std::max(node.radius, (corner - node.center).norm());
}

bool PatchMesh::is_fine_enough(const PatchNode& node) const {
    const Chart& chart = chart_of(node);
    if (node.along + node.across >= 2 * max_halvings) return true;
    if (chart.triangle) {
        const Positions p = positions(chart, node.corners);
        const std::size_t edge = longest_edge(p);
        return (p[(edge + 1) % 3] - p[edge]).norm() <= size_;
    }
    const Vec2d lengths = chart.lengths();
    // A piece of a curved shape may be a little longer than the parts into which the shape was divided.
    const double most = size_ * (chart.curved ? 1.5 : 1.0);
    return shrunk(lengths.x(), node.across) <= most && shrunk(lengths.y(), node.along) <= most;
}

void PatchMesh::split(std::uint32_t index) {
    const Chart& chart = chart_of(nodes_[index]);
    PatchNode first, second;
    first.side = second.side = nodes_[index].side;
    first.side_end = second.side_end = nodes_[index].side_end;
    first.parent = second.parent = index;
    const auto& c = nodes_[index].corners;
    first.across = second.across = nodes_[index].across;
    first.along = second.along = nodes_[index].along;
    const Vec2d lengths = chart.lengths();
    if (chart.triangle) {
        const std::size_t i = longest_edge(positions(chart, c));
        const ChartPoint a = c[i], b = c[(i + 1) % 3], apex = c[(i + 2) % 3], m = middle(a, b);
        first.corners = {apex, a, m, m};
        second.corners = {b, apex, m, m};
        ++first.across;
        ++second.across;
    } else if (shrunk(lengths.x(), first.across) >= shrunk(lengths.y(), first.along)) {
        const ChartPoint low = middle(c[0], c[1]), high = middle(c[3], c[2]);
        first.corners = {c[0], low, high, c[3]};
        second.corners = {low, c[1], c[2], high};
        ++first.across;
        ++second.across;
    } else {
        const ChartPoint left = middle(c[0], c[3]), right = middle(c[1], c[2]);
        first.corners = {c[0], c[1], right, left};
        second.corners = {left, right, c[2], c[3]};
        ++first.along;
        ++second.along;
    }
    finish(first);
    finish(second);
    nodes_[index].child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(first);
    nodes_.push_back(second);
}

void PatchMesh::set_exposure(const std::vector<bool>& dark, const std::vector<double>& uncovered) {
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        const std::uint32_t a = nodes_[i].child;
        nodes_[i].dark = a == no_node ? dark[i] : nodes_[a].dark && nodes_[a + 1].dark;
        nodes_[i].area = a == no_node ? uncovered[i] * nodes_[i].area : nodes_[a].area + nodes_[a + 1].area;
    }
}

Vec2d PatchMesh::middle_of(const PatchNode& node) const {
    const auto count = static_cast<std::size_t>(node.corner_count());
    Vec2d sum = Vec2d::Zero();
    for (std::size_t i = 0; i < count; ++i)
        sum += uv_of(node.corners[i]) / static_cast<double>(count);
    return sum;
}

SurfaceHit PatchMesh::inside_corner(const PatchNode& node, int corner, double inset) const {
    const Vec2d uv = uv_of(node.corners[static_cast<std::size_t>(corner)]);
    return point_of_side(sides_[node.side], uv + inset * (middle_of(node) - uv));
}

SurfaceHit PatchMesh::point_of_side(const PatchSide& side, const Vec2d& uv) const {
    SurfaceHit hit = charts_.surface_at(charts_[side.chart], uv);
    if (side.back) {
        hit.ng = -hit.ng;
        hit.ns = -hit.ns;
    }
    return hit;
}

SurfaceHit PatchMesh::point_on(const PatchNode& node, const Vec2d& s) const {
    const PatchSide& side = sides_[node.side];
    const Chart& chart = charts_[side.chart];
    const Vec2d a = uv_of(node.corners[0]);
    if (!chart.triangle) {
        // Between the widths of a trapezoid, the density of v is linear.
        const Vec2d extent = uv_of(node.corners[2]) - a;
        const Positions p = positions(chart, node.corners);
        const double low = (p[1] - p[0]).norm(), high = (p[2] - p[3]).norm();
        const double v = s.y() * (low + high) / (low + std::sqrt(std::lerp(sqr(low), sqr(high), s.y())));
        return point_of_side(side, a + extent.cwiseProduct(Vec2d(s.x(), std::min(v, 1.0))));
    }
    const Vec2 b = square_to_triangle(s.cast<float>());
    return point_of_side(side, a + static_cast<double>(b.x()) * (uv_of(node.corners[1]) - a) +
                                   static_cast<double>(b.y()) * (uv_of(node.corners[2]) - a));
}

std::optional<PatchMesh::Place> PatchMesh::locate(const SurfaceHit& hit, const Vec3& wo) const {
    const auto place = charts_.locate(hit);
    if (!place) return std::nullopt;
    const std::uint32_t side = sides_of_chart_[place->chart][wo.dot(hit.ng) < 0.f ? 1 : 0];
    if (side == no_node) return std::nullopt;
    const Vec2d uv = place->uv;
    std::uint32_t node = sides_[side].root;
    while (!nodes_[node].is_leaf()) {
        const std::uint32_t child = nodes_[node].child;
        const auto& c = nodes_[child].corners;
        bool first;
        if (charts_[place->chart].triangle) {
            // Both halves have the edge from the apex c[0] to m = c[2]; a = c[1] lies on the first half's side of it.
            const Vec2d apex = uv_of(c[0]), a = uv_of(c[1]), m = uv_of(c[2]);
            first = turn(apex, m, uv) * turn(apex, m, a) >= 0;
        } else {
            const Vec2d end = uv_of(c[2]);
            first = nodes_[child].across > nodes_[node].across ? uv.x() < end.x() : uv.y() < end.y();
        }
        node = first ? child : child + 1;
    }
    return Place{node, uv};
}

std::array<double, 4> PatchMesh::weights(const PatchNode& leaf, const Vec2d& uv) const {
    const Vec2d a = uv_of(leaf.corners[0]);
    if (leaf.corner_count() == 3) {
        const Vec2d b = uv_of(leaf.corners[1]), c = uv_of(leaf.corners[2]);
        const double whole = turn(a, b, c);
        const double wb = std::clamp(turn(a, uv, c) / whole, 0.0, 1.0);
        const double wc = std::clamp(turn(a, b, uv) / whole, 0.0, 1.0 - wb);
        return {1 - wb - wc, wb, wc, 0};
    }
    const Vec2d s = (uv - a).cwiseQuotient(uv_of(leaf.corners[2]) - a).cwiseMax(0.0).cwiseMin(1.0);
    return {(1 - s.x()) * (1 - s.y()), s.x() * (1 - s.y()), s.x() * s.y(), (1 - s.x()) * s.y()};
}

PatchVertices::PatchVertices(const PatchMesh& mesh) {
    /// How far inside its leaf a vertex on the border of a chart is evaluated, as a share of the way to the leaf's
    /// middle: where surfaces meet, irradiance jumps.
    constexpr double inset = 1e-3;
    const auto& nodes = mesh.nodes();
    corners_.assign(nodes.size(), {no_node, no_node, no_node, no_node});
    std::vector<VertexIndex> of_side(mesh.sides().size());
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        const PatchNode& node = nodes[i];
        if (!node.is_leaf()) continue;
        const bool triangle = node.corner_count() == 3;
        for (std::size_t k = 0; k < (triangle ? 3u : 4u); ++k) {
            const ChartPoint at = node.corners[k];
            const auto [entry, is_new] =
                of_side[node.side].try_emplace(key_of(at), static_cast<std::uint32_t>(vertices_.size()));
            corners_[i][k] = entry->second;
            if (!is_new) continue;
            const bool border = at.u == 0 || at.v == 0 || at.u == chart_unit || at.v == chart_unit ||
                                (triangle && at.u + at.v == chart_unit);
            Vec2d uv = uv_of(at);
            if (border) uv += inset * (mesh.middle_of(node) - uv);
            vertices_.push_back({i, at, uv});
        }
    }
    bind(mesh, of_side);
}

void PatchVertices::bind(const PatchMesh& mesh, const std::vector<VertexIndex>& of_side) {
    struct Edge {
        ChartPoint a, b;
        std::uint32_t va, vb;
    };
    const auto& nodes = mesh.nodes();
    std::vector<Bound> hanging(vertices_.size(), {no_node, 0, 0});
    std::vector<Edge> edges;
    for (std::uint32_t leaf = 0; leaf < nodes.size(); ++leaf) {
        if (!nodes[leaf].is_leaf()) continue;
        const VertexIndex& index = of_side[nodes[leaf].side];
        const auto count = static_cast<std::size_t>(nodes[leaf].corner_count());
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t next = (k + 1) % count;
            edges.push_back({.a = nodes[leaf].corners[k],
                             .b = nodes[leaf].corners[next],
                             .va = corners_[leaf][k],
                             .vb = corners_[leaf][next]});
            while (!edges.empty()) {
                const Edge edge = edges.back();
                edges.pop_back();
                const ChartPoint m = middle(edge.a, edge.b);
                const auto found = m == edge.a || m == edge.b ? index.end() : index.find(key_of(m));
                if (found == index.end()) continue;
                hanging[found->second] = {found->second, edge.va, edge.vb};
                edges.push_back({.a = m, .b = edge.b, .va = found->second, .vb = edge.vb});
                edges.push_back({.a = edge.a, .b = m, .va = edge.va, .vb = found->second});
            }
        }
    }
    // Both ends of a vertex's edge are put before the vertex. Each step leads to a longer edge, so the recursion ends.
    const std::function<void(std::uint32_t)> settle = [&](std::uint32_t vertex) {
        const Bound bound = std::exchange(hanging[vertex], {no_node, 0, 0});
        if (bound.vertex == no_node) return;
        settle(bound.first);
        settle(bound.second);
        bound_.push_back(bound);
    };
    for (std::uint32_t i = 0; i < hanging.size(); ++i)
        settle(i);
}

}  // namespace gib
