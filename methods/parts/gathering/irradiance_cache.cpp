#include "methods/parts/gathering/irradiance_cache.h"

#include "common/core/memory_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// A point behind a record does not see what the record sees. Rounding and curved surfaces are allowed for by this
/// share of R.
constexpr float behind_tolerance = 0.01f;
/// A record is stored in cubes of at most this size, in units of its reach. Smaller cubes hold fewer records that do not
/// serve a point in them, and a record lies in more cubes.
constexpr float size_by_reach = 1.f;
/// Largest depth of the octree; deeper nodes would not hold fewer records.
constexpr int deepest = 24;

/// |E| / |translation|, the distance [scene units] over which E changes by as much as itself. The mean of the
/// channels is taken, because noise would decide in a channel with little light.
float distance_by_gradient(const IrradianceRecord& record) {
    const auto& [red, green, blue] = record.translation;
    const float slope = (red + green + blue).stableNorm();  // the square may exceed the range of float
    return slope > 0.f ? record.irradiance.sum() / slope : infinity;
}

}  // namespace

IrradianceCache::IrradianceCache(const Bounds& bounds, float accuracy) : accuracy_(accuracy), nodes_(1) {
    const float size = std::max((bounds.upper - bounds.lower).maxCoeff(), std::numeric_limits<float>::min());
    root_ = {bounds.lower - Vec3::Constant(0.01f * size), 1.02f * size};
}

IrradianceCache::Cube IrradianceCache::Cube::child(int i) const {
    const Vec3 upper(static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1), static_cast<float>(i >> 2));
    return {lower + 0.5f * size * upper, 0.5f * size};
}

bool IrradianceCache::Cube::touches(const Vec3& p, float radius) const {
    const Vec3 outside = (lower - p).cwiseMax(p - lower - Vec3::Constant(size)).cwiseMax(0.f);
    return outside.squaredNorm() <= radius * radius;
}

template <typename Visit>
void IrradianceCache::for_each_near(const Vec3& p, Visit&& visit) const {
    // Three numbers instead of a Cube: a vector that is written in parts and read as a whole stalls the processor.
    float x = root_.lower.x(), y = root_.lower.y(), z = root_.lower.z(), half = 0.5f * root_.size;
    const auto descend = [&half](float& lower, float position) {
        const bool upper = position >= lower + half;
        lower = upper ? lower + half : lower;
        return static_cast<std::uint32_t>(upper);
    };
    for (std::uint32_t at = 0;; half *= 0.5f) {
        for (const std::uint32_t record : nodes_[at].records)
            if (!visit(record)) return;
        if (nodes_[at].first_child == 0) return;
        at = nodes_[at].first_child + (descend(x, p.x()) | descend(y, p.y()) << 1 | descend(z, p.z()) << 2);
    }
}

template <typename Visit>
void IrradianceCache::for_each_within(const Vec3& p, float radius, std::uint32_t node, const Cube& cube,
                                      Visit& visit) const {
    if (!cube.touches(p, radius)) return;
    for (const std::uint32_t record : nodes_[node].records)
        visit(record);
    if (nodes_[node].first_child == 0) return;
    for (int child = 0; child < 8; ++child)
        for_each_within(p, radius, nodes_[node].first_child + static_cast<std::uint32_t>(child), cube.child(child),
                        visit);
}

float IrradianceCache::error_at(const IrradianceRecord& record, const Vec3& p, const Vec3& n, float a) {
    const Vec3 d = p - record.p;
    const float d2 = d.squaredNorm();
    if (d2 > sqr(a * record.distance)) return infinity;
    const float cosine = n.dot(record.n);
    if (cosine <= 0.f || d.dot(n + record.n) < -2.f * behind_tolerance * record.distance) return infinity;
    return std::sqrt(d2) / record.distance + safe_sqrt(1.f - cosine);
}

std::optional<Color> IrradianceCache::interpolate(const Vec3& p, const Vec3& n, float slack) const {
    const float a = slack * accuracy_;
    Colord sum = Colord::Zero();
    double weights = 0;
    for_each_near(p, [&](std::uint32_t i) {
        const IrradianceRecord& record = records_[i];
        const float error = error_at(record, p, n, a);
        if (error < a) {
            // At the record's own point e_i is 0; a large weight makes the other records irrelevant.
            const float weight = 1.f / std::max(error, 1e-6f * a) - 1.f / a;
            sum += double{weight} * record.at(p, n).cast<double>();
            weights += double{weight};
        }
        return true;
    });
    if (!(weights > 0)) return std::nullopt;
    // Only the mean is kept from being negative: to cut off each record's value at 0 would make the mean too large.
    return Color((sum / weights).max(0.0).cast<float>());
}

bool IrradianceCache::covers(const Vec3& p, const Vec3& n) const {
    bool covered = false;
    for_each_near(p, [&](std::uint32_t i) {
        covered = error_at(records_[i], p, n, accuracy_) < accuracy_;
        return !covered;
    });
    return covered;
}

bool IrradianceCache::covers_around(const Vec3& p, const Vec3& n, float around, float slack) const {
    const float a = slack * accuracy_;
    bool covered = false;
    for_each_near(p, [&](std::uint32_t i) {
        covered = error_at(records_[i], p, n, a) + around / records_[i].distance < a;
        return !covered;
    });
    return covered;
}

void IrradianceCache::insert(IrradianceRecord record, const RecordSpacing& spacing) {
    record.distance = std::min(record.distance, distance_by_gradient(record));
    record.distance = std::min(record.distance, spacing.greatest / accuracy_);
    const float least = spacing.least / accuracy_;
    if (record.distance < least) {
        const float factor = record.distance / least;
        for (Vec3& slope : record.translation)
            slope *= factor;
        record.distance = least;
    }
    limit_by_neighbours(record, least);
    if (!(record.distance > 0.f)) return;
    // The vector of records is about to double its capacity, and the octree grows with the records.
    if (records_.size() == records_.capacity())
        require_memory(2.0 * static_cast<double>(memory()),
                       fmt::format("an irradiance cache of more than {} records", size()));
    records_.push_back(record);
    place(static_cast<std::uint32_t>(records_.size() - 1), most_slack * accuracy_ * record.distance, 0, root_);
}

void IrradianceCache::limit_by_neighbours(IrradianceRecord& record, float least) {
    const auto limit = [&](std::uint32_t i) {
        IrradianceRecord& other = records_[i];
        const float apart = (other.p - record.p).norm();
        if (!(other.n.dot(record.n) > 0.f && apart < accuracy_ * std::max(record.distance, other.distance))) return;
        record.distance = std::max(std::min(record.distance, other.distance + apart), least);
        // The other record's least spacing may be smaller than `least`, so the minimum keeps its distance
        // from being raised.
        other.distance = std::min(other.distance, std::max(record.distance + apart, least));
    };
    for_each_within(record.p, accuracy_ * record.distance, 0, root_, limit);
}

std::uint32_t IrradianceCache::children_of(std::uint32_t node) {
    if (nodes_[node].first_child == 0) {
        nodes_[node].first_child = static_cast<std::uint32_t>(nodes_.size());
        nodes_.resize(nodes_.size() + 8);
    }
    return nodes_[node].first_child;
}

void IrradianceCache::place(std::uint32_t record, float reach, std::uint32_t node, const Cube& cube) {
    const float smallest = std::ldexp(root_.size, -deepest);
    if (cube.size <= size_by_reach * reach || cube.size <= smallest) {
        nodes_[node].records.push_back(record);
        return;
    }
    const std::uint32_t children = children_of(node);
    for (int child = 0; child < 8; ++child)
        if (cube.child(child).touches(records_[record].p, reach))
            place(record, reach, children + static_cast<std::uint32_t>(child), cube.child(child));
}

std::size_t IrradianceCache::memory() const {
    std::size_t bytes = records_.capacity() * sizeof(IrradianceRecord) + nodes_.capacity() * sizeof(Node);
    for (const Node& node : nodes_)
        bytes += node.records.capacity() * sizeof(std::uint32_t);
    return bytes;
}

}  // namespace gib
