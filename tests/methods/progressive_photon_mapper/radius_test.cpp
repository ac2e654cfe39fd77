// The radius of progressive methods: its law, and its start.

#include "methods/parts/density/first_radius.h"
#include "methods/parts/density/shrinking_radius.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/support/scene_fixtures.h"

#include <gtest/gtest.h>

#include <random>

namespace gib::radius_test {
namespace {

TEST(ShrinkingRadius, IsTheProductOfTheLaw) {
    for (const double alpha : {0.3, 0.67, 0.9}) {
        const ShrinkingRadius radius(alpha);
        double product = 1;
        for (std::uint64_t passes = 0; passes < 1000; ++passes) {
            ASSERT_NEAR(std::pow(radius.on_surfaces(passes), 2) / product, 1, 1e-10);
            ASSERT_NEAR(std::pow(radius.in_media(passes), 3) / product, 1, 1e-10);
            const auto i = static_cast<double>(passes + 1);
            product *= (i + alpha) / (i + 1);
        }
    }
}

// Photons spread evenly have no bias: the radius is the last, of those whose discs double, whose discs hold 10 at most.
TEST(ShrinkingRadius, StartsAtTheDensityOfPhotons) {
    const std::string camera =
        "<sensor type='orthographic'><transform name='to_world'><scale value='0.3'/><lookat origin='0,0,0.5' "
        "target='0,0,0' up='0,1,0'/></transform>" +
        test::box_film(32) + "</sensor>";
    const auto scene = test::scene_of(test::scene_xml(camera + "<shape type='rectangle'>" + test::diffuse(0.5) +
                                                      "</shape><emitter type='constant'/>"));
    constexpr std::uint64_t count = 100000;
    PhotonWalkResult walk = trace_photons(*scene.scene, PhotonMapKind::full, count, 3, 1);
    std::erase_if(walk.photons, [](const Photon& photon) { return photon.surface_normal().z() < 0; });
    const double lambda = static_cast<double>(walk.photons.size()) / 4;
    std::uint64_t rays = 0;
    const SeenPlaces places = seen_places(*scene.scene, {3, false, false}, 1, rays);
    EXPECT_EQ(places.on_surfaces.size(), 8192u);
    EXPECT_EQ(rays, 8192u);
    const double r = first_radius(PhotonMap(walk.photons, walk.unit), 1, places.on_surfaces, 10, 2,
                                  scene.scene->diagonal(), [](const Photon&) { return 1.0; });
    EXPECT_LT(std::numbers::pi * r * r * lambda, 10.3);
    EXPECT_GT(std::numbers::pi * r * r * lambda, 4.9);
}

// The density of photons is lambda (1 + a cos k x) with a = 1/2. A disc of radius r has the bias r^2 / 8 times its second
// derivative, whose mean square is (a lambda k^2)^2 / 2, and the variance lambda / (pi r^2). Over the passes with
// alpha = 2/3 three times the squared bias stands against the variance, and half of it is best:
// r^6 = 64 / (3 pi a^2 lambda k^4). The search finds it within the factor of one step either way.
TEST(ShrinkingRadius, StartsWhereBiasAndVarianceBalance) {
    for (const double waves : {2.0, 8.0})
        for (const auto& [count, passes] :
             {std::pair(20000u, 1.0), std::pair(200000u, 1.0), std::pair(200000u, 10.0)}) {
            const double k = 2 * std::numbers::pi * waves;
            std::mt19937_64 random(count);
            std::uniform_real_distribution<double> number(0, 1);
            std::vector<Photon> photons;
            std::vector<Vec3> places;
            while (photons.size() < count) {
                const Vec3 p(static_cast<float>(number(random)), static_cast<float>(number(random)), 0);
                if (number(random) * 1.5 < 1 + 0.5 * std::cos(k * double{p.x()}))
                    photons.emplace_back(p, Color::Ones(), Vec3::UnitZ(), Vec3::UnitZ(), 1);
            }
            for (int i = 0; i < 8192; ++i)
                places.emplace_back(static_cast<float>(0.1 + 0.8 * number(random)),
                                    static_cast<float>(0.1 + 0.8 * number(random)), 0.f);
            const double expected =
                std::pow(64 / (3 * std::numbers::pi * 0.25 * count / passes * std::pow(k, 4)), 1.0 / 6);
            const double r =
                first_radius(PhotonMap(photons, 1), passes, places, 1e9, 2, 1.4f, [](const Photon&) { return 1.0; });
            EXPECT_LT(r / expected, std::numbers::sqrt2)
                << waves << " waves, " << count << " photons, " << passes << " passes";
            EXPECT_GT(r / expected, 1 / std::numbers::sqrt2)
                << waves << " waves, " << count << " photons, " << passes << " passes";
        }
}

}  // namespace
}  // namespace gib::radius_test
