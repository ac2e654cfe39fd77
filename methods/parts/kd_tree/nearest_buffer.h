#pragma once
// A buffer that keeps the k nearest of the candidates that a search finds.

#include "methods/parts/kd_tree/selection.h"

#include <bit>
#include <compare>
#include <cstdint>
#include <vector>

namespace gib {

/// A point found by a search, with its squared distance [scene units^2].
struct Neighbour {
    float distance2;
    std::uint32_t index;  ///< in the tree

    Neighbour() {}  // leaves the members as they are, so that to enlarge a buffer costs nothing
    Neighbour(float squared, std::uint32_t of) : distance2(squared), index(of) {}
    friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
};

/// Keeps the k nearest of the candidates offered to it. The buffer has room for more than k and is cut back to the k
/// nearest whenever it is full, so an offer takes constant time on average, where a heap takes time log k.
class NearestBuffer {
public:
    NearestBuffer(std::size_t k, float max_distance, std::vector<Neighbour>& storage)
        : k_(k), capacity_(k + k / 2 + 16), bound_(max_distance * max_distance), storage_(storage) {
        if (storage_.size() < capacity_) storage_.resize(capacity_);
        begin_ = storage_.data();
    }
    /// Squared distance beyond which no candidate is needed any more. It falls as the buffer is cut back.
    float bound() const { return bound_; }
    void offer(float distance2, std::uint32_t index) {
        begin_[size_++] = {distance2, index};
        if (size_ == capacity_) shrink();
    }
    /// Leaves the nearest candidates in the storage, at most k. If there are k, the last one is the farthest.
    void finish() {
        if (k_ > 0 && size_ >= k_) shrink();
        storage_.resize(size_);
    }

private:
    void shrink() {
        Neighbour* const kth = begin_ + (k_ - 1);
        // Positive floats have the order of their bits; ties in distance are broken by the index.
        select_kth(begin_, kth, begin_ + size_, [](const Neighbour& n) {
            return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(n.distance2)) << 32 | n.index;
        });
        size_ = k_;
        bound_ = kth->distance2;
    }

    std::size_t k_, capacity_, size_ = 0;
    float bound_;
    Neighbour* begin_;
    std::vector<Neighbour>& storage_;
};

}  // namespace gib
