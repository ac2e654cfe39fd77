// The radius of progressive methods: its law, and its start.

#include "methods/parts/density/first_radius.h"
#include "methods/parts/density/shrinking_radius.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/support/scene_fixtures.h"

#include <gtest/gtest.h>

namespace gib {
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

// Photons spread evenly with a density of lambda per area: where 10 lie within r, pi r^2 lambda is a Gamma(10) variable,
// whose lower quartile is 7.73.
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
    EXPECT_EQ(places.on_surfaces.size(), 1024u);
    EXPECT_EQ(rays, 1024u);
    const PhotonMap map(walk.photons, walk.unit);
    const double r =
        first_radius(map, places.on_surfaces, 10, 2, scene.scene->diagonal(), [](const Photon&) { return true; });
    EXPECT_NEAR(std::numbers::pi * r * r * lambda, 7.73, 0.5);
}

// Photons in a spot are 100 times as dense as those around it. A third of the places lie in the spot: the radius suits it.
TEST(ShrinkingRadius, StartsWhereTheLightIs) {
    std::vector<Photon> photons;
    std::vector<Vec3> places;
    for (int i = 0; i < 100; ++i)
        for (int j = 0; j < 100; ++j) {
            const Vec3 unit((static_cast<float>(i) + 0.5f) / 100, (static_cast<float>(j) + 0.5f) / 100, 0);
            places.push_back((i + j) % 3 == 0 ? Vec3(0.1f * unit) : unit);
            for (const Vec3& p : {unit, Vec3(0.1f * unit)})
                photons.emplace_back(p, Color::Ones(), Vec3::UnitZ(), Vec3::UnitZ(), 1);
        }
    for (const double wanted : {0.5, 10.0}) {
        const double r =
            first_radius(PhotonMap(photons, 1), places, wanted, 2, 1.5f, [](const Photon&) { return true; });
        EXPECT_NEAR(std::numbers::pi * r * r * 1e6 / wanted, 1, 0.4);
    }
}

}  // namespace
}  // namespace gib
