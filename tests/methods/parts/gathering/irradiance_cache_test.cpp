// The irradiance cache: interpolation, the reach of records and how neighbours limit it.
#include "methods/parts/gathering/irradiance_cache.h"

#include "common/sampling/sampler.h"

#include <gtest/gtest.h>

namespace gib::irradiance_cache_test {
namespace {

constexpr RecordSpacing any_spacing = {0.f, 1e6f};

Bounds unit_box() {
    Bounds bounds;
    bounds.lower = Vec3::Zero();
    bounds.upper = Vec3::Ones();
    return bounds;
}

/// E = (3 + 2 x - y, 1, 2) is linear, so one record gives it exactly everywhere.
IrradianceRecord linear_record(const Vec3& p, float distance) {
    IrradianceRecord record;
    record.p = p;
    record.n = Vec3(0, 0, 1);
    record.irradiance = Color(3 + 2 * p.x() - p.y(), 1, 2);
    record.rotation.fill(Vec3::Zero());
    record.translation = {Vec3(2, -1, 0), Vec3::Zero(), Vec3::Zero()};
    record.distance = distance;
    return record;
}

Vec3 point_of(std::uint64_t i) {
    const Sampler u(PointSet::independent, 11, i, 0);
    return {u.get_1d(0), u.get_1d(1), 0.5f};
}

TEST(IrradianceCache, InterpolatesALinearFieldExactly) {
    IrradianceCache cache(unit_box(), 0.3f);
    for (std::uint64_t i = 0; i < 200; ++i)
        cache.insert(linear_record(point_of(i), 0.5f), any_spacing);
    int served = 0;
    for (std::uint64_t i = 1000; i < 1500; ++i) {
        const Vec3 p = point_of(i);
        const auto E = cache.interpolate(p, Vec3(0, 0, 1));
        if (!E) continue;
        ++served;
        EXPECT_NEAR((*E)[0], 3 + 2 * p.x() - p.y(), 1e-5);
        EXPECT_NEAR((*E)[1], 1, 1e-5);
    }
    EXPECT_EQ(served, 500);
}

// The record serves points of its plane whose distance from it is below 1.4 * 0.25 * 0.4 = 0.14.
TEST(IrradianceCache, ServesWhatLiesAroundAPointIfOneRecordReachesBeyondIt) {
    IrradianceCache cache(unit_box(), 0.25f);
    const Vec3 n(0, 0, 1), p(0.5f, 0.5f, 0.5f);
    cache.insert(linear_record(p, 0.4f), any_spacing);
    const Vec3 beside = p + Vec3(0.09f, 0, 0);
    EXPECT_TRUE(cache.covers(beside, n));
    EXPECT_TRUE(cache.covers_around(beside, n, 0.049f, 1.4f));
    EXPECT_FALSE(cache.covers_around(beside, n, 0.051f, 1.4f));
    EXPECT_FALSE(cache.covers_around(beside, n, 0.049f, 1.f));
    EXPECT_FALSE(cache.covers_around(beside, -n, 0.f, 1.4f));
}

// The octree serves a place exactly if a search through all records finds one whose error is below the accuracy.
TEST(IrradianceCache, ServesWhereARecordsErrorIsSmallAndNowhereElse) {
    constexpr float accuracy = 0.2f;
    IrradianceCache cache(unit_box(), accuracy);
    std::vector<IrradianceRecord> records;
    const auto error = [](const IrradianceRecord& r, const Vec3& p, const Vec3& n) {
        if ((p - r.p).dot(n + r.n) < -0.02f * r.distance) return infinity;  // p is behind the record
        return (p - r.p).norm() / r.distance + std::sqrt(std::max(0.f, 1 - n.dot(r.n)));
    };
    // The records are far apart, so that none is limited by its neighbours.
    for (std::uint64_t i = 0; records.size() < 12; ++i) {
        auto record = linear_record(point_of(i), 0.1f + 0.4f * Sampler(PointSet::independent, 12, i, 0).get_1d(0));
        record.translation.fill(Vec3::Zero());
        const bool near = std::any_of(records.begin(), records.end(), [&](const auto& r) {
            return (r.p - record.p).norm() < accuracy * std::max(r.distance, record.distance);
        });
        if (near) continue;
        records.push_back(record);
        cache.insert(record, any_spacing);
    }
    int inside = 0, outside = 0;
    for (std::uint64_t i = 5000; i < 9000; ++i) {
        const Vec3 p = point_of(i);
        for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0, 0.1f, 1).normalized().eval(), Vec3(1, 0, 0)}) {
            for (const float slack : {1.f, IrradianceCache::most_slack}) {
                const bool served = std::any_of(records.begin(), records.end(),
                                                [&](const auto& r) { return error(r, p, n) < slack * accuracy; });
                EXPECT_EQ(cache.interpolate(p, n, slack).has_value(), served);
                ++(served ? inside : outside);
            }
        }
    }
    EXPECT_GT(inside, 1000);
    EXPECT_GT(outside, 1000);
}

// The weight of a record is 0 at the end of its reach, so the interpolated irradiance has no step there.
TEST(IrradianceCache, HasNoStepWhereARecordEnds) {
    IrradianceCache cache(unit_box(), 0.2f);
    auto left = linear_record(Vec3(0.3f, 0.5f, 0.5f), 1.f), right = linear_record(Vec3(0.49f, 0.5f, 0.5f), 1.f);
    left.translation.fill(Vec3::Zero());
    right.translation.fill(Vec3::Zero());
    right.irradiance = Color(9, 1, 2);
    cache.insert(left, any_spacing);
    cache.insert(right, any_spacing);
    float previous = (*cache.interpolate(Vec3(0.25f, 0.5f, 0.5f), Vec3(0, 0, 1)))[0];
    for (float x = 0.2501f; x < 0.55f; x += 0.0001f) {
        const float E = (*cache.interpolate(Vec3(x, 0.5f, 0.5f), Vec3(0, 0, 1)))[0];
        EXPECT_LT(std::abs(E - previous), 0.02f) << x;
        previous = E;
    }
}

TEST(IrradianceCache, ServesNothingBehindARecord) {
    IrradianceCache cache(unit_box(), 0.3f);
    cache.insert(linear_record(Vec3(0.5f, 0.5f, 0.5f), 1.f), any_spacing);
    EXPECT_TRUE(cache.covers(Vec3(0.6f, 0.5f, 0.5f), Vec3(0, 0, 1)));
    EXPECT_FALSE(cache.covers(Vec3(0.6f, 0.5f, 0.45f), Vec3(0, 0, 1)));
    EXPECT_FALSE(cache.covers(Vec3(0.5f, 0.5f, 0.5f), Vec3(0, 0, -1)));
}

TEST(IrradianceCache, RecordsAreLimitedByTheirSpacingAndTheirGradient) {
    IrradianceCache cache(unit_box(), 0.1f);
    auto wide = linear_record(Vec3(0.2f, 0.5f, 0.5f), 100.f);
    wide.translation.fill(Vec3::Zero());
    cache.insert(wide, {0.01f, 0.05f});
    EXPECT_TRUE(cache.covers(Vec3(0.2f, 0.549f, 0.5f), Vec3(0, 0, 1)));
    EXPECT_FALSE(cache.covers(Vec3(0.2f, 0.551f, 0.5f), Vec3(0, 0, 1)));
    auto narrow = wide;
    narrow.p.x() = 0.4f;
    narrow.distance = 1e-3f;
    cache.insert(narrow, {0.01f, 0.05f});
    EXPECT_TRUE(cache.covers(Vec3(0.4f, 0.5099f, 0.5f), Vec3(0, 0, 1)));
    EXPECT_FALSE(cache.covers(Vec3(0.4f, 0.5101f, 0.5f), Vec3(0, 0, 1)));
    auto steep = wide;  // over 0.2, E changes by 6, which is its own sum 3 + 1 + 2
    steep.p.x() = 0.7f;
    steep.irradiance = Color(3, 1, 2);
    steep.translation[0] = Vec3(30, 0, 0);
    cache.insert(steep, {0.f, 10.f});
    EXPECT_TRUE(cache.covers(Vec3(0.7f, 0.5199f, 0.5f), Vec3(0, 0, 1)));
    EXPECT_FALSE(cache.covers(Vec3(0.7f, 0.5201f, 0.5f), Vec3(0, 0, 1)));
}

// A record with a surface nearby limits the reach of the records around it, whether they come before or after it.
TEST(IrradianceCache, NeighboursLimitEachOther) {
    for (const bool near_first : {true, false}) {
        IrradianceCache cache(unit_box(), 0.5f);
        auto near = linear_record(Vec3(0.5f, 0.5f, 0.5f), 0.05f), far = linear_record(Vec3(0.6f, 0.5f, 0.5f), 1.f);
        near.translation.fill(Vec3::Zero());
        far.translation.fill(Vec3::Zero());
        // The far record covers the near one's place: its R falls from 1 to 0.05 + 0.1, its reach from 0.5 to 0.075.
        cache.insert(near_first ? near : far, any_spacing);
        cache.insert(near_first ? far : near, any_spacing);
        EXPECT_FALSE(cache.covers(Vec3(0.676f, 0.5f, 0.5f), Vec3(0, 0, 1))) << near_first;
        EXPECT_TRUE(cache.covers(Vec3(0.674f, 0.5f, 0.5f), Vec3(0, 0, 1))) << near_first;
    }
}

}  // namespace
}  // namespace gib::irradiance_cache_test
