#include "methods/radiosity/mesh.h"

#include "common/sampling/warp.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace gib {

namespace {

using Positions = std::array<Vec3d, 4>;

Positions positions(const Chart& chart, const std::array<Vec2d, 4>& corners) {
    Positions p;
    for (std::size_t i = 0; i < 4; ++i)
        p[i] = chart.position(corners[i]);
    return p;
}

/// How often a length is halved until it is at most `allowed`.
double halvings(double length, double allowed) { return std::ceil(std::log2(std::max(length / allowed, 1.0))); }

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

/// The longest edge of a patch with four corners. A piece of a curved shape may be a little longer than the parts into which the
/// shape was divided.
double most_length(const Chart& chart, double size) { return size * (chart.curved ? 1.5 : 1.0); }

/// Whether the back or the front of a chart can reflect diffusely.
bool reflects(const Charts& charts, const Chart& chart, bool back) {
    const Material& material = charts.scene().material_of_shape(chart.shape);
    if (!material.traits().diffuse) return false;
    const SurfaceHit hit = charts.surface_at(chart, Vec2d::Constant(0.25));
    const bool flipped = hit.ns.dot(hit.ng) < 0.f;
    return hit.bsdf->traits_at(back != flipped ? -1.f : 1.f).diffuse;
}

}  // namespace

double PatchMesh::estimated_patches(const Charts& charts, double size) {
    double patches = 0;
    for (std::size_t i = 0; i < charts.size(); ++i) {
        const Chart& chart = charts[i];
        const int sides = (reflects(charts, chart, false) ? 1 : 0) + (reflects(charts, chart, true) ? 1 : 0);
        const Vec2d lengths = chart.lengths();
        // Halving twice halves a triangle's edges.
        const double times = chart.triangle ? halvings(sqr(lengths.maxCoeff() / size), 1)
                                            : halvings(lengths.x(), most_length(chart, size)) +
                                                  halvings(lengths.y(), most_length(chart, size));
        patches += sides * std::exp2(times);
    }
    return patches;
}

PatchMesh::PatchMesh(const Charts& charts, double size) : charts_(charts), size_(size) {
    for (std::uint32_t i = 0; i < charts.size(); ++i)
        for (const bool back : {false, true})
            if (reflects(charts, charts[i], back)) add_side(i, back);
    if (!sides_.empty()) nodes_.push_back(node_of(0, static_cast<std::uint32_t>(sides_.size())));
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].is_cluster()) split_cluster(i);
        else if (!is_fine_enough(nodes_[i])) split_patch(i);
        else leaves_.push_back(i);
    }
    sides_of_chart_.assign(charts.size(), {no_node, no_node});
    for (std::uint32_t i = 0; i < sides_.size(); ++i)
        sides_of_chart_[sides_[i].chart][sides_[i].back ? 1 : 0] = i;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
        if (!nodes_[i].is_cluster() && (i == 0 || nodes_[nodes_[i].parent].is_cluster()))
            sides_[nodes_[i].side].root = i;
}

void PatchMesh::add_side(std::uint32_t chart, bool back) {
    const Chart& c = charts_[chart];
    PatchSide side{.chart = chart, .back = back, .area = polygon_of(c, c.corners, false).area};
    side.center = c.position(Vec2d::Constant(c.triangle ? 1.0 / 3 : 0.5));
    for (const Vec3d& corner : c.corners)
        side.radius = std::max(side.radius, (corner - side.center).norm());
    sides_.push_back(side);
}

PatchNode PatchMesh::node_of(std::uint32_t first, std::uint32_t end) const {
    PatchNode node;
    node.side = first;
    node.side_end = end;
    if (end - first == 1) {
        const bool triangle = chart_of(node).triangle;
        node.corners = {Vec2d(0, 0), Vec2d(1, 0), Vec2d(triangle ? 0 : 1, 1), Vec2d(0, 1)};
        finish(node);
        return node;
    }
    for (std::uint32_t i = first; i < end; ++i) {
        node.center += sides_[i].center / (end - first);
        node.area += sides_[i].area;
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
    auto cut = std::stable_partition(begin, end, [&](const PatchSide& side) { return side.radius > node.radius / 2; });
    if (cut == begin || cut == end) {
        Vec3d lower = begin->center, upper = lower;
        for (auto side = begin; side != end; ++side) {
            lower = lower.cwiseMin(side->center);
            upper = upper.cwiseMax(side->center);
        }
        Eigen::Index axis = 0;
        (upper - lower).maxCoeff(&axis);
        cut = begin + (end - begin) / 2;
        std::nth_element(begin, cut, end, [&](const PatchSide& a, const PatchSide& b) {
            return std::tuple(a.center[axis], a.chart, a.back) < std::tuple(b.center[axis], b.chart, b.back);
        });
    }
    const auto middle = static_cast<std::uint32_t>(cut - sides_.begin());
    add_children(index, node_of(node.side, middle), node_of(middle, node.side_end));
}

void PatchMesh::add_children(std::uint32_t node, PatchNode first, PatchNode second) {
    first.parent = second.parent = node;
    nodes_[node].child = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(std::move(first));
    nodes_.push_back(std::move(second));
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

Vec2d PatchMesh::lengths_of(const PatchNode& quad) const {
    return chart_of(quad).lengths().cwiseProduct(quad.corners[2] - quad.corners[0]);
}

bool PatchMesh::is_fine_enough(const PatchNode& node) const {
    const Chart& chart = chart_of(node);
    if (chart.triangle) {
        const Positions p = positions(chart, node.corners);
        const std::size_t edge = longest_edge(p);
        return (p[(edge + 1) % 3] - p[edge]).norm() <= size_;
    }
    return lengths_of(node).maxCoeff() <= most_length(chart, size_);
}

/// A triangle is halved at its longest edge, so that its halves are no needles; a quadrilateral across its longer
/// extent.
void PatchMesh::split_patch(std::uint32_t index) {
    const PatchNode& node = nodes_[index];
    const auto& c = node.corners;
    PatchNode first, second;
    first.side = second.side = node.side;
    first.side_end = second.side_end = node.side_end;
    if (chart_of(node).triangle) {
        const std::size_t i = longest_edge(positions(chart_of(node), c));
        const Vec2d a = c[i], b = c[(i + 1) % 3], apex = c[(i + 2) % 3], m = (a + b) / 2;
        first.corners = {apex, a, m, m};
        second.corners = {b, apex, m, m};
    } else if (const Vec2d lengths = lengths_of(node); lengths.x() >= lengths.y()) {
        const Vec2d low = (c[0] + c[1]) / 2, high = (c[3] + c[2]) / 2;
        first.corners = {c[0], low, high, c[3]};
        second.corners = {low, c[1], c[2], high};
    } else {
        const Vec2d left = (c[0] + c[3]) / 2, right = (c[1] + c[2]) / 2;
        first.corners = {c[0], c[1], right, left};
        second.corners = {left, right, c[2], c[3]};
    }
    finish(first);
    finish(second);
    add_children(index, first, second);
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
    const Vec2d a = node.corners[0];
    if (!chart.triangle) {
        // The area that du dv covers in a plane quadrilateral is linear in u and in v.
        const Positions p = positions(chart, node.corners);
        const auto area = [&](std::size_t i) { return (p[(i + 1) % 4] - p[i]).cross(p[(i + 3) % 4] - p[i]).norm(); };
        const double v = sample_linear(s.y(), area(0) + area(1), area(3) + area(2));
        const double u = sample_linear(s.x(), std::lerp(area(0), area(3), v), std::lerp(area(1), area(2), v));
        const Vec2d extent = node.corners[2] - a;
        return point_of_side(side, a + extent.cwiseProduct(Vec2d(u, v)));
    }
    const Vec2 b = square_to_triangle(s.cast<float>());
    return point_of_side(side, a + static_cast<double>(b.x()) * (node.corners[1] - a) +
                                   static_cast<double>(b.y()) * (node.corners[2] - a));
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
        // The halves of a triangle share the edge from the apex c[0] to c[2]; c[1] lies on the first half's side of it.
        const bool first = charts_[place->chart].triangle           ? turn(c[0], c[2], uv) * turn(c[0], c[2], c[1]) >= 0
                           : c[2].x() < nodes_[node].corners[2].x() ? uv.x() < c[2].x()
                                                                    : uv.y() < c[2].y();
        node = first ? child : child + 1;
    }
    return Place{node, uv};
}

std::array<double, 4> PatchMesh::weights(const PatchNode& leaf, const Vec2d& uv) const {
    const Vec2d a = leaf.corners[0];
    if (leaf.corner_count() == 3) {
        const Vec2d b = leaf.corners[1], c = leaf.corners[2];
        const double whole = turn(a, b, c);
        const double wb = std::clamp(turn(a, uv, c) / whole, 0.0, 1.0);
        const double wc = std::clamp(turn(a, b, uv) / whole, 0.0, 1.0 - wb);
        return {1 - wb - wc, wb, wc, 0};
    }
    const Vec2d s = (uv - a).cwiseQuotient(leaf.corners[2] - a).cwiseMax(0.0).cwiseMin(1.0);
    return {(1 - s.x()) * (1 - s.y()), s.x() * (1 - s.y()), s.x() * s.y(), (1 - s.x()) * s.y()};
}

}  // namespace gib
