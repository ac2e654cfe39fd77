// The compact storage of photons: directions, powers and their rounding.
#include "methods/parts/photons/photon.h"
#include "common/color/dispersion.h"
#include "common/core/float_traps.h"
#include "common/sampling/sampler.h"
#include "common/sampling/warp.h"

#include <gtest/gtest.h>

namespace gib::photon_test {
namespace {

Photon photon_of(const Color& power) { return {Vec3::Zero(), power, Vec3::UnitZ(), Vec3::UnitZ(), 1}; }

/// Power number i of a sequence. Each channel is log-uniform between 10^-decades and 1 times `scale`.
Color random_power(std::uint64_t i, float decades, float scale) {
    const Sampler u(PointSet::independent, 7, i, 0);
    return scale * Color(u.get_1d(0), u.get_1d(1), u.get_1d(2)).unaryExpr([=](float x) {
        return std::pow(10.f, -decades * x);
    });
}

TEST(Photon, DirectionsSurviveStorageWithinTheStatedAngle) {
    for (std::uint64_t i = 0; i < 100000; ++i) {
        const Vec3 w = square_to_sphere(Sampler(PointSet::independent, 1, i, 0).get_2d(0));
        EXPECT_LT((decode_direction(encode_direction(w)) - w).norm(), 1e-4f);
        EXPECT_LT((decode_normal(encode_normal(w)) - w).norm(), 0.02f);
    }
    for (int axis = 0; axis < 3; ++axis)
        for (float sign : {-1.f, 1.f}) {
            const Vec3 w = sign * Vec3::Unit(axis);
            EXPECT_EQ(decode_direction(encode_direction(w)), w);
            EXPECT_EQ(decode_normal(encode_normal(w)), w);
        }
}

TEST(Photon, EverythingComesBackAsItWasStored) {
    for (int stratum = -1; stratum < wavelength_strata; ++stratum)
        for (bool in_medium : {false, true}) {
            const std::optional<int> expected = stratum < 0 ? std::nullopt : std::optional<int>(stratum);
            const Photon photon(Vec3(1, -2, 3), Color(0.25f, 0.f, 3.f), Vec3(0, 0.6f, -0.8f), Vec3(0, 0, -1), 65535,
                                in_medium, expected);
            EXPECT_EQ(photon.p, Vec3(1, -2, 3));
            EXPECT_TRUE((photon.power() == Color(0.25f, 0.f, 3.f)).all());
            EXPECT_LT((photon.direction() - Vec3(0, 0.6f, -0.8f)).norm(), 1e-4f);
            EXPECT_EQ(photon.surface_normal(), Vec3(0, 0, -1));
            EXPECT_EQ(photon.edges, 65535);
            EXPECT_EQ(photon.in_medium(), in_medium);
            EXPECT_EQ(photon.stratum(), expected);
        }
    const Photon plain(Vec3::Zero(), Color::Ones(), Vec3::UnitX(), Vec3::UnitX(), 2);
    EXPECT_FALSE(plain.in_medium());
    EXPECT_EQ(plain.stratum(), std::nullopt);
}

TEST(Photon, PowerIsOffByHalfAUnitAtMost) {
    for (std::uint64_t i = 0; i < 300000; ++i) {
        const float scale = std::pow(10.f, -30.f + 60.f * Sampler(PointSet::independent, 8, i, 0).get_1d(0));
        const Color any = random_power(i, 6.f, 1.f);
        const Color power = any * (scale / any.maxCoeff());
        const Color error = (photon_of(power).power() - power).abs();
        ASSERT_LE(error.maxCoeff(), 0x1p-16f * power.maxCoeff()) << power.transpose();
    }
}

// Rounding errors are independent and have the mean zero, so their sum is within 4 of its standard errors (alpha =
// 6e-5 each). Truncation would lose half a unit of every photon, more than 1000 standard errors.
TEST(Photon, ASumOfManyPowersIsUnbiased) {
    for (const float scale : {1e-30f, 1e-5f, 1.f, 1e30f}) {
        Colord sum = Colord::Zero(), squares = Colord::Zero();
        for (std::uint64_t i = 0; i < 1000000; ++i) {
            const Color power = random_power(i, 3.f, scale);
            const Colord error =
                (photon_of(power).power().cast<double>() - power.cast<double>()) / static_cast<double>(scale);
            sum += error;
            squares += error.square();
        }
        for (Eigen::Index c = 0; c < 3; ++c) {
            EXPECT_GT(squares[c], 0);
            EXPECT_LE(std::abs(sum[c]), 4 * std::sqrt(squares[c])) << scale << ' ' << c;
        }
    }
}

TEST(Photon, ExtremePowersHaveADefinedResult) {
    EXPECT_TRUE((photon_of(Color::Zero()).power() == 0.f).all());
    EXPECT_TRUE((photon_of(Color(-0.f, 0.f, 0.f)).power() == 0.f).all());
    for (int e = -126; e < 128; ++e) {
        const float x = std::ldexp(1.f, e);
        EXPECT_TRUE((photon_of(Color(x, 0.f, 0.f)).power() == Color(x, 0.f, 0.f)).all()) << e;
        // The value rounds up to a power of two, which takes a larger unit.
        if (e > -100) {
            EXPECT_EQ(photon_of(Color::Constant(std::nextafter(x, 0.f))).power()[0], x) << e;
        }
    }
    EXPECT_TRUE(
        (photon_of(Color(1e30f, 1e-30f, 0.f)).power() == Color(photon_of(Color::Constant(1e30f)).power()[0], 0, 0))
            .all());
    // Values below the smallest unit are still rounded to nearest.
    EXPECT_EQ(photon_of(Color::Constant(0x1p-128f)).power()[0], 0.f);
    EXPECT_EQ(photon_of(Color::Constant(0x1.8p-127f)).power()[0], 0x1p-126f);

    const FloatTrapsPaused paused;  // a NaN is passed below
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float x : {nan, -nan, infinity, -infinity, -1.f, std::numeric_limits<float>::max()})
        for (Eigen::Index c = 0; c < 3; ++c) {
            Color power = Color::Ones();
            power[c] = x;
            EXPECT_FALSE(photon_of(power).power().isFinite().all()) << x << ' ' << c;
            power.setZero();
            power[c] = x;
            EXPECT_FALSE(photon_of(power).power().isFinite().all()) << x << ' ' << c;
        }
}

}  // namespace
}  // namespace gib::photon_test
