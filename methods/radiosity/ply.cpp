#include "methods/radiosity/corners.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace gib {

std::string radiosity_ply(const RadiosityModel& model) {
    const auto& nodes = model.mesh().nodes();
    const auto& vertices = model.display().vertices();
    const std::size_t count = vertices.vertices().size();
    const std::vector<Colord> B = corner_radiosity(model);
    std::vector<std::uint32_t> leaves;
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
        if (nodes[i].is_leaf()) leaves.push_back(i);
    double largest = 0;
    for (const Colord& b : B)
        largest = std::max(largest, b.maxCoeff());
    std::string ply = fmt::format(
        "ply\nformat ascii 1.0\ncomment radiosity: B_red, B_green, B_blue in W/m^2\nelement vertex {}\nproperty float "
        "x\n"
        "property float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
        "property float B_red\nproperty float B_green\nproperty float B_blue\nproperty uchar red\nproperty uchar "
        "green\n"
        "property uchar blue\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        count, leaves.size());
    auto out = std::back_inserter(ply);
    for (std::size_t i = 0; i < count; ++i) {
        const PatchVertex& vertex = vertices.vertices()[i];
        const PatchSide& side = model.mesh().sides()[nodes[vertex.leaf].side];
        const Vec3d p = corner_position(model, vertex);
        const Vec3 n = model.mesh().point_of_side(side, vertex.uv).ns;
        const auto byte = [&](double b) { return largest > 0 ? static_cast<int>(255 * b / largest + 0.5) : 0; };
        fmt::format_to(out, "{:.9g} {:.9g} {:.9g} {:.6g} {:.6g} {:.6g} {:.9g} {:.9g} {:.9g} {} {} {}\n", p.x(), p.y(),
                       p.z(), n.x(), n.y(), n.z(), B[i][0], B[i][1], B[i][2], byte(B[i][0]), byte(B[i][1]),
                       byte(B[i][2]));
    }
    for (const std::uint32_t leaf : leaves) {
        const auto corners = corners_in_turn(model, leaf);
        const int n = nodes[leaf].corner_count();
        fmt::format_to(out, "{}", n);
        for (int k = 0; k < n; ++k)
            fmt::format_to(out, " {}", corners[static_cast<std::size_t>(k)]);
        *out++ = '\n';
    }
    return ply;
}

}  // namespace gib
