#include "methods/radiosity/contacts.h"

#include <algorithm>

namespace gib {

namespace {

/// The distance of surfaces that touch over the scene's diagonal: more than the rounding of coordinates.
constexpr double touching = 1e-5;
/// The least cosine between the normals of surfaces that count as parallel.
constexpr double parallel = 0.999;

bool contains(const PatchPolygon& polygon, const Vec3d& p) {
    const auto corners = polygon.corners();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d& next = corners[i + 1 == corners.size() ? 0 : i + 1];
        if (!((next - corners[i]).cross(p - corners[i]).dot(polygon.normal) > 0)) return false;
    }
    return true;
}

}  // namespace

Contacts::Contacts(const PatchMesh& mesh)
    : mesh_(mesh),
      reach_(touching * static_cast<double>(mesh.charts().scene().diagonal())),
      neighbours_(mesh.sides().size()) {
    for (std::uint32_t side = 0; side < neighbours_.size(); ++side)
        find(side);
}

void Contacts::find(std::uint32_t index) {
    const PatchSide& side = mesh_.sides()[index];
    const PatchPolygon& polygon = mesh_.nodes()[side.root].polygon;
    std::vector<std::uint32_t> charts = {side.chart}, open = {0};
    while (!open.empty()) {
        const PatchNode& node = mesh_.nodes()[open.back()];
        open.pop_back();
        if ((node.center - side.center).norm() > node.radius + side.radius + reach_) continue;
        if (node.is_cluster()) {
            open.insert(open.end(), {node.child, node.child + 1});
            continue;
        }
        const PatchSide& other = mesh_.sides()[node.side];
        const double cosine = node.polygon.normal.dot(polygon.normal);
        if (std::abs(cosine) < parallel || std::ranges::find(charts, other.chart) != charts.end()) continue;
        charts.push_back(other.chart);  // once, for both of its sides
        neighbours_[index].push_back({&node.polygon, (cosine > 0) == (side.back == other.back)});
    }
}

double Contacts::share(std::uint32_t side, const Vec3d& p) const {
    int surfaces = 1;
    for (const Neighbour& other : neighbours_[side]) {
        if (std::abs(other.polygon->normal.dot(p - other.polygon->vertices[0])) > reach_) continue;
        if (!contains(*other.polygon, p)) continue;
        if (other.fronts_agree) ++surfaces;
        else if (!mesh_.sides()[side].back) return covered;
    }
    return 1.0 / surfaces;
}

}  // namespace gib
