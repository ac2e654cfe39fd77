#pragma once
// Search of a kd-tree for the points nearest to a place (Jensen 2001, section 6.4), and the buffer that keeps the k
// nearest of the candidates on the way.

#include "common/core/math.h"
#include "methods/parts/kd_tree/kd_tree.h"
#include "methods/parts/kd_tree/selection.h"

#include <algorithm>
#include <array>
#include <bit>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gib {

/// A point found by a search, with its squared distance [scene units^2].
struct Neighbour {
    float distance2;
    std::uint32_t index;  ///< index of the point in the tree

    Neighbour() {}  // leaves the members as they are, so that to enlarge a buffer costs nothing
    Neighbour(float squared, std::uint32_t of) : distance2(squared), index(of) {}
    friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
};

/// The memory of a thread's look-ups, which none of them has to take for itself. A look-up must not begin within
/// another.
inline std::vector<Neighbour>& neighbours_of_thread() {
    static thread_local std::vector<Neighbour> neighbours;
    return neighbours;
}

/// Keeps the k nearest of the candidates offered to it. The buffer has room for more than k and is cut back to the k
/// nearest whenever it is full, so an offer takes constant time on average, where a heap takes time log k.
///
/// If k is large, candidates are also counted in buckets of equal width in squared distance, from the time on when
/// there are more than k. As soon as the buckets without the last one hold k, the last one is no longer needed, so the
/// bound falls with every few offers and the search meets fewer useless candidates. In the end only the few candidates
/// in the bucket of the k-th nearest are sorted by selection.
class NearestBuffer {
public:
    NearestBuffer(std::size_t k, float max_distance, std::vector<Neighbour>& storage)
        : k_(k),
          capacity_(k < least_to_count ? k + k / 2 + 16 : k + k / 16),
          bound_(max_distance * max_distance),
          storage_(storage) {
        const std::size_t size = k < least_to_count ? capacity_ : 4 * k_;
        if (storage_.size() < size) storage_.resize(size);
        begin_ = storage_.data();
    }
    /// Squared distance beyond which no candidate is needed any more. It falls as candidates are offered.
    float bound() const { return bound_; }
    void offer(float distance2, std::uint32_t index) {
        begin_[size_++] = {distance2, index};
        if (buckets_per_distance2_ > 0.f) count(distance2);
        if (size_ == capacity_) make_room();
    }
    /// Leaves the nearest candidates in the storage, at most k. If there are k, the last one is the farthest.
    void finish() {
        if (k_ > 0 && size_ >= k_) {
            if (k_ >= least_to_count && !(buckets_per_distance2_ > 0.f)) start_counting();
            shrink();
        }
        storage_.resize(size_);
    }

private:
    /// The least k for which candidates are counted, and the number of buckets.
    static constexpr std::size_t least_to_count = 128, buckets = 256;

    std::uint32_t bucket_of(float distance2) const {
        return std::min(static_cast<std::uint32_t>(distance2 * buckets_per_distance2_),
                        static_cast<std::uint32_t>(buckets - 1));
    }
    void count(float distance2) {
        const std::uint32_t bucket = bucket_of(distance2);
        ++count_[bucket];
        nearer_ += bucket <= last_ ? 1 : 0;
        drop_buckets();
    }
    /// Drops last buckets while the others hold k candidates.
    void drop_buckets() {
        if (nearer_ - count_[last_] < k_) return;
        do
            nearer_ -= count_[last_--];
        while (nearer_ - count_[last_] >= k_);
        // The margin is larger than the rounding of bucket_of().
        bound_ = std::min(bound_, 1.00001f * static_cast<float>(last_ + 1) / buckets_per_distance2_);
    }
    /// Counts the candidates in the buffer. There are k or more.
    void start_counting() {
        float farthest = bound_;
        if (!(farthest < infinity))
            for (farthest = 0.f; const Neighbour& n : std::span(begin_, size_))
                farthest = std::max(farthest, n.distance2);
        const float scale = static_cast<float>(buckets) / farthest;
        if (!(farthest < infinity && scale < infinity)) return;
        buckets_per_distance2_ = scale;
        count_.fill(0);
        for (const Neighbour& n : std::span(begin_, size_))
            ++count_[bucket_of(n.distance2)];
        last_ = buckets - 1;
        nearer_ = size_;
        drop_buckets();
    }

    void make_room() {
        if (k_ < least_to_count) return shrink();
        if (size_ >= 2 * k_) shrink();
        start_counting();
        if (size_ == capacity_) capacity_ = 2 * k_;
    }

    /// Cuts the buffer back to the k nearest.
    void shrink() {
        Neighbour* const kth = begin_ + (k_ - 1);
        Neighbour* const unsorted = begin_ + (buckets_per_distance2_ > 0.f ? part_last_bucket() : 0);
        // Positive floats have the order of their bits; ties in distance are broken by the index.
        select_kth(unsorted, kth, begin_ + size_, [](const Neighbour& n) {
            return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(n.distance2)) << 32 | n.index;
        });
        size_ = k_;
        bound_ = kth->distance2;
        buckets_per_distance2_ = 0.f;
    }
    /// Removes the candidates in dropped buckets and moves those of the last bucket behind the others. Returns the
    /// number of the others, which is less than k.
    std::size_t part_last_bucket() {
        Neighbour* const aside = begin_ + 2 * k_;
        std::size_t nearer = 0, in_last = 0;
        for (std::size_t i = 0; i < size_; ++i) {
            const Neighbour n = begin_[i];
            const std::uint32_t bucket = bucket_of(n.distance2);
            begin_[nearer] = n;
            aside[in_last] = n;
            nearer += bucket < last_ ? 1 : 0;
            in_last += bucket == last_ ? 1 : 0;
        }
        std::copy(aside, aside + in_last, begin_ + nearer);
        size_ = nearer + in_last;
        return nearer;
    }

    std::size_t k_, capacity_, size_ = 0;
    float bound_;
    Neighbour* begin_;
    std::vector<Neighbour>& storage_;

    float buckets_per_distance2_ = 0.f;  ///< 0: nothing is counted
    std::uint32_t last_ = 0;             ///< the bucket of the k-th nearest so far
    std::size_t nearer_ = 0;             ///< number of candidates in buckets up to this one
    std::array<std::uint32_t, buckets> count_;
};

/// Finds the k points nearest to p within `max_distance` [scene units] for which accept(point, distance2) holds, or all
/// of these if there are fewer. Their order is arbitrary, but if there are k, the LAST one is the farthest. Of points
/// at equal distance the one with the lower index counts as nearer. `neighbours` is cleared first and keeps its memory.
/// accept is called only for points within the largest distance that still matters.
template <typename Point, typename Accept>
void find_nearest(const KdTree<Point>& tree, const Vec3& p, std::size_t k, float max_distance, Accept&& accept,
                  std::vector<Neighbour>& neighbours) {
    NearestBuffer buffer(k, max_distance, neighbours);
    if (k > 0)
        tree.traverse(
            p, [&] { return buffer.bound(); },
            [&](std::uint32_t index, float distance2) {
                if (distance2 <= buffer.bound() && accept(tree[index], distance2)) buffer.offer(distance2, index);
            });
    buffer.finish();
}

/// The nearest of these points; empty if there is none.
template <typename Point, typename Accept>
std::optional<Neighbour> find_nearest(const KdTree<Point>& tree, const Vec3& p, float max_distance, Accept&& accept) {
    std::optional<Neighbour> nearest;
    float bound = max_distance * max_distance;
    tree.traverse(
        p, [&] { return bound; },
        [&](std::uint32_t index, float distance2) {
            const Neighbour candidate{distance2, index};
            if (distance2 > bound || (nearest && !(candidate < *nearest)) || !accept(tree[index], distance2)) return;
            nearest = candidate;
            bound = distance2;
        });
    return nearest;
}

}  // namespace gib
