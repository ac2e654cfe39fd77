#pragma once
// Photons in a balanced kd-tree, and the search for the nearest of them.

#include "methods/photon.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gib {

class PhotonMap {
public:
    PhotonMap() = default;
    /// Builds the tree in parallel; the same photons in the same order give the same tree for any number of threads.
    explicit PhotonMap(std::vector<Photon> photons);

    std::size_t size() const { return photons_.size(); }
    const Photon& operator[](std::size_t i) const { return photons_[i]; }

    struct Neighbour {
        float distance2;
        std::uint32_t photon;  ///< index for operator[]
        friend auto operator<=>(const Neighbour&, const Neighbour&) = default;
    };

    /// The k nearest photons to p within `max_distance` for which accept(photon, distance2) holds: fewer than k if
    /// there are no more. In no particular order except that, if there are k, the LAST one is the farthest. Of photons
    /// at the same distance the one with the lower index counts as nearer. `found` is cleared first and keeps its
    /// memory.
    template <typename Accept>
    void nearest(const Vec3& p, std::size_t k, float max_distance, Accept&& accept,
                 std::vector<Neighbour>& found) const;

private:
    static constexpr std::uint32_t leaf_size = 8;
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
    struct Record;  // a photon's position and number during the build

    void build(std::vector<Record>& records, const Subtree& tree);

    std::vector<Photon> photons_;  ///< leaf after leaf
    std::vector<Node> nodes_;
};

/// Keeps the k nearest of the candidates offered to it: a buffer of 2 k, cut back to k whenever it is full, so that an
/// offer costs constant time on average where a heap's costs log k.
class NearestBuffer {
public:
    NearestBuffer(std::size_t k, float max_distance, std::vector<PhotonMap::Neighbour>& storage)
        : k_(k), bound_(max_distance * max_distance), storage_(storage) {
        storage_.clear();
    }
    /// Squared distance beyond which nothing is wanted any more.
    float bound() const { return bound_; }
    void offer(float distance2, std::uint32_t photon) {
        storage_.push_back({distance2, photon});
        if (storage_.size() >= 2 * k_ + 16) shrink();
    }
    /// Leaves at most k, the farthest last.
    void finish() {
        if (storage_.size() >= k_) shrink();
    }

private:
    void shrink();

    std::size_t k_;
    float bound_;
    std::vector<PhotonMap::Neighbour>& storage_;
};

template <typename Accept>
void PhotonMap::nearest(const Vec3& p, std::size_t k, float max_distance, Accept&& accept,
                        std::vector<Neighbour>& found) const {
    NearestBuffer buffer(k, max_distance, found);
    struct Pending {
        Subtree tree;
        std::array<float, 3> offset;  ///< of the tree's cell from p, by axis
        float distance2;
    };
    // Each level of the tree leaves one subtree for later; 2^32 photons have 29 levels.
    std::array<Pending, 40> stack;
    std::size_t depth = 0;
    if (k == 0 || photons_.empty()) return;
    const auto leaves = static_cast<std::uint32_t>((photons_.size() + leaf_size - 1) / leaf_size);
    stack[depth++] = {{0, 0, leaves}, {0.f, 0.f, 0.f}, 0.f};
    while (depth > 0) {
        Pending at = stack[--depth];
        if (at.distance2 > buffer.bound()) continue;
        while (at.tree.leaves > 1) {
            const Node& node = nodes_[at.tree.node];
            const float to_plane = p[static_cast<Eigen::Index>(node.axis)] - node.split;
            const bool left = to_plane <= 0.f;
            Pending far = at;
            far.tree = at.tree.child(!left);
            at.tree = at.tree.child(left);
            const float old = far.offset[node.axis];
            far.distance2 += to_plane * to_plane - old * old;
            far.offset[node.axis] = to_plane;
            if (far.distance2 <= buffer.bound()) stack[depth++] = far;
        }
        const std::uint32_t begin = at.tree.first * leaf_size;
        const auto end = std::min(begin + leaf_size, static_cast<std::uint32_t>(photons_.size()));
        for (std::uint32_t i = begin; i < end; ++i) {
            const float d2 = (photons_[i].p - p).squaredNorm();
            if (d2 <= buffer.bound() && accept(photons_[i], d2)) buffer.offer(d2, i);
        }
    }
    buffer.finish();
}

}  // namespace gib
