#include "methods/parts/photons/photon_map.h"

#include "common/core/error.h"
#include "common/core/parallel.h"

#include <algorithm>
#include <limits>
#include <string>

namespace gib {

namespace {

/// Subtrees of at most this number of leaves are built by one task.
constexpr std::uint32_t parallel_leaves = 2048;
constexpr std::size_t leaves_per_block = 4096;

/// A photon's position and number. During the build it occupies the memory of the photon's payload.
struct Record {
    std::array<float, 3> p;
    std::uint32_t photon;
};

/// A key with the order of (x, photon). -0 counts as less than 0; either side is right for a
/// photon on the split plane.
std::uint64_t sort_key(float x, std::uint32_t photon) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t ordered =
        bits ^ (static_cast<std::uint32_t>(static_cast<std::int32_t>(bits) >> 31) | 0x80000000u);
    return static_cast<std::uint64_t>(ordered) << 32 | photon;
}

using Float4 = float __attribute__((vector_size(16)));

/// The axis along which the records extend farthest.
int longest_axis(const PhotonPayload* begin, const PhotonPayload* end) {
    // The vectors have four lanes; the fourth holds the photons' numbers and is ignored.
    Float4 lower = {infinity, infinity, infinity, infinity}, upper = -lower;
    for (const PhotonPayload* i = begin; i != end; ++i) {
        const auto v = std::bit_cast<Float4>(*i);
        lower = v < lower ? v : lower;
        upper = v > upper ? v : upper;
    }
    const Float4 extent = upper - lower;
    const int xy = extent[0] >= extent[1] ? 0 : 1;
    return extent[xy] >= extent[2] ? xy : 2;
}

}  // namespace

PhotonMap::PhotonMap(std::vector<Photon> photons, double unit) : unit_(unit) {
    if (photons.empty()) return;
    if (photons.size() > std::numeric_limits<std::uint32_t>::max())
        throw InputError("a photon map holds 4294967295 photons at most, not " + std::to_string(photons.size()));
    const std::size_t leaves = (photons.size() + leaf_size - 1) / leaf_size;
    payloads_.resize(photons.size());
    parallel_blocks(photons.size(), leaves_per_block * leaf_size, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& p = photons[i].p;
            payloads_[i] = std::bit_cast<PhotonPayload>(Record{{p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(i)});
        }
    });
    nodes_.resize(leaves - 1);
    build({0, 0, static_cast<std::uint32_t>(leaves)});
    positions_.resize(leaves);
    store_leaves(photons);
}

/// Balances the kd-tree (Jensen 2001, section 6.3): splits at the median of the longest axis of the photons' box,
/// rounded to a whole number of leaves.
void PhotonMap::build(const Subtree& tree) {
    if (tree.leaves == 1) return;
    const std::size_t begin = std::size_t{tree.first} * leaf_size;
    const std::size_t end = std::min(begin + std::size_t{tree.leaves} * leaf_size, payloads_.size());
    const std::size_t middle = begin + std::size_t{tree.leaves / 2} * leaf_size;
    const int axis = longest_axis(payloads_.data() + begin, payloads_.data() + end);
    const float split = axis == 0   ? split_at_median<0>(begin, middle, end)
                        : axis == 1 ? split_at_median<1>(begin, middle, end)
                                    : split_at_median<2>(begin, middle, end);
    nodes_[tree.node] = {split, static_cast<std::uint32_t>(axis)};

    const auto left = [&] { build(tree.child(true)); };
    const auto right = [&] { build(tree.child(false)); };
    if (tree.leaves > parallel_leaves) {
        parallel_pair(left, right);
    } else {
        left();
        right();
    }
}

/// Moves the records below the median before `middle` and the others behind it, and returns the median. Among equal
/// coordinates the photon of lower number counts as smaller.
template <int axis>
float PhotonMap::split_at_median(std::size_t begin, std::size_t middle, std::size_t end) {
    PhotonPayload* const records = payloads_.data();
    const auto coordinate = [](const PhotonPayload& r) { return std::bit_cast<Record>(r).p[axis]; };
    select_kth(records + begin, records + middle, records + end,
               [&](const PhotonPayload& r) { return sort_key(coordinate(r), std::bit_cast<Record>(r).photon); });
    return coordinate(records[middle]);
}

/// Fills the leaves: writes the positions and replaces the records by the payloads.
void PhotonMap::store_leaves(const std::vector<Photon>& photons) {
    parallel_blocks(positions_.size(), leaves_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
            PositionBlock& block = positions_[leaf];
            block.x.fill(std::numeric_limits<float>::quiet_NaN());
            const std::size_t first = leaf * leaf_size;
            for (std::size_t lane = 0; lane < leaf_size && first + lane < payloads_.size(); ++lane) {
                const auto record = std::bit_cast<Record>(payloads_[first + lane]);
                block.x[lane] = record.p[0];
                block.y[lane] = record.p[1];
                block.z[lane] = record.p[2];
                payloads_[first + lane] = photons[record.photon];
            }
        }
    });
}

}  // namespace gib
