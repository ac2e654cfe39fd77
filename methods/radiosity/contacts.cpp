#include "methods/radiosity/contacts.h"

#include "common/core/parallel.h"

#include <atomic>

namespace gib {

namespace {

constexpr std::size_t patches_per_block = 64;
/// The height of rays over a patch, in radii of the patch.
constexpr float lift = 0.02f;
/// How far inside a patch the rays between its corners start and end, as a share of the way to its middle: walls
/// along its edges do not stand on it.
constexpr double inset = 0.02;

/// Tests the edges and the diagonals of a leaf: what stands across the patch crosses one of them.
bool is_clear(RayQueries& rays, const PatchMesh& mesh, const PatchNode& leaf) {
    std::array<SurfacePoint, 4> points;
    for (int i = 0; i < leaf.corner_count(); ++i) {
        points[static_cast<std::size_t>(i)] = mesh.inside_corner(leaf, i, inset);
        for (int k = 0; k < i; ++k)
            if (!way_is_clear(rays, points[static_cast<std::size_t>(i)], points[static_cast<std::size_t>(k)],
                              leaf.radius))
                return false;
    }
    return true;
}

}  // namespace

bool way_is_clear(RayQueries& rays, const SurfacePoint& from, const SurfacePoint& to, double reach) {
    const auto lifted = [&](const SurfacePoint& point) {
        return Vec3(point.p + (point.offset + lift * static_cast<float>(reach)) * point.ng);
    };
    const Vec3 origin = lifted(from);
    return !rays.intersect({.o = origin, .d = lifted(to) - origin, .t_max = 1.f});
}

void halve_at_contacts(PatchMesh& mesh, double least, std::uint64_t& rays) {
    std::atomic<std::uint64_t> traced = 0;
    for (std::size_t first = 0; first < mesh.nodes().size();) {
        const std::size_t end = mesh.nodes().size();
        std::vector<std::uint8_t> touched(end - first, 0);
        parallel_blocks(end - first, patches_per_block, [&](std::size_t from, std::size_t to, std::size_t) {
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
