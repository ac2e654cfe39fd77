#pragma once
// Photons in a balanced kd-tree, and the searches for the nearest of them and for all within a radius.
//
// Leaves hold eight photons whose positions lie together by coordinate, so that one look at a leaf yields eight
// distances and the mask of those within the bound; only these are shown to the caller. What else a photon carries lies
// apart and is read for photons within the bound only. 29 bytes a photon: 12 of position, 16 of payload, 8 a leaf of
// nodes.

#include "common/core/huge_pages.h"
#include "methods/parts/photons/nearest_buffer.h"
#include "methods/parts/photons/photon.h"

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace gib {

class PhotonMap {
public:
    using Neighbour = gib::Neighbour;

    PhotonMap() = default;
    /// Builds the tree in parallel; the same photons in the same order give the same tree for any number of threads.
    /// While it does, it needs 29 bytes a photon more than the photons given. At most 2^32 - 1 photons, at finite
    /// positions. `unit` is what a power of 1 stands for [W, or what the photons carry instead].
    PhotonMap(std::vector<Photon> photons, double unit);

    std::size_t size() const { return payloads_.size(); }
    double unit() const { return unit_; }  ///< of the photons' power
    Photon operator[](std::size_t i) const {
        const PositionBlock& block = positions_[i / leaf_size];
        const std::size_t lane = i % leaf_size;
        return {Vec3(block.x[lane], block.y[lane], block.z[lane]), payloads_[i]};
    }
    /// What the map keeps [bytes].
    std::size_t memory() const {
        return positions_.size() * sizeof(PositionBlock) + payloads_.size() * sizeof(PhotonPayload) +
               nodes_.size() * sizeof(Node);
    }

    /// The k nearest photons to p within `max_distance` for which accept(photon, distance2) holds: fewer than k if
    /// there are no more. In no particular order except that, if there are k, the LAST one is the farthest. Of photons
    /// at the same distance the one with the lower index counts as nearer. `found` is cleared first and keeps its
    /// memory. A squared distance is (dx^2 + dy^2) + dz^2, each operation rounded; accept is only called for those
    /// within the largest distance that is still wanted.
    template <typename Accept>
    void nearest(const Vec3& p, std::size_t k, float max_distance, Accept&& accept,
                 std::vector<Neighbour>& neighbours) const;

    /// Calls visit(photon, distance2) for all photons with distance2 <= radius^2; their order is the same each time.
    template <typename Visit>
    void within(const Vec3& p, float radius, Visit&& visit) const;

private:
    static constexpr std::uint32_t leaf_size = 8;
    /// Positions of a leaf's photons; those that the last leaf lacks are not a number and so at no distance.
    struct alignas(32) PositionBlock {
        std::array<float, leaf_size> x, y, z;

        /// Of those within the bound one bit each; their squared distances from p are in `distance2`.
        std::uint32_t within(const Vec3& p, float bound, std::array<float, leaf_size>& distance2) const;
    };
    struct Node {
        float split;
        std::uint32_t axis;
    };
    /// A subtree of `leaves` leaves from leaf number `first`, whose root is node number `node`.
    struct Subtree {
        std::uint32_t node, first, leaves;
        Subtree child(bool left) const {
            const std::uint32_t half = leaves / 2;
            // Nodes in preorder: a subtree of n leaves has n - 1 nodes, so no child is ever stored.
            return left ? Subtree{node + 1, first, half} : Subtree{node + half, first + half, leaves - half};
        }
    };

    void build(const Subtree& tree);
    template <int axis>
    float split_at_median(std::size_t begin, std::size_t middle, std::size_t end);
    void store_leaves(const std::vector<Photon>& photons);

    /// Calls visit_photon(index, distance2) for the photons with distance2 <= bound(), nearer leaves first by and
    /// large.
    template <typename Bound, typename VisitPhoton>
    void traverse(const Vec3& p, const Bound& bound, const VisitPhoton& visit_photon) const;

    HugePageVector<PositionBlock> positions_;  ///< leaf after leaf
    HugePageVector<PhotonPayload> payloads_;   ///< in the same order
    HugePageVector<Node> nodes_;
    double unit_ = 1;
};

inline std::uint32_t PhotonMap::PositionBlock::within(const Vec3& p, float bound,
                                                      std::array<float, leaf_size>& distance2) const {
#ifdef __AVX2__
    const __m256 dx = _mm256_sub_ps(_mm256_load_ps(x.data()), _mm256_set1_ps(p.x()));
    const __m256 dy = _mm256_sub_ps(_mm256_load_ps(y.data()), _mm256_set1_ps(p.y()));
    const __m256 dz = _mm256_sub_ps(_mm256_load_ps(z.data()), _mm256_set1_ps(p.z()));
    const __m256 d2 = _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)), _mm256_mul_ps(dz, dz));
    _mm256_storeu_ps(distance2.data(), d2);
    return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(d2, _mm256_set1_ps(bound), _CMP_LE_OQ)));
#else
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < leaf_size; ++i) {
        distance2[i] = (sqr(x[i] - p.x()) + sqr(y[i] - p.y())) + sqr(z[i] - p.z());
        mask |= static_cast<std::uint32_t>(distance2[i] <= bound) << i;
    }
    return mask;
#endif
}

template <typename Bound, typename VisitPhoton>
void PhotonMap::traverse(const Vec3& p, const Bound& bound, const VisitPhoton& visit_photon) const {
    struct Pending {
        Subtree tree;
        std::array<float, 3> offset;  ///< of the tree's cell from p, by axis
        float distance2;
    };
    // Each level of the tree leaves one subtree for later; 2^32 photons have 29 levels.
    std::array<Pending, 40> stack;
    std::size_t depth = 0;
    if (positions_.empty()) return;
    stack[depth++] = {{0, 0, static_cast<std::uint32_t>(positions_.size())}, {0.f, 0.f, 0.f}, 0.f};
    std::array<float, leaf_size> distance2;
    while (depth > 0) {
        Pending at = stack[--depth];
        if (at.distance2 > bound()) continue;
        while (at.tree.leaves > 1) {
            const Node& node = nodes_[at.tree.node];
            const float to_plane = p[static_cast<Eigen::Index>(node.axis)] - node.split;
            const bool left = to_plane <= 0.f;
            Pending& far = stack[depth];
            far = at;
            far.tree = at.tree.child(!left);
            at.tree = at.tree.child(left);
            far.offset[node.axis] = to_plane;
            // In the order of a photon's distance: rounding is monotone, so no cell seems farther than what is in it.
            far.distance2 = (sqr(far.offset[0]) + sqr(far.offset[1])) + sqr(far.offset[2]);
            if (far.distance2 <= bound()) ++depth;
        }
        std::uint32_t mask = positions_[at.tree.first].within(p, bound(), distance2);
        for (; mask != 0; mask &= mask - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
            visit_photon(at.tree.first * leaf_size + lane, distance2[lane]);
        }
    }
}

template <typename Accept>
void PhotonMap::nearest(const Vec3& p, std::size_t k, float max_distance, Accept&& accept,
                        std::vector<Neighbour>& neighbours) const {
    NearestBuffer buffer(k, max_distance, neighbours);
    if (k > 0)
        traverse(
            p, [&] { return buffer.bound(); },
            [&](std::uint32_t photon, float distance2) {
                if (distance2 <= buffer.bound() && accept((*this)[photon], distance2)) buffer.offer(distance2, photon);
            });
    buffer.finish();
}

template <typename Visit>
void PhotonMap::within(const Vec3& p, float radius, Visit&& visit) const {
    const float bound = radius * radius;
    traverse(
        p, [=] { return bound; }, [&](std::uint32_t photon, float distance2) { visit((*this)[photon], distance2); });
}

}  // namespace gib
