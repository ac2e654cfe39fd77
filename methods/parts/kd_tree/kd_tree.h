#pragma once
// Points with payloads, such as photons, in a balanced kd-tree, with searches within a radius; the search for the
// nearest points is nearest.h. Source: Jensen 2001, chapter 6.
//
// A leaf holds eight points. Their positions are stored by coordinate, so that one look at a leaf yields eight
// distances and a mask of those within the bound; only these points are shown to the caller. The payloads are stored
// apart and read only for points within the bound. A point takes 13 bytes beside its payload: 12 for its position and
// 1 for its part of a node (8 bytes a leaf).

#include "common/core/huge_pages.h"
#include "common/core/math.h"

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace gib {

/// Point is a payload at a place: it has a member `p` [scene units], a type Point::Payload, trivially copyable and of
/// at least 16 bytes, to which it converts, and a constructor from a position and a payload.
template <typename Point>
class KdTree {
public:
    using Payload = typename Point::Payload;

    KdTree() = default;
    /// Builds the tree in parallel; the same points in the same order give the same tree for any number of threads.
    /// The build needs as much memory beside `points` as the tree has. Positions must be finite. Throws InputError
    /// for more than 2^32 - 1 points. Defined in kd_tree_build.h.
    explicit KdTree(const std::vector<Point>& points);

    std::size_t size() const { return payloads_.size(); }
    /// Point number i in the order of the tree.
    Point operator[](std::size_t i) const {
        const PositionBlock& block = positions_[i / leaf_size];
        const std::size_t lane = i % leaf_size;
        return {Vec3(block.x[lane], block.y[lane], block.z[lane]), payloads_[i]};
    }
    /// Size of the tree [bytes].
    std::size_t memory() const {
        return positions_.size() * sizeof(PositionBlock) + payloads_.size() * sizeof(Payload) +
               nodes_.size() * sizeof(Node);
    }

    /// Calls visit(index, distance2) for the points with distance2 <= bound(), which may fall on the way: points
    /// between the old bound and the new one may still be visited. Points near p come early. A squared distance is
    /// (dx^2 + dy^2) + dz^2 with each operation rounded.
    template <typename Bound, typename Visit>
    void traverse(const Vec3& p, const Bound& bound, const Visit& visit) const;

    /// Whether accept(point, distance2) holds for any point with distance2 <= radius^2.
    template <typename Accept>
    bool any_within(const Vec3& p, float radius, Accept&& accept) const;

    /// Calls visit(point, distance2) for all points with distance2 <= radius^2, in the same order each time.
    template <typename Visit>
    void within(const Vec3& p, float radius, Visit&& visit) const;
    /// The same with visit(index, distance2).
    template <typename Visit>
    void indices_within(const Vec3& p, float radius, Visit&& visit) const {
        const float bound = radius * radius;
        traverse(
            p, [=] { return bound; }, visit);
    }

private:
    static constexpr std::uint32_t leaf_size = 8;
    /// The positions of a leaf's points. Unused places of the last leaf are NaN, which lies at no distance.
    struct alignas(32) PositionBlock {
        std::array<float, leaf_size> x, y, z;

        /// Sets `distance2` to the squared distances from p and returns a mask with one bit for each
        /// that is within the bound.
        std::uint32_t within(const Vec3& p, float bound, std::array<float, leaf_size>& distance2) const;
    };
    /// An inner node: the points of its first child have p[axis] <= split, those of its
    /// second child p[axis] >= split.
    struct Node {
        float split;
        std::uint32_t axis;
    };
    /// A subtree of `leaves` leaves from leaf number `first`, whose root is node number `node`.
    struct Subtree {
        std::uint32_t node, first, leaves;
        Subtree child(bool left) const {
            const std::uint32_t half = leaves / 2;
            // Nodes stand in preorder. A subtree of n leaves has n - 1 nodes, so the numbers of
            // children need not be stored.
            return left ? Subtree{node + 1, first, half} : Subtree{node + half, first + half, leaves - half};
        }
    };

    void build(const Subtree& tree);
    template <int axis>
    float split_at_median(std::size_t begin, std::size_t middle, std::size_t end);
    void store_leaves(const std::vector<Point>& points);

    HugePageVector<PositionBlock> positions_;  ///< positions, leaf after leaf
    HugePageVector<Payload> payloads_;         ///< payloads in the same order
    HugePageVector<Node> nodes_;
};

template <typename Point>
inline std::uint32_t KdTree<Point>::PositionBlock::within(const Vec3& p, float bound,
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

template <typename Point>
template <typename Bound, typename Visit>
void KdTree<Point>::traverse(const Vec3& p, const Bound& bound, const Visit& visit) const {
    struct Pending {
        Subtree tree;
        std::array<float, 3> offset;  ///< distance of the subtree's box from p, by axis
        float distance2;
    };
    // On each level of the tree one subtree is left for later; 2^32 points have 29 levels.
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
            // The sum has the order of a point's squared distance; rounding is monotone, so a box never seems
            // farther away than a point in it.
            far.distance2 = (sqr(far.offset[0]) + sqr(far.offset[1])) + sqr(far.offset[2]);
            if (far.distance2 <= bound()) ++depth;
        }
        std::uint32_t mask = positions_[at.tree.first].within(p, bound(), distance2);
        for (; mask != 0; mask &= mask - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
            visit(at.tree.first * leaf_size + lane, distance2[lane]);
        }
    }
}

template <typename Point>
template <typename Accept>
bool KdTree<Point>::any_within(const Vec3& p, float radius, Accept&& accept) const {
    float bound = radius * radius;  // negative from the first such point on, so that the traversal ends
    traverse(
        p, [&] { return bound; },
        [&](std::uint32_t index, float distance2) {
            if (bound >= 0.f && accept((*this)[index], distance2)) bound = -1.f;
        });
    return bound < 0.f;
}

template <typename Point>
template <typename Visit>
void KdTree<Point>::within(const Vec3& p, float radius, Visit&& visit) const {
    indices_within(p, radius, [&](std::uint32_t index, float distance2) { visit((*this)[index], distance2); });
}

}  // namespace gib
