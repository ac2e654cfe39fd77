// Photon tracing: conservation of power, and which photons each map holds.
#include "methods/parts/photons/photon_walk.h"
#include "common/core/parallel.h"
#include "tests/support/scene_fixtures.h"

#include <limits>

namespace gib::photon_walk_test {
namespace {

constexpr int unlimited = std::numeric_limits<int>::max();

/// Expects that in each channel the emitted power is absorbed or escapes, within 3
/// standard errors of the photons' own scatter.
void expect_balance(const LoadedScene& scene, bool closed) {
    const auto walk = trace_photons(*scene.scene, PhotonMapKind::global, 200000, unlimited, 3);
    const PowerBalance& b = walk.balance;
    const Colord truth = scene.scene->emitted_power();
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(b.emitted[c], truth[c], 1e-4 * truth[c]) << c;
        const double residual = b.emitted[c] - b.absorbed[c] - b.escaped[c];
        EXPECT_LE(std::abs(residual), 3 * std::sqrt(b.squared_residuals[c])) << c;
        EXPECT_GT(b.squared_residuals[c], 0) << c;
        if (closed) EXPECT_EQ(b.escaped[c], 0) << c;
        else EXPECT_GT(b.escaped[c], 0.05 * truth[c]) << c;
    }
}

TEST(PhotonWalk, PowerIsConservedInTheOpenBox) {
    expect_balance(test::shipped_scene("cornell-box.xml"), false);
    expect_balance(test::shipped_scene("cornell-glass.xml"), false);
}

TEST(PhotonWalk, PowerIsConservedInTheClosedBox) {
    expect_balance(test::shipped_scene("furnace.xml", {{{"rho", "0.9"}, {"emission", "0.1"}}, {}}), true);
}

// In the furnace every point receives the irradiance pi L = pi emission / (1 - rho). Direct light is
// the share 1 - rho of it, so photons that a surface has scattered carry rho pi L per area. They are
// stored at every hit before the roulette.
TEST(PhotonWalk, StoredPowerIsTheIndirectIrradianceOfTheFurnace) {
    const double rho = 0.9, emission = 0.1;
    const auto scene = test::shipped_scene("furnace.xml", {{{"rho", "0.9"}, {"emission", "0.1"}}, {}});
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
        const auto scene = test::shipped_scene("hard/furnace.xml", {{{"e", e}, {"r", r}}, {}});
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
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(faint.balance.emitted[c] / (1e-44 * bright.balance.emitted[c]), 1, 1e-6) << c;
}

// Photons leave a diffuse wall cosine-weighted. At the opposite wall, the mean cosine of the stored directions is
// that of diffuse light, 2/3 in the furnace; uniform directions with unchanged power would give 1/2.
TEST(PhotonWalk, StoredPhotonsArriveAsDiffuseLight) {
    const auto scene = test::shipped_scene("furnace-sphere.xml", {{{"rho", "0.5"}, {"emission", "0.5"}}, {}});
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
        return test::scene_of(test::scene_xml(
            "<sensor type='orthographic'>" + test::box_film(4) + "</sensor><shape type='rectangle'>" +
            test::diffuse(0.5) +
            "</shape><shape type='rectangle'><transform name='to_world'><scale value='0.1'/><rotate x='1' angle='180'/>"
            "<translate z='1'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>"
            "<emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>" +
            mirror));
    };
    const auto both = scene_with(
        "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='115'/>"
        "<translate x='-1' z='1'/></transform><bsdf type='conductor'/></shape>");
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

TEST(PhotonWalk, PathsAreNotLongerThanTheirLimit) {
    const auto box = test::shipped_scene("cornell-box.xml");
    for (int max_edges : {2, 3, 5}) {
        const auto walk = trace_photons(*box.scene, PhotonMapKind::global, 20000, max_edges, 1);
        int longest = 0;
        for (const auto& photon : walk.photons)
            longest = std::max<int>(longest, photon.edges);
        EXPECT_EQ(longest, max_edges == 2 ? 0 : max_edges - 1);
    }
}

TEST(PhotonWalk, PhotonsAreTheSameForAnyNumberOfThreads) {
    const auto scene = test::shipped_scene("cornell-glass.xml");
    const auto trace = [&](int threads) {
        PhotonWalkResult walk;
        with_threads(threads, [&] { walk = trace_photons(*scene.scene, PhotonMapKind::global, 50000, unlimited, 1); });
        return walk;
    };
    const auto one = trace(1);
    for (int threads : {2, 5}) {
        const auto many = trace(threads);
        ASSERT_EQ(one.photons.size(), many.photons.size());
        for (std::size_t i = 0; i < one.photons.size(); ++i)
            ASSERT_EQ(one.photons[i].p, many.photons[i].p);
        EXPECT_EQ(one.balance.absorbed[0], many.balance.absorbed[0]);
        EXPECT_EQ(one.rays, many.rays);
    }
}

}  // namespace
}  // namespace gib::photon_walk_test
