#pragma once
// The irradiance cache: irradiance is computed at few points of diffuse surfaces and interpolated between them.
//
// A record of distance R_i (the harmonic mean of the distances that it sees, limited) serves a point p with the normal
// n if
//   e_i = |p - p_i| / R_i + sqrt(1 - n . n_i) < a,
// which bounds how much irradiance can differ there (the split sphere of Ward, Rubinstein and Clear 1988, "A Ray
// Tracing Solution for Diffuse Interreflection", section 3), and p does not lie behind it. Irradiance is the mean of
// what all of them say to first order (Ward and Heckbert 1992), weighted by 1 / e_i - 1 / a, which falls to 0 where a
// record ends, so that no edge is seen there.
//
// R_i is limited, in this order:
//  - by the record's own gradient, so that E does not change by more than itself over R_i: |E| / |translation|;
//  - by its spacing: a R_i lies between the least and the greatest one. Where the least one is more than what the
//  record asks for,
//    its translation gradient is lowered by the same factor;
//  - by its neighbours, R_i <= R_j + |p_i - p_j| for records that serve each other's place, in both directions, so that
//  none that missed
//    a small thing near by is trusted where others have seen it. Source: Krivanek et al. 2006, "Making Radiance and
//    Irradiance Caching Practical: Adaptive Caching and Neighbor Clamping", section 4.
//
// Records lie in an octree, each in all nodes of about its size that it reaches into, so that a look-up walks down one
// way.

#include "methods/parts/gathering/irradiance_record.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace gib {

/// How far apart records lie [scene units].
struct RecordSpacing {
    float least, greatest;
};

class IrradianceCache {
public:
    /// For records within the bounds. `accuracy` is a: the smaller, the more records.
    IrradianceCache(const Bounds& bounds, float accuracy);

    /// Adds a record; limits its distance, and that of its neighbours. One that serves no other place than its own, as
    /// its distance is 0 and there is no least spacing, is not kept. Throws InputError where memory does not suffice.
    void insert(IrradianceRecord record, const RecordSpacing& spacing);

    /// Irradiance [W/m^2] by the records that serve the point; empty: none does. `slack` multiplies the accuracy: with
    /// more than 1, more records are averaged than were needed when the cache was filled.
    std::optional<Color> interpolate(const Vec3& p, const Vec3& n, float slack = 1.f) const;
    /// Whether any record serves the point.
    bool covers(const Vec3& p, const Vec3& n) const;
    /// The record nearest to p within `radius` on the side of n; null: none. For showing them.
    const IrradianceRecord* nearest(const Vec3& p, const Vec3& n, float radius) const;

    std::size_t size() const { return records_.size(); }
    const std::vector<IrradianceRecord>& records() const { return records_; }
    /// What the cache keeps [bytes].
    std::size_t memory() const;
    /// The most that `slack` may be.
    static constexpr float most_slack = 2.f;

private:
    struct Node {
        std::uint32_t first_child = 0;  ///< of eight; 0: none
        std::vector<std::uint32_t> records;
    };
    struct Cube {
        Vec3 lower;
        float size;

        Cube child(int i) const;
        bool touches(const Vec3& p, float radius) const;
    };

    /// Calls visit(record number) for the records of all nodes around p, until it returns false.
    template <typename Visit>
    void for_each_near(const Vec3& p, Visit&& visit) const;
    /// Calls visit(record number) for the records of all nodes that the ball touches; for some of them more than once.
    template <typename Visit>
    void for_each_within(const Vec3& p, float radius, std::uint32_t node, const Cube& cube, Visit& visit) const;
    /// e_i; infinite where the point lies behind the record.
    float error_at(const IrradianceRecord& record, const Vec3& p, const Vec3& n) const;
    void limit_by_neighbours(IrradianceRecord& record, float least);
    void place(std::uint32_t record, float reach, std::uint32_t node, const Cube& cube);
    std::uint32_t children_of(std::uint32_t node);

    Cube root_;
    float accuracy_;
    std::vector<Node> nodes_;
    std::vector<IrradianceRecord> records_;
};

}  // namespace gib
