#pragma once
// The irradiance cache: irradiance is computed at few points of diffuse surfaces and interpolated between them.
//
// A record of distance R_i (the harmonic mean of the distances that it sees, limited) serves a point p with the
// normal n if p does not lie behind the record and
//   e_i = |p - p_i| / R_i + sqrt(1 - n . n_i) < a.
// The error e_i bounds the relative difference of irradiance between p and the record (split-sphere model of Ward,
// Rubinstein and Clear 1988, "A Ray Tracing Solution for Diffuse Interreflection", section 3). The irradiance at p is
// the mean of the first-order extrapolations of all records that serve p (Ward and Heckbert 1992). Their weights are
// 1 / e_i - 1 / a, which falls to 0 where a record's reach ends, so that no edge is seen there.
//
// R_i is limited, in this order:
//  - by the record's own gradient, so that E does not change by more than itself over R_i: |E| / |translation|;
//  - by its spacing: a R_i lies between the least and the greatest spacing. Where the least spacing exceeds what the
//    record asks for, its translation gradient is lowered by the same factor;
//  - by its neighbours: R_i <= R_j + |p_i - p_j| for records that serve each other's points, in both directions. A
//    record whose rays missed a small object near by is thus not trusted where other records have seen the object.
//    Source: Krivanek et al. 2006, "Making Radiance and Irradiance Caching Practical: Adaptive Caching and Neighbor
//    Clamping", section 4.
//
// Records lie in an octree. Each is stored in all nodes of about its size that its reach touches, so a look-up visits
// only the nodes on the way down to its own point.

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

    /// Adds a record and limits its distance and those of its neighbours. A record whose distance is 0, without a
    /// least spacing, serves no point but its own and is not kept. Throws InputError if memory does not suffice.
    void insert(IrradianceRecord record, const RecordSpacing& spacing);

    /// Irradiance [W/m^2] interpolated from the records that serve the point; empty if none does. `slack` multiplies
    /// a: with more than 1, more records are averaged than were required when the cache was filled.
    std::optional<Color> interpolate(const Vec3& p, const Vec3& n, float slack = 1.f) const;
    /// Whether any record serves the point.
    bool covers(const Vec3& p, const Vec3& n) const;
    /// Whether some record also serves, with `slack` as for interpolate(), every point of its own plane within `around`
    /// [scene units] of p.
    bool covers_around(const Vec3& p, const Vec3& n, float around, float slack) const;

    std::size_t size() const { return records_.size(); }
    const std::vector<IrradianceRecord>& records() const { return records_; }
    /// Memory that the cache takes [bytes].
    std::size_t memory() const;
    /// The largest value of `slack`, with which passes use records that were made with a.
    static constexpr float most_slack = 1.4f;

private:
    struct Node {
        std::uint32_t first_child = 0;  ///< index of the first of eight children; 0: none
        std::vector<std::uint32_t> records;
    };
    struct Cube {
        Vec3 lower;
        float size;

        Cube child(int i) const;
        bool touches(const Vec3& p, float radius) const;
    };

    /// Calls visit(record number) for the records of all nodes around p until visit returns false.
    template <typename Visit>
    void for_each_near(const Vec3& p, Visit&& visit) const;
    /// Calls visit(record number) for the records of all nodes that the ball touches, for some records
    /// more than once.
    template <typename Visit>
    void for_each_within(const Vec3& p, float radius, std::uint32_t node, const Cube& cube, Visit& visit) const;
    /// e_i; infinite where the point lies behind the record, and where it is so far away that e_i is not below a.
    static float error_at(const IrradianceRecord& record, const Vec3& p, const Vec3& n, float a);
    /// Neighbour clamping (Krivanek et al. 2006, section 4); `least` is the least distance R of the new record.
    void limit_by_neighbours(IrradianceRecord& record, float least);
    void place(std::uint32_t record, float reach, std::uint32_t node, const Cube& cube);
    std::uint32_t children_of(std::uint32_t node);

    Cube root_;
    float accuracy_;
    std::vector<Node> nodes_;
    std::vector<IrradianceRecord> records_;
};

}  // namespace gib
