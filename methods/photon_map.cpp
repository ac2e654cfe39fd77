#include "methods/photon_map.h"

#include "common/parallel.h"

#include <algorithm>

namespace gib {

namespace {
/// Smaller subtrees are built by one task.
constexpr std::uint32_t parallel_leaves = 2048;
}  // namespace

struct PhotonMap::Record {
    Vec3 p;
    std::uint32_t photon;
};

void NearestBuffer::shrink() {
    const auto kth = storage_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(storage_.begin(), kth, storage_.end());
    storage_.resize(k_);
    bound_ = storage_.back().distance2;
}

PhotonMap::PhotonMap(std::vector<Photon> photons) {
    if (photons.empty()) return;
    std::vector<Record> records(photons.size());
    for (std::uint32_t i = 0; i < records.size(); ++i)
        records[i] = {photons[i].p, i};
    const auto leaves = static_cast<std::uint32_t>((photons.size() + leaf_size - 1) / leaf_size);
    nodes_.resize(leaves - 1);
    build(records, {0, 0, leaves});
    photons_.resize(photons.size());
    for (std::size_t i = 0; i < records.size(); ++i)
        photons_[i] = photons[records[i].photon];
}

/// Splits at the median of the longest axis of the photons' box, at a whole number of leaves.
void PhotonMap::build(std::vector<Record>& records, const Subtree& tree) {
    if (tree.leaves == 1) return;
    const auto begin = records.begin() + static_cast<std::ptrdiff_t>(tree.first * leaf_size);
    const auto count = std::min<std::size_t>(std::size_t{tree.leaves} * leaf_size,
                                             records.size() - std::size_t{tree.first} * leaf_size);
    const auto end = begin + static_cast<std::ptrdiff_t>(count);
    Bounds bounds;
    for (auto it = begin; it != end; ++it)
        bounds.add(it->p);
    Eigen::Index axis = 0;
    (bounds.upper - bounds.lower).maxCoeff(&axis);

    const auto middle = begin + static_cast<std::ptrdiff_t>(tree.leaves / 2 * leaf_size);
    std::nth_element(begin, middle, end, [axis](const Record& a, const Record& b) {
        return a.p[axis] != b.p[axis] ? a.p[axis] < b.p[axis] : a.photon < b.photon;
    });
    nodes_[tree.node] = {middle->p[axis], static_cast<std::uint32_t>(axis)};

    const auto left = [&] { build(records, tree.child(true)); };
    const auto right = [&] { build(records, tree.child(false)); };
    if (tree.leaves > parallel_leaves) {
        parallel_pair(left, right);
    } else {
        left();
        right();
    }
}

}  // namespace gib
