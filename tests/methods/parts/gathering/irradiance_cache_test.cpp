// The irradiance cache: a record's irradiance and gradients against closed forms, interpolation, the reach of records and how
// neighbours limit it, and the grid of pixels that fills the cache.
#include "methods/parts/gathering/irradiance_cache.h"

#include "common/sampling/sampler.h"
#include "methods/parts/gathering/irradiance_record.h"
#include "methods/parts/gathering/refined_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace gib::test::irradiance_cache_test {
namespace {

/// The corners, in order as seen from the front, of a rectangle of even radiance 1.
using Rectangle = std::array<Vec3d, 4>;

/// Irradiance due to a polygon of radiance 1 that lies entirely above the horizon of n. Source:
/// Lambert 1760, as in Baum et al. 1989, "Improving Radiosity Solutions Through the Use of
/// Analytically Determined Form-Factors", equation 8.
double lambert(const Rectangle& corners, const Vec3d& p, const Vec3d& n) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = corners[i] - p, b = corners[(i + 1) % corners.size()] - p;
        const Vec3d normal = a.cross(b);
        sum += std::atan2(normal.norm(), a.dot(b)) * normal.normalized().dot(n);
    }
    return std::abs(sum) / 2;
}

std::optional<double> hit_distance(const Rectangle& corners, const Vec3d& p, const Vec3d& w) {
    const Vec3d a = corners[1] - corners[0], b = corners[3] - corners[0], n = a.cross(b);
    const double t = (corners[0] - p).dot(n) / w.dot(n);
    const Vec3d at = p + t * w - corners[0];
    const double u = at.dot(a) / a.squaredNorm(), v = at.dot(b) / b.squaredNorm();
    return t > 0 && u >= 0 && u <= 1 && v >= 0 && v <= 1 ? std::optional(t) : std::nullopt;
}

using Radiance = std::function<HemisphereSample(const Vec3d& p, const Vec3d& w)>;

IrradianceRecord record_of(const Radiance& seen, const Vec3& p, const Vec3& n, const HemisphereStrata& strata,
                           std::uint64_t seed) {
    const Frame frame(n);
    const Sampler sampler(PointSet::independent, seed, 0, 0);
    std::vector<HemisphereSample> samples;
    for (int i = 0; i < strata.count(); ++i) {
        const Vec3 w = frame.to_world(strata.direction_local(i, sampler.get_2d(static_cast<std::uint32_t>(i))));
        samples.push_back(seen(p.cast<double>(), w.cast<double>().normalized()));
    }
    return irradiance_record(p, frame, strata, samples);
}

const Rectangle lamp = {Vec3d(0.2, -0.3, 1), Vec3d(1.1, -0.3, 1.2), Vec3d(1.1, 0.7, 1.2), Vec3d(0.2, 0.7, 1)};

HemisphereSample bright_lamp(const Vec3d& p, const Vec3d& w) {
    const auto t = hit_distance(lamp, p, w);
    return t ? HemisphereSample{Color::Ones(), static_cast<float>(*t)} : HemisphereSample{Color::Zero(), infinity};
}

/// A dark rectangle before a bright wall far away. The moving edges belong to
/// the nearer surface, which is the dark one.
HemisphereSample dark_lamp(const Vec3d& p, const Vec3d& w) {
    const auto t = hit_distance(lamp, p, w);
    return t ? HemisphereSample{Color::Zero(), static_cast<float>(*t)} : HemisphereSample{Color::Ones(), 1e4f};
}

/// The derivatives of E(p, n) along the frame's axes s and t, and with respect to turns of the normal about them, by
/// central differences of the closed form.
struct Derivatives {
    Vec3d translation = Vec3d::Zero(), rotation = Vec3d::Zero();
};
Derivatives derivatives_at(const Vec3d& p, const Vec3d& n, const Frame& frame) {
    constexpr double h = 1e-4;
    Derivatives d;
    for (const Vec3& axis : {frame.s, frame.t}) {
        const Vec3d e = axis.cast<double>();
        d.translation += e * (lambert(lamp, p + h * e, n) - lambert(lamp, p - h * e, n)) / (2 * h);
        const auto turned = [&](double angle) { return (n + angle * e.cross(n)).normalized(); };
        d.rotation += e * (lambert(lamp, p, turned(h)) - lambert(lamp, p, turned(-h))) / (2 * h);
    }
    return d;
}

TEST(IrradianceRecord, OfEvenLightIsPiAndHasNoGradients) {
    const auto even = [](const Vec3d&, const Vec3d&) { return HemisphereSample{Color(1, 2, 3), 2.f}; };
    const auto record = record_of(even, Vec3(1, 2, 3), Vec3(1, 2, -2) / 3, HemisphereStrata::of(300), 1);
    for (Eigen::Index c = 0; c < 3; ++c) {
        EXPECT_NEAR(record.irradiance[c], pi * static_cast<float>(c + 1), 1e-5);
        EXPECT_LT(record.rotation[static_cast<std::size_t>(c)].norm(), 1e-5f);
        EXPECT_LT(record.translation[static_cast<std::size_t>(c)].norm(), 1e-5f);
    }
    EXPECT_NEAR(record.distance, 2, 1e-5);
}

// With 90,000 strata, both gradients are those of Lambert's formula within 2 %, in length and direction together, for
// a bright polygon in the dark and for a dark one before light. For the last normal, the lamp surrounds the pole and
// the motions of its edges nearly cancel. The bound is then 2 % of E over the lamp's distance, which is the size of
// the terms that cancel.
TEST(IrradianceRecord, GradientsAreThoseOfLambertsFormula) {
    const Vec3 p(0.1f, -0.2f, 0);
    for (const Vec3& n : {Vec3(0, 0, 1), Vec3(-0.28f, 0, 0.96f), Vec3(0, -0.6f, 0.8f), Vec3(0.48f, 0.36f, 0.8f)}) {
        const auto truth = derivatives_at(p.cast<double>(), n.cast<double>(), Frame(n));
        const double E = lambert(lamp, p.cast<double>(), n.cast<double>());
        const double scale = n.y() == 0.36f ? E / 1.3 : truth.translation.norm();
        for (const bool bright : {true, false}) {
            const auto record =
                record_of(bright ? Radiance(bright_lamp) : Radiance(dark_lamp), p, n, HemisphereStrata::of(90000), 7);
            const double sign = bright ? 1 : -1;
            EXPECT_NEAR(record.irradiance[0], bright ? E : std::numbers::pi - E, 0.001);
            EXPECT_LT((sign * record.translation[0].cast<double>() - truth.translation).norm(), 0.02 * scale)
                << n.transpose() << ' ' << bright;
            EXPECT_LT((sign * record.rotation[0].cast<double>() - truth.rotation).norm(), 0.02 * truth.rotation.norm())
                << n.transpose() << ' ' << bright;
        }
    }
}

// A record's irradiance at p' and n' is E there to first order: the error falls with the square of the step.
TEST(IrradianceRecord, ExtrapolatesToFirstOrder) {
    const Vec3 p(0.1f, -0.2f, 0), n(0, 0, 1);
    const auto record = record_of(bright_lamp, p, n, HemisphereStrata::of(90000), 3);
    const auto error = [&](float step) {
        const Vec3 q = p + step * Vec3(0.6f, 0.8f, 0), m = Vec3(0.6f * step, -0.8f * step, 1).normalized();
        const double E = lambert(lamp, q.cast<double>(), m.cast<double>());
        return std::abs(double{record.at(q, m)[0]} - E) / E;
    };
    const double without = std::abs(
        double{record.irradiance[0]} / lambert(lamp, Vec3d(0.16, -0.12, 0), Vec3d(0.06, -0.08, 1).normalized()) - 1);
    EXPECT_LT(error(0.1f), 0.02);
    EXPECT_LT(error(0.1f), 0.2 * without);
    EXPECT_LT(error(0.2f), 0.06);
}

constexpr RecordSpacing any_spacing = {0.f, 1e6f};

/// A cache for the unit box.
IrradianceCache cache_of(float accuracy) {
    Bounds bounds;
    bounds.lower = Vec3::Zero();
    bounds.upper = Vec3::Ones();
    return {bounds, accuracy};
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

/// The same without a gradient.
IrradianceRecord even_record(const Vec3& p, float distance) {
    IrradianceRecord record = linear_record(p, distance);
    record.translation.fill(Vec3::Zero());
    return record;
}

Vec3 point_of(std::uint64_t i) {
    const Sampler u(PointSet::independent, 11, i, 0);
    return {u.get_1d(0), u.get_1d(1), 0.5f};
}

TEST(IrradianceCache, InterpolatesALinearFieldExactly) {
    IrradianceCache cache = cache_of(0.3f);
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
    IrradianceCache cache = cache_of(0.25f);
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
    IrradianceCache cache = cache_of(accuracy);
    std::vector<IrradianceRecord> records;
    const auto error = [](const IrradianceRecord& r, const Vec3& p, const Vec3& n) {
        if ((p - r.p).dot(n + r.n) < -0.02f * r.distance) return infinity;  // p is behind the record
        return (p - r.p).norm() / r.distance + std::sqrt(std::max(0.f, 1 - n.dot(r.n)));
    };
    // The records are far apart, so that none is limited by its neighbours.
    for (std::uint64_t i = 0; records.size() < 12; ++i) {
        const auto record = even_record(point_of(i), 0.1f + 0.4f * Sampler(PointSet::independent, 12, i, 0).get_1d(0));
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
    IrradianceCache cache = cache_of(0.2f);
    const auto left = even_record(Vec3(0.3f, 0.5f, 0.5f), 1.f);
    auto right = even_record(Vec3(0.49f, 0.5f, 0.5f), 1.f);
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
    IrradianceCache cache = cache_of(0.3f);
    cache.insert(linear_record(Vec3(0.5f, 0.5f, 0.5f), 1.f), any_spacing);
    EXPECT_TRUE(cache.covers(Vec3(0.6f, 0.5f, 0.5f), Vec3(0, 0, 1)));
    EXPECT_FALSE(cache.covers(Vec3(0.6f, 0.5f, 0.45f), Vec3(0, 0, 1)));
    EXPECT_FALSE(cache.covers(Vec3(0.5f, 0.5f, 0.5f), Vec3(0, 0, -1)));
}

// A record with a surface nearby limits the reach of the records around it, whether they come before or after it.
TEST(IrradianceCache, NeighboursLimitEachOther) {
    for (const bool near_first : {true, false}) {
        IrradianceCache cache = cache_of(0.5f);
        const auto near = even_record(Vec3(0.5f, 0.5f, 0.5f), 0.05f), far = even_record(Vec3(0.6f, 0.5f, 0.5f), 1.f);
        // The far record covers the near one's place: its R falls from 1 to 0.05 + 0.1, its reach from 0.5 to 0.075.
        cache.insert(near_first ? near : far, any_spacing);
        cache.insert(near_first ? far : near, any_spacing);
        EXPECT_FALSE(cache.covers(Vec3(0.676f, 0.5f, 0.5f), Vec3(0, 0, 1))) << near_first;
        EXPECT_TRUE(cache.covers(Vec3(0.674f, 0.5f, 0.5f), Vec3(0, 0, 1))) << near_first;
    }
}

/// How often each pixel was looked at, if looks settle the pixels for which `is_served` holds.
std::vector<int> looks(std::size_t width, std::size_t height,
                       const std::function<bool(std::size_t x, std::size_t y)>& is_served) {
    RefinedGrid grid(width, height);
    std::vector<int> count(width * height, 0);
    do {
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                if (!grid.looks_at(x, y)) continue;
                ++count[y * width + x];
                grid.settle(y * width + x, is_served(x, y));
            }
    } while (grid.refine());
    return count;
}

TEST(RefinedGrid, LooksOnceAtEachPixelIfNothingIsServed) {
    const auto count = looks(50, 37, [](std::size_t, std::size_t) { return false; });
    EXPECT_EQ(count, std::vector<int>(count.size(), 1));
}

// If the last row and column of the image lie on the grid of step 4, only that grid and the coarser ones are looked at.
// Beyond it the grid of step 2 looks at what the coarser one does not surround.
TEST(RefinedGrid, LooksAtEveryFourthPixelIfAllAreServed) {
    const auto all = [](std::size_t, std::size_t) { return true; };
    const auto count = looks(65, 33, all), wider = looks(67, 33, all);
    for (std::size_t y = 0; y < 33; ++y)
        for (std::size_t x = 0; x < 67; ++x) {
            const int expected = x % 4 == 0 && y % 4 == 0 ? 1 : 0;
            if (x < 65) {
                EXPECT_EQ(count[y * 65 + x], expected) << x << ' ' << y;
            }
            EXPECT_EQ(wider[y * 67 + x], x == 66 && y % 2 == 0 ? 1 : expected) << x << ' ' << y;
        }
}

TEST(RefinedGrid, LooksAtEachPixelAroundOneThatIsNotServed) {
    const auto count = looks(65, 65, [](std::size_t x, std::size_t y) { return x != 32 || y != 32; });
    for (std::size_t y = 0; y < 65; ++y)
        for (std::size_t x = 0; x < 65; ++x) {
            // At step 2 the pixels up to 2 away have (32, 32) as a corner of their cell. They are served, so at step 1
            // only the pixels beside (32, 32) have a corner that is not.
            const bool at_two = x % 2 == 0 && y % 2 == 0 && x > 29 && x < 35 && y > 29 && y < 35;
            const bool at_one = x > 30 && x < 34 && y > 30 && y < 34;
            EXPECT_EQ(count[y * 65 + x], (x % 4 == 0 && y % 4 == 0) || at_two || at_one ? 1 : 0) << x << ' ' << y;
        }
}

}  // namespace
}  // namespace gib::test::irradiance_cache_test
