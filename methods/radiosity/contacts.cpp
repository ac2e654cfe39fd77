#include "methods/radiosity/contacts.h"

#include "common/core/parallel.h"

#include <atomic>

namespace gib {

namespace {

constexpr std::size_t leaves_per_block = 64;
/// The height of rays over a patch, in radii of the patch.
constexpr float lift = 0.02f;
/// How far inside a patch the rays between its corners start and end, as a share of the way to its middle: walls
/// along its edges do not stand on it.
constexpr double inset = 0.02;

/// Tests the edges and the diagonals of a leaf: what stands across the patch crosses one of them.
bool is_clear(RayQueries& rays, const PatchMesh& mesh, const PatchNode& leaf) {
    const PatchSide& side = mesh.sides()[leaf.side];
    const Vec2d middle = mesh.middle_of(leaf);
    const auto count = static_cast<std::size_t>(leaf.corner_count());
    const auto corner = [&](std::size_t i) {
        const Vec2d uv = uv_of(leaf.corners[i]);
        return Vec2d(uv + inset * (middle - uv));
    };
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = i + 1; k < count; ++k)
            if (!way_is_clear(rays, mesh, side, corner(i), corner(k), leaf.radius)) return false;
    return true;
}

}  // namespace

bool way_is_clear(RayQueries& rays, const PatchMesh& mesh, const PatchSide& side, const Vec2d& from, const Vec2d& to,
                  double reach) {
    const auto lifted = [&](const Vec2d& uv) {
        const SurfaceHit hit = mesh.point_of_side(side, uv);
        return Vec3(hit.p + (hit.offset + lift * static_cast<float>(reach)) * hit.ng);
    };
    const Vec3 origin = lifted(from), end = lifted(to);
    return !rays.intersect({.o = origin, .d = end - origin, .t_max = 1.f});
}

void halve_at_contacts(PatchMesh& mesh, double least, std::uint64_t& rays) {
    std::atomic<std::uint64_t> traced = 0;
    for (std::size_t first = 0; first < mesh.nodes().size();) {
        const std::size_t end = mesh.nodes().size();
        std::vector<std::uint8_t> touched(end - first, 0);
        parallel_blocks(end - first, leaves_per_block, [&](std::size_t from, std::size_t to, std::size_t) {
            RayQueries queries(mesh.charts().scene());
            for (std::size_t i = from; i < to; ++i) {
                const PatchNode& node = mesh.nodes()[first + i];
                if (node.is_leaf() && node.radius > least && !mesh.chart_of(node).curved)
                    touched[i] = is_clear(queries, mesh, node) ? 0 : 1;
            }
            traced += queries.count();
        });
        for (std::size_t i = 0; i < touched.size(); ++i)
            if (touched[i]) mesh.split(static_cast<std::uint32_t>(first + i));
        first = end;
    }
    rays += traced;
}

}  // namespace gib
