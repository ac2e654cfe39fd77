// Irradiance that is precomputed at the places of some photons, for use by gather rays.
#include "methods/parts/gathering/precomputed_irradiance.h"

#include "methods/method.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::precomputed_irradiance_test {
namespace {

/// Photons of power 1 / count each, uniform on the square [-1, 1]^2 of a floor,
/// so that the irradiance is 1/4 everywhere.
std::vector<Photon> even_photons(std::size_t count, std::uint64_t seed) {
    std::vector<Photon> photons;
    const Vec3 up(0, 0, 1);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2 u = Sampler(PointSet::independent, seed, i, 0).get_2d(0);
        const Vec3 p(2 * u.x() - 1, 2 * u.y() - 1, 0);
        photons.emplace_back(p, Color::Constant(1.f / static_cast<float>(count)), up, up, static_cast<int>(1 + i % 2));
    }
    return photons;
}

/// The photons of even_photons, scaled to the floor z = -half of a closed room with walls 2 half long. Their power is
/// scaled with the area, so that the irradiance is 1/4 here, too.
std::vector<Photon> even_photons_in_a_room(std::size_t count, float half) {
    const Vec3 up(0, 0, 1);
    std::vector<Photon> photons;
    for (const Photon& photon : even_photons(count, 1))
        photons.emplace_back(half * (photon.p - up), sqr(half) * photon.power(), up, up, photon.edges);
    return photons;
}

LoadedScene floor_scene() { return Scene(element("sensor", "perspective"), shape("rectangle")).load(); }

double power_of(const std::vector<Photon>& photons) {
    double power = 0;
    for (const Photon& photon : photons)
        power += static_cast<double>(photon.power().x());
    return power;
}

/// Look-ups in the irradiance at these places that a map of `photons` makes.
struct LookUps {
    LookUps(const LoadedScene& loaded, const std::vector<Photon>& places, std::vector<Photon> photons, std::size_t k,
            float max_radius = 1.f, int max_edges = 100, double unit = 1, std::uint64_t seed = 1)
        : rays(*loaded.scene),
          map(std::move(photons), unit),
          irradiance(*loaded.scene, places, map, DensityEstimator{Kernel::uniform, k, max_radius, DiscArea::surface},
                     max_edges, seed, traced, nullptr),
          widest(max_radius) {
        EXPECT_EQ(irradiance.size(), places.size());
    }
    /// The irradiance below `eye`, on the side of the normal (0, 0, side).
    std::optional<Color> below(const Vec3& eye, float side = 1.f) {
        const auto hit = rays.intersect({eye, Vec3(0, 0, -1)});
        EXPECT_TRUE(hit);
        return irradiance.at(rays, *hit, Vec3(0, 0, side), infinity, widest);
    }

    RayQueries rays;
    PhotonMap map;
    std::uint64_t traced = 0;
    PrecomputedIrradiance irradiance;
    float widest;
};

TEST(PrecomputedIrradiance, PlacesAndTheOthersTogetherHaveAllThePower) {
    auto photons = even_photons(8000, 1);
    const auto places = take_places(photons);
    // The bound is 5 standard deviations of a binomial count.
    EXPECT_NEAR(static_cast<double>(places.size()), 1000, 5 * std::sqrt(8000 * 7 / 64.0));
    EXPECT_EQ(photons.size() + places.size(), 8000u);
    EXPECT_NEAR(power_of(photons), static_cast<double>(photons.size()) / 7000, 2 * 0x1p-16) << "rounded twice";
}

// At points that are independent of the photons, the mean irradiance over 200 maps is right within 5 standard errors
// of less than 0.2 %. If the photons that give places were counted too, the irradiance would be too large by about
// 1 / k at the places, and too small by about 1 / k around them.
TEST(PrecomputedIrradiance, IsRightInTheMean) {
    const auto loaded = floor_scene();
    Moments mean;
    int asked = 0, answered = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        auto photons = even_photons(4000, seed);
        const auto places = take_places(photons);
        LookUps look_ups(loaded, places, std::move(photons), 50, 1.f, 100, 1, seed);
        double sum = 0;
        int points = 0;
        for (float x = -0.6f; x < 0.65f; x += 0.1f)
            for (float y = -0.6f; y < 0.65f; y += 0.1f) {
                const auto E = look_ups.below(Vec3(x, y, 1));
                ++asked;
                if (!E) continue;  // no place within its disc's width: 7 places a disc, so e^-7
                sum += static_cast<double>(E->x());
                ++points;
            }
        mean.add(4 * sum / points);
        answered += points;
    }
    EXPECT_GT(answered, 0.99 * asked);
    EXPECT_LT(mean.standard_error(), 0.002);
    EXPECT_NEAR(mean.mean(), 1, 5 * mean.standard_error());
}

// Half of the photons have paths of one edge; the others must not count.
TEST(PrecomputedIrradiance, CountsNoPhotonOfALongerPath) {
    const auto loaded = floor_scene();
    auto photons = even_photons(80000, 3);
    const auto places = take_places(photons);
    LookUps look_ups(loaded, places, std::move(photons), 2000, 1.f, 1);
    EXPECT_NEAR(look_ups.below(Vec3(0.1f, 0.1f, 1))->x(), 0.125, 0.125 * 5 / std::sqrt(2000.0));
    EXPECT_FALSE(look_ups.below(Vec3(0.1f, 0.1f, 1), -1.f)) << "the other side";
}

// A wall stands on the floor at x = 0. Beyond it there is 1000 times the light, and the nearest place lies there; the
// next one, on the side of the hit, serves instead. The bound is 5 standard deviations of the 400 photons of an estimate.
TEST(PrecomputedIrradiance, APlaceBehindAWallIsPassedOver) {
    const auto loaded =
        Scene(element("sensor", "perspective"), shape("rectangle"), shape("rectangle", to_world(rotate('y', 90))))
            .load();
    auto photons = even_photons(20000, 1);
    for (Photon& photon : photons)
        if (photon.p.x() < 0.f) photon.set_power(1000.f * photon.power());
    const Vec3 up(0, 0, 1);
    const std::vector<Photon> places = {{Vec3(-0.01f, 0.3f, 0), Color::Ones(), up, up, 1},
                                        {Vec3(0.06f, 0.3f, 0), Color::Ones(), up, up, 1}};
    const auto E = LookUps(loaded, places, std::move(photons), 400).below(Vec3(0.01f, 0.3f, 0.5f));
    ASSERT_TRUE(E);
    EXPECT_NEAR(4 * E->x(), 1.f, 5 * 0.05f);
}

// The room lies between plates a million times its size. The mean is over points whose discs end before the walls.
// The bound is 5 standard deviations of the number of photons below the points, 7 / 8 of 4000 on 0.6^2 of the floor.
TEST(PrecomputedIrradiance, KnowsTheFloorOfARoomThatIsSmallBesideTheScene) {
    constexpr float half = 1e-6f;
    const auto loaded =
        Scene(element("sensor", "perspective"), shape("rectangle", to_world(translate(0, 0, 1))),
              shape("rectangle", to_world(translate(0, 0, -1))), shape("cube", to_world(scale(1e-6)), diffuse(0.5)))
            .load();
    auto photons = even_photons_in_a_room(4000, half);
    const auto places = take_places(photons);
    LookUps look_ups(loaded, places, std::move(photons), 50, half);
    Moments mean;
    for (float x = -0.6f; x < 0.65f; x += 0.1f)
        for (float y = -0.6f; y < 0.65f; y += 0.1f) {
            const auto E = look_ups.below(half * Vec3(x, y, 0));
            ASSERT_TRUE(E);
            mean.add(4 * static_cast<double>(E->x()));
        }
    EXPECT_NEAR(mean.mean(), 1, 5 / std::sqrt(4000 * 7 / 8 * 0.36));
}

}  // namespace
}  // namespace gib::test::precomputed_irradiance_test
