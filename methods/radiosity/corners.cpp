#include "methods/radiosity/corners.h"

#include <algorithm>
#include <map>

namespace gib {

namespace {

/// Shape, place in steps of a thousandth of a patch, and normal in steps of 1/64, so that rounding parts no corners.
using Identity = std::array<long, 7>;

Identity identity_of(std::uint32_t shape, const Vec3d& p, const Vec3& n) {
    const auto normal = [&](int i) { return std::lround(64 * n[i]); };
    return {shape, std::lround(p.x()), std::lround(p.y()), std::lround(p.z()), normal(0), normal(1), normal(2)};
}

}  // namespace

PatchCorners::PatchCorners(const PatchMesh& mesh) : mesh_(mesh), of_leaf_(mesh.nodes().size()) {
    std::map<Identity, std::uint32_t> known;
    for (const std::uint32_t i : mesh.leaves()) {
        const PatchNode& leaf = mesh.nodes()[i];
        const Chart& chart = mesh.chart_of(leaf);
        for (std::size_t k = 0; k < leaf.corner_count(); ++k) {
            const Vec3d p = chart.position(leaf.corners[k]);
            const Vec3 n = mesh.point_of_side(mesh.sides()[leaf.side], leaf.corners[k]).ns;
            const auto [entry, is_new] = known.try_emplace(identity_of(chart.shape, 1000 / mesh.size() * p, n),
                                                           static_cast<std::uint32_t>(places_.size()));
            of_leaf_[i][k] = entry->second;
            if (is_new) places_.push_back(p.cast<float>());
        }
    }
}

std::array<std::uint32_t, 4> PatchCorners::in_turn(std::uint32_t leaf) const {
    const PatchNode& node = mesh_.nodes()[leaf];
    std::array<std::uint32_t, 4> corners = of_leaf_[leaf];
    // The mesh has the corners in the chart's order, which is the opposite one on one of its two sides.
    if (mesh_.chart_of(node).reversed != mesh_.sides()[node.side].back)
        std::reverse(corners.begin(), corners.begin() + node.polygon.count);
    if (node.corner_count() == 3) corners[3] = corners[2];
    return corners;
}

/// Each round adds to a corner the mean, over the patches around it, of what the mean of their corners lacks. The first
/// gives the mean of the patches; without the others, patches at an edge would lose light, as there is often more of it
/// than in the patches beside them.
std::vector<Colord> PatchCorners::values(const PatchColors& of_leaves, const std::vector<double>& areas) const {
    constexpr int rounds = 4;
    std::vector<Colord> values(size(), Colord::Zero());
    for (int round = 0; round < rounds; ++round) {
        std::vector<Colord> lacking(size(), Colord::Zero());
        std::vector<double> area(size(), 0.0);
        for (const std::uint32_t leaf : mesh_.leaves()) {
            const PatchNode& node = mesh_.nodes()[leaf];
            const std::span corners(of_leaf_[leaf].data(), node.corner_count());
            Colord mean = Colord::Zero();
            for (const std::uint32_t corner : corners)
                mean += values[corner] / static_cast<double>(corners.size());
            for (const std::uint32_t corner : corners) {
                lacking[corner] += areas[leaf] * (of_leaves[leaf] - mean);
                area[corner] += areas[leaf];
            }
        }
        for (std::size_t i = 0; i < size(); ++i)
            values[i] += lacking[i] / area[i];
    }
    for (Colord& value : values)
        value = value.max(0.0);
    return values;
}

}  // namespace gib
