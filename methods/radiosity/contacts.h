#pragma once
// Patches of surfaces that touch, and the share of their points to which light gets.

#include "methods/radiosity/mesh.h"

#include <algorithm>

namespace gib {

/// Surfaces that touch. Where surfaces lie in one plane and face the same way, light meets only one of them at each point,
/// so each of m surfaces has the share 1 / m of the light there; the upper one has all if rays find which it is. Where
/// the fronts of two surfaces lie on each other, as the bottom of a block does on a floor, no light gets between them.
class Contacts {
public:
    /// The share of a covered point: not 0, so that its light is known, too, but small, so that it hardly counts for others.
    static constexpr double covered = 1e-3;

    /// `mesh` must outlive this.
    explicit Contacts(const PatchMesh& mesh)
        : mesh_(mesh),
          reach_(touching * static_cast<double>(mesh.charts().scene().diagonal())),
          distinct_(distinct * static_cast<double>(mesh.charts().scene().diagonal())),
          neighbours_(mesh.sides().size()) {
        for (std::uint32_t side = 0; side < neighbours_.size(); ++side)
            find(side);
    }

    /// The largest distance of surfaces that touch [scene units].
    double reach() const { return reach_; }
    /// The share of a point p of a side at which light arrives: 1 where nothing touches it, `covered` under a front.
    double share(std::uint32_t side, const Vec3d& p) const {
        int surfaces = 1;
        const Vec3d& outwards = mesh_.nodes()[mesh_.sides()[side].root].polygon.normal;
        for (const Neighbour& other : neighbours_[side]) {
            const Vec3d& normal = other.polygon->normal;
            // How far p lies below the other surface.
            const double below = normal.dot(other.polygon->vertices[0] - p) / normal.dot(outwards);
            if (std::abs(below) > reach_ || below < -distinct_ || !contains(*other.polygon, p)) continue;
            if (below > distinct_) return covered;
            if (other.fronts_agree) ++surfaces;
            else if (!mesh_.sides()[side].back) return covered;
        }
        return 1.0 / surfaces;
    }

private:
    /// Distances over the scene's diagonal: surfaces nearer than `touching` touch; rays find which is in front beyond
    /// `distinct`.
    static constexpr double touching = 1e-5, distinct = 1e-6;
    /// The least cosine between the normals of surfaces that count as parallel.
    static constexpr double parallel = 0.999;

    struct Neighbour {
        const PatchPolygon* polygon;
        bool fronts_agree;  ///< the fronts of both charts face the same way
    };

    static bool contains(const PatchPolygon& polygon, const Vec3d& p) {
        const auto corners = polygon.corners();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vec3d& next = corners[i + 1 == corners.size() ? 0 : i + 1];
            if (!((next - corners[i]).cross(p - corners[i]).dot(polygon.normal) > 0)) return false;
        }
        return true;
    }

    void find(std::uint32_t index) {
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

    const PatchMesh& mesh_;
    double reach_, distinct_;
    std::vector<std::vector<Neighbour>> neighbours_;  ///< parallel surfaces near each side
};

}  // namespace gib
