#pragma once
// The k nearest of the candidates that a search comes across.

#include "methods/parts/photons/selection.h"

#include <bit>
#include <compare>
#include <cstdint>
#include <vector>

namespace gib {

struct Neighbour {
    float distance2;
    std::uint32_t photon;  ///< index in the photon map
    friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
};

/// Keeps the k nearest of the candidates offered to it: a buffer of k and some more, cut back to k whenever it is full,
/// so that an offer costs constant time on average where a heap's costs log k.
class NearestBuffer {
public:
    NearestBuffer(std::size_t k, float max_distance, std::vector<Neighbour>& storage)
        : k_(k), capacity_(k + k / 2 + 16), bound_(max_distance * max_distance), storage_(storage) {
        if (storage_.size() < capacity_) storage_.resize(capacity_);
        begin_ = storage_.data();
    }
    /// Squared distance beyond which nothing is wanted any more.
    float bound() const { return bound_; }
    void offer(float distance2, std::uint32_t photon) {
        begin_[size_++] = {distance2, photon};
        if (size_ == capacity_) shrink();
    }
    /// Leaves at most k in the storage, the farthest last if there are k.
    void finish() {
        if (k_ > 0 && size_ >= k_) shrink();
        storage_.resize(size_);
    }

private:
    void shrink() {
        Neighbour* const kth = begin_ + (k_ - 1);
        // Distances are positive, so that their bits have their order.
        select_kth(begin_, kth, begin_ + size_, [](const Neighbour& n) {
            return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(n.distance2)) << 32 | n.photon;
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
