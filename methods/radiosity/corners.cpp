#include "methods/radiosity/corners.h"

#include <algorithm>

namespace gib {

namespace {

Colord radiosity_of(const RadiosityModel& model, std::uint32_t leaf, std::uint32_t vertex) {
    const std::uint32_t patch = model.display().solved_patch(leaf);
    const Colord indirect = model.display().vertex_irradiance()[vertex].cast<double>();
    return model.light().reflectance[patch] * (model.light().irradiance[patch] + indirect);
}

}  // namespace

std::vector<Colord> corner_radiosity(const RadiosityModel& model) {
    const auto& nodes = model.mesh().nodes();
    const auto& vertices = model.display().vertices();
    const std::size_t count = vertices.vertices().size();
    std::vector<Colord> B(count, Colord::Zero());
    std::vector<double> area(count, 0.0);
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf()) continue;
        for (std::size_t k = 0; k < static_cast<std::size_t>(nodes[i].corner_count()); ++k) {
            const std::uint32_t vertex = vertices.of_leaf(i)[k];
            B[vertex] += nodes[i].area * radiosity_of(model, i, vertex);
            area[vertex] += nodes[i].area;
        }
    }
    for (std::size_t i = 0; i < count; ++i)
        if (area[i] > 0) B[i] /= area[i];
    return B;
}

Vec3d corner_position(const RadiosityModel& model, const PatchVertex& corner) {
    const PatchSide& side = model.mesh().sides()[model.mesh().nodes()[corner.leaf].side];
    return model.mesh().charts()[side.chart].position(uv_of(corner.at));
}

std::array<std::uint32_t, 4> corners_in_turn(const RadiosityModel& model, std::uint32_t leaf) {
    const PatchNode& node = model.mesh().nodes()[leaf];
    const PatchSide& side = model.mesh().sides()[node.side];
    std::array<std::uint32_t, 4> corners = model.display().vertices().of_leaf(leaf);
    // The mesh has the corners in the chart's order, which is the opposite one on one of its two sides.
    if (model.mesh().charts()[side.chart].reversed != side.back)
        std::reverse(corners.begin(), corners.begin() + node.corner_count());
    return corners;
}

StoredPatches stored_patches(const RadiosityModel& model) {
    StoredPatches stored;
    for (const PatchVertex& corner : model.display().vertices().vertices())
        stored.corners.push_back(corner_position(model, corner).cast<float>());
    for (const Colord& b : corner_radiosity(model))
        stored.radiosity.push_back(b.cast<float>());
    const auto& nodes = model.mesh().nodes();
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf()) continue;
        std::array<std::uint32_t, 4> corners = corners_in_turn(model, i);
        if (nodes[i].corner_count() == 3) corners[3] = corners[2];
        stored.patches.push_back(corners);
    }
    return stored;
}

}  // namespace gib
