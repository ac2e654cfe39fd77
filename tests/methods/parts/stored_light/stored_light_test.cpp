// The light that runs store: the photons of the maps, the records of the cache, the patches of radiosity.
#include "methods/parts/stored_light/stored_light.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/methods/radiosity/fixtures.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace gib::test::stored_light_test {
namespace {

/// The light that the run of a label stores after some passes.
StoredLight stored_after(const LoadedScene& scene, const std::string& label, std::uint32_t passes) {
    const ConfiguredMethod method(MethodLabel::parse(label));
    StageTimes stages;
    const auto run = method.create({scene.max_edges})->start(*scene.scene, 1, stages);
    for (std::uint32_t pass = 0; pass < passes; ++pass)
        run->advance(pass);
    return run->stored_light();
}

/// Positions in an order of their own, because a map has another order than the walk that filled it.
std::vector<std::array<float, 3>> sorted_positions(const std::vector<Photon>& photons) {
    std::vector<std::array<float, 3>> positions;
    for (const Photon& photon : photons)
        positions.push_back({photon.p.x(), photon.p.y(), photon.p.z()});
    std::sort(positions.begin(), positions.end());
    return positions;
}

double power_of(const StoredPhotons& stored) {
    double sum = 0;
    for (const Photon& photon : stored.photons)
        sum += stored.unit * static_cast<double>(photon.power().mean());
    return sum;
}

TEST(StoredLight, OfThePhotonMapperAreThePhotonsOfItsWalks) {
    const auto fog = shipped_scene("fog.xml", {{}, std::pair{4, 4}});
    const StoredLight stored = stored_after(fog, "photon_mapper photons=2000 projection=off", 0);
    const std::pair<const char*, PhotonMapKind> maps[] = {
        {"global", PhotonMapKind::global}, {"caustic", PhotonMapKind::caustic}, {"volume", PhotonMapKind::volume}};
    ASSERT_EQ(stored.photons.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto walk = trace_photons(*fog.scene, maps[i].second, 2000, fog.max_edges, 1);
        EXPECT_EQ(stored.photons[i].map, maps[i].first);
        EXPECT_EQ(stored.photons[i].unit, walk.unit);
        EXPECT_EQ(sorted_positions(stored.photons[i].photons), sorted_positions(walk.photons));
    }
    EXPECT_TRUE(stored.records.empty());
}

// With gather rays, the map holds all photons on diffuse surfaces, also the first ones of their paths.
TEST(StoredLight, HasTheMapOfGatherRaysAndTheRecordsOfTheCache) {
    const auto box = shipped_scene("cornell-box.xml", {{}, std::pair{64, 64}});
    const StoredLight stored = stored_after(box, "photon_mapper photons=2000 gather=16 cache=on accuracy=0.2", 1);
    ASSERT_EQ(stored.photons.size(), 1u);
    EXPECT_TRUE(std::any_of(stored.photons[0].photons.begin(), stored.photons[0].photons.end(),
                            [](const Photon& photon) { return photon.edges == 1; }));
    ASSERT_GT(stored.records.size(), 10u);
    for (const StoredRecord& record : stored.records) {
        EXPECT_GT(record.radius, 0.f);
        EXPECT_LT(record.radius, box.scene->diagonal());
        EXPECT_NEAR(record.n.norm(), 1.f, 1e-4f);
        EXPECT_TRUE(record.irradiance.isFinite().all());
    }
    const StoredLight finer = stored_after(box, "photon_mapper photons=2000 gather=16 cache=on accuracy=0.1", 1);
    EXPECT_GT(finer.records.size(), stored.records.size());
    const auto widest = [](const StoredLight& s) {
        return std::max_element(s.records.begin(), s.records.end(),
                                [](const auto& a, const auto& b) { return a.radius < b.radius; })
            ->radius;
    };
    EXPECT_LT(widest(finer), widest(stored)) << "a radius is a R_i, in proportion to the accuracy a";
}

TEST(StoredLight, OfAProgressiveMapperIsThatOfTheLastPass) {
    const auto box = shipped_scene("cornell-box.xml", {{}, std::pair{4, 4}});
    const std::string label = "progressive_photon_mapper photons=1000 radius=0.1";
    const auto first = stored_after(box, label, 1), second = stored_after(box, label, 2);
    ASSERT_EQ(first.photons.size(), 1u);
    ASSERT_EQ(second.photons.size(), 1u);
    EXPECT_NE(sorted_positions(first.photons[0].photons), sorted_positions(second.photons[0].photons));
    // Both passes emit the power of the lamp; 1000 photons of each give its stored part within 10 %.
    EXPECT_NEAR(power_of(first.photons[0]), power_of(second.photons[0]), 0.3 * power_of(first.photons[0]));
}

// A closed box of reflectance rho with a lamp of power P inside: the patches together reflect
// P rho / (1 - rho), as every surface returns the share rho of all light that it gets.
TEST(StoredLight, OfRadiosityIsThePowerThatPatchesReflect) {
    const auto room = seen_from_inside(hollow_cube(one_sided("0.5")) + point_light(0, 0, 0, 1));
    EXPECT_TRUE(stored_after(room, "radiosity patch=0.1", 0).empty()) << "before the first sweep";
    const StoredPatches patches = stored_after(room, "radiosity patch=0.1", 20).patches;
    ASSERT_EQ(patches.corners.size(), patches.radiosity.size());
    double area = 0, power = 0;
    for (const auto& [a, b, c, d] : patches.patches) {
        const auto triangle = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
            const Vec3 n = (patches.corners[j] - patches.corners[i]).cross(patches.corners[k] - patches.corners[i]);
            const double size = 0.5 * static_cast<double>(n.norm());
            area += size;
            power +=
                size / 3 * static_cast<double>((patches.radiosity[i] + patches.radiosity[j] + patches.radiosity[k])[0]);
            EXPECT_LE(n.dot(patches.corners[i]), 0.f) << "seen from the front, corners turn left";
        };
        triangle(a, b, c);
        triangle(a, c, d);
    }
    EXPECT_NEAR(area, 24, 1e-4);
    EXPECT_NEAR(power, 4 * std::numbers::pi, 0.02 * 4 * std::numbers::pi);
}

}  // namespace
}  // namespace gib::test::stored_light_test
