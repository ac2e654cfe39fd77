// Photons: their compact storage, the conservation of power in their walks, and which of them each map holds.
#include "methods/parts/photons/photon.h"

#include "common/color/dispersion.h"
#include "common/core/float_traps.h"
#include "common/core/parallel.h"
#include "common/sampling/warp.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <limits>

namespace gib::test::photon_test {
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

constexpr int unlimited = std::numeric_limits<int>::max();

// In a closed room only the walls absorb light, because glass and a medium of albedo 1 lose none. A photon that is stored on
// a wall of reflectance rho leaves the share 1 - rho of its power there, so all photons together leave what the light
// emits, in each channel. Five standard errors: all six comparisons fail by chance with a probability of 1e-3.
TEST(PhotonWalk, WallsAbsorbWhatTheLightEmits) {
    const std::string fog = "<medium name='interior' type='homogeneous'>" + rgb("sigma_s", "0.3, 1, 4") + "</medium>";
    for (const std::string& inside : {std::string(), fog}) {
        const auto room = Scene(element("sensor", "perspective", box_film(4)),
                                shape("cube", flag("flip_normals"), one_sided("0.8, 0.5, 0.2")),
                                shape("sphere", center(-0.4, 0, 0), radius(0.4), bsdf("dielectric"), inside),
                                point_light(0.5, 0, 0.3, 1))
                              .load();
        const Colord rho(0.8, 0.5, 0.2), emitted = room.scene->emitted_power();
        std::array<Moments, 3> absorbed;
        for (std::uint64_t seed = 1; seed <= 16; ++seed) {
            const auto walk = trace_photons(*room.scene, PhotonMapKind::full, 20000, unlimited, seed);
            Colord sum = Colord::Zero();
            for (const auto& photon : walk.photons)
                sum += walk.unit * photon.power().cast<double>() * (1 - rho);
            for (Eigen::Index c = 0; c < 3; ++c)
                absorbed[static_cast<std::size_t>(c)].add(sum[c] / emitted[c]);
        }
        for (const Moments& of_channel : absorbed) {
            EXPECT_LT(of_channel.standard_error(), 0.005) << "the test would not see an error";
            EXPECT_NEAR(of_channel.mean(), 1, 5 * of_channel.standard_error()) << inside;
        }
    }
}

// In the furnace every point receives the irradiance pi L = pi emission / (1 - rho). Direct light is
// the share 1 - rho of it, so photons that a surface has scattered carry rho pi L per area. They are
// stored at every hit before the roulette.
TEST(PhotonWalk, StoredPowerIsTheIndirectIrradianceOfTheFurnace) {
    const double rho = 0.9, emission = 0.1;
    const auto scene = shipped_scene("furnace.xml", {{{"rho", "0.9"}, {"emission", "0.1"}}, {}});
    double area = 0;
    for (const auto& shape : scene.scene->shapes())
        area += area_of(shape);
    const auto walk = trace_photons(*scene.scene, PhotonMapKind::global, 200000, unlimited, 3);
    double stored = 0;
    for (const auto& photon : walk.photons)
        stored += walk.unit * static_cast<double>(photon.power()[0]);
    const double expected = std::numbers::pi * emission / (1 - rho) * rho * area;
    // A photon is stored a geometric number of times with mean 9. The relative deviation is about 1.05 for one photon
    // and 0.24 % for 2e5 photons.
    EXPECT_NEAR(stored / expected, 1, 3 * 0.0024);
}

// The light emits 4e-43 W in 50000 photons; as a float in W, the power of each would be 0.
TEST(PhotonWalk, FaintLightLosesNoPower) {
    constexpr int photons = 50000;
    const auto walk_of = [](const char* e, const char* r) {
        const auto scene = shipped_scene("hard/furnace.xml", {{{"e", e}, {"r", r}}, {}});
        return trace_photons(*scene.scene, PhotonMapKind::global, photons, unlimited, 3);
    };
    const auto stored = [](const PhotonWalkResult& walk) {
        double sum = 0;
        for (const auto& photon : walk.photons)
            sum += walk.unit * photon.power().cast<double>().mean();
        return sum;
    };
    const auto bright = walk_of("0", "0"), faint = walk_of("-12", "-20");
    // Both walks use the same random numbers, but rounding parts some of their paths. The bound assumes that all
    // paths differ: with albedo 1/2 a photon is stored a geometric number of times, with the relative variance 1 /
    // albedo. It is 4 standard deviations of the ratio of two sums.
    EXPECT_NEAR(stored(faint) / (1e-44 * stored(bright)), 1, 4 * std::sqrt(2 / (0.5 * photons)));
}

// Photons leave a diffuse wall cosine-weighted. At the opposite wall, the mean cosine of the stored directions is
// that of diffuse light, 2/3 in the furnace; uniform directions with unchanged power would give 1/2.
TEST(PhotonWalk, StoredPhotonsArriveAsDiffuseLight) {
    const auto scene = shipped_scene("furnace-sphere.xml", {{{"rho", "0.5"}, {"emission", "0.5"}}, {}});
    const auto walk = trace_photons(*scene.scene, PhotonMapKind::global, 200000, unlimited, 5);
    double sum = 0, power = 0;
    for (const auto& photon : walk.photons) {
        const double p = static_cast<double>(photon.power()[0]);
        sum += p * static_cast<double>(photon.direction().dot(photon.surface_normal()));
        power += p;
    }
    // The deviation of a cosine-weighted cosine is 0.236; that of the mean over 2e5 photons is 5e-4.
    EXPECT_NEAR(sum / power, 2.0 / 3.0, 4 * 5e-4 + 2e-3 /* quantised normals */);
}

// A lamp faces a floor, and a mirror leans over the floor. Light arrives as L D, L S D and L D S D, never as L D D.
TEST(PhotonWalk, MapsHoldTheirOwnPathsOnly) {
    const auto scene_with = [](const std::string& mirror) {
        return Scene(element("sensor", "orthographic", box_film(4)), shape("rectangle", diffuse(0.5)),
                     shape("rectangle", to_world(scale(0.1), rotate('x', 180), translate(0, 0, 1)), one_sided("0"),
                           area_light(1)),
                     mirror)
            .load();
    };
    const auto both =
        scene_with(shape("rectangle", to_world(rotate('y', 115), translate(-1, 0, 1)), bsdf("conductor")));
    // If a path has at most three edges, its photon has at most two: L S D is a caustic photon, and none was
    // scattered diffusely before.
    EXPECT_TRUE(trace_photons(*both.scene, PhotonMapKind::global, 50000, 3, 1).photons.empty());
    const auto caustic = trace_photons(*both.scene, PhotonMapKind::caustic, 50000, 3, 1);
    EXPECT_GT(caustic.photons.size(), 100u);
    for (const auto& photon : caustic.photons)
        EXPECT_EQ(photon.edges, 2);
    // The longer paths L D S D belong to the global map alone.
    EXPECT_FALSE(trace_photons(*both.scene, PhotonMapKind::global, 50000, unlimited, 1).photons.empty());
    const auto plain = scene_with("");
    EXPECT_TRUE(trace_photons(*plain.scene, PhotonMapKind::caustic, 50000, unlimited, 1).photons.empty());
    EXPECT_TRUE(trace_photons(*plain.scene, PhotonMapKind::global, 50000, unlimited, 1).photons.empty());
}

}  // namespace
}  // namespace gib::test::photon_test
