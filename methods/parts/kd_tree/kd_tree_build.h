#pragma once
// The construction of a kd-tree, for the files that instantiate it for their kind of point.

#include "common/core/error.h"
#include "common/core/parallel.h"
#include "methods/parts/kd_tree/kd_tree.h"
#include "methods/parts/kd_tree/selection.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

namespace gib {

namespace detail {

/// Subtrees of at most this number of leaves are built by one task.
inline constexpr std::uint32_t parallel_leaves = 2048;
inline constexpr std::size_t leaves_per_block = 4096;

/// A point's position and number. During the build it occupies the memory of the point's payload.
struct Record {
    std::array<float, 3> p;
    std::uint32_t index;
};
template <typename Payload>
Record record_in(const Payload& memory) {
    Record record;
    std::memcpy(&record, &memory, sizeof record);
    return record;
}

/// A key with the order of (x, index). -0 counts as less than 0; either side is right for a point on the split plane.
inline std::uint64_t sort_key(float x, std::uint32_t index) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t ordered =
        bits ^ (static_cast<std::uint32_t>(static_cast<std::int32_t>(bits) >> 31) | 0x80000000u);
    return static_cast<std::uint64_t>(ordered) << 32 | index;
}

using Float4 = float __attribute__((vector_size(16)));

/// The axis along which the records extend farthest.
template <typename Payload>
int longest_axis(const Payload* begin, const Payload* end) {
    // The vectors have four lanes; the fourth holds the points' numbers and is ignored.
    Float4 lower = {infinity, infinity, infinity, infinity}, upper = -lower;
    for (const Payload* i = begin; i != end; ++i) {
        const auto v = std::bit_cast<Float4>(record_in(*i));
        lower = v < lower ? v : lower;
        upper = v > upper ? v : upper;
    }
    const Float4 extent = upper - lower;
    const int xy = extent[0] >= extent[1] ? 0 : 1;
    return extent[xy] >= extent[2] ? xy : 2;
}

}  // namespace detail

template <typename Point>
KdTree<Point>::KdTree(const std::vector<Point>& points) {
    static_assert(std::is_trivially_copyable_v<Payload> && sizeof(Payload) >= sizeof(detail::Record));
    if (points.empty()) return;
    if (points.size() > std::numeric_limits<std::uint32_t>::max())
        throw InputError("a kd-tree holds 4294967295 points at most, not " + std::to_string(points.size()));
    const std::size_t leaves = (points.size() + leaf_size - 1) / leaf_size;
    payloads_.resize(points.size());
    parallel_blocks(points.size(), detail::leaves_per_block * leaf_size,
                    [&](std::size_t begin, std::size_t end, std::size_t) {
                        for (std::size_t i = begin; i < end; ++i) {
                            const Vec3& p = points[i].p;
                            const detail::Record record{{p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(i)};
                            std::memcpy(static_cast<void*>(&payloads_[i]), &record, sizeof record);
                        }
                    });
    nodes_.resize(leaves - 1);
    build({0, 0, static_cast<std::uint32_t>(leaves)});
    positions_.resize(leaves);
    store_leaves(points);
}

/// Balances the kd-tree (Jensen 2001, section 6.3): splits at the median of the longest axis of the points' box,
/// rounded to a whole number of leaves.
template <typename Point>
void KdTree<Point>::build(const Subtree& tree) {
    if (tree.leaves == 1) return;
    const std::size_t begin = std::size_t{tree.first} * leaf_size;
    const std::size_t end = std::min(begin + std::size_t{tree.leaves} * leaf_size, payloads_.size());
    const std::size_t middle = begin + std::size_t{tree.leaves / 2} * leaf_size;
    const int axis = detail::longest_axis(payloads_.data() + begin, payloads_.data() + end);
    const float split = axis == 0   ? split_at_median<0>(begin, middle, end)
                        : axis == 1 ? split_at_median<1>(begin, middle, end)
                                    : split_at_median<2>(begin, middle, end);
    nodes_[tree.node] = {split, static_cast<std::uint32_t>(axis)};

    const auto left = [&] { build(tree.child(true)); };
    const auto right = [&] { build(tree.child(false)); };
    if (tree.leaves > detail::parallel_leaves) {
        parallel_pair(left, right);
    } else {
        left();
        right();
    }
}

/// Moves the records below the median before `middle` and the others behind it, and returns the median. Among equal
/// coordinates the point of lower number counts as smaller.
template <typename Point>
template <int axis>
float KdTree<Point>::split_at_median(std::size_t begin, std::size_t middle, std::size_t end) {
    Payload* const records = payloads_.data();
    select_kth(records + begin, records + middle, records + end, [](const Payload& memory) {
        const detail::Record record = detail::record_in(memory);
        return detail::sort_key(record.p[axis], record.index);
    });
    return detail::record_in(records[middle]).p[axis];
}

/// Fills the leaves: writes the positions and replaces the records by the payloads.
template <typename Point>
void KdTree<Point>::store_leaves(const std::vector<Point>& points) {
    parallel_blocks(positions_.size(), detail::leaves_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
            PositionBlock& block = positions_[leaf];
            block.x.fill(std::numeric_limits<float>::quiet_NaN());
            const std::size_t first = leaf * leaf_size;
            for (std::size_t lane = 0; lane < leaf_size && first + lane < payloads_.size(); ++lane) {
                const detail::Record record = detail::record_in(payloads_[first + lane]);
                block.x[lane] = record.p[0];
                block.y[lane] = record.p[1];
                block.z[lane] = record.p[2];
                payloads_[first + lane] = points[record.index];
            }
        }
    });
}

}  // namespace gib
