// The subset of photons on a page: its size, its shares and its uniformity.
#include "experiments/photons/photon_subset.h"
#include "experiments/photons/even_shares.h"

#include <gmock/gmock.h>

namespace gib::test::photon_subset_test {
namespace {

using ::testing::ElementsAre;

/// A map of `count` photons of power 1 at x = first, first + 1, ...
StoredPhotons photons_from(std::string_view map, std::size_t count, std::size_t first = 0) {
    StoredPhotons stored{.map = map, .unit = 2, .photons = {}};
    for (std::size_t i = 0; i < count; ++i)
        stored.photons.emplace_back(Vec3(static_cast<float>(first + i), 0, 0), Color::Ones(), Vec3::UnitZ(),
                                    Vec3::UnitZ(), 1);
    return stored;
}

TEST(EvenShares, GiveToLargeGroupsWhatSmallOnesLeave) {
    EXPECT_THAT(even_shares({100, 2, 50}, 42), ElementsAre(20, 2, 20));
    EXPECT_THAT(even_shares({3, 5}, 100), ElementsAre(3, 5));
    EXPECT_THAT(even_shares({}, 10), ElementsAre());
    EXPECT_THAT(even_shares({5, 5}, 0), ElementsAre(0, 0));
    for (const std::size_t shown : {0u, 1u, 7u, 99u, 100u}) {
        std::size_t taken = 0;
        for (std::size_t i = 0; i < 100; ++i)
            taken += is_at_step(i, 100, shown);
        EXPECT_EQ(taken, shown);
    }
}

TEST(PhotonSubset, HoldsAllPhotonsIfThereIsRoom) {
    PhotonSubset subset(100);
    subset.add(photons_from("global", 40), 0);
    subset.add(photons_from("global", 20, 40), 1);
    const auto maps = subset.maps();
    ASSERT_EQ(maps.size(), 1u);
    EXPECT_EQ(maps[0].stored, 60u);
    ASSERT_EQ(maps[0].shown.size(), 60u);
    EXPECT_EQ(maps[0].mean_power(), 2) << "power 1 in units of 2 W";
    std::set<float> places;
    for (const auto& shown : maps[0].shown) {
        places.insert(shown.photon.p.x());
        EXPECT_EQ(shown.pass, shown.photon.p.x() < 40.f ? 0u : 1u);
    }
    EXPECT_EQ(places.size(), 60u);
}

TEST(PhotonSubset, SharesItsRoomBetweenMaps) {
    PhotonSubset subset(1000);
    subset.add(photons_from("global", 100000), 0);
    subset.add(photons_from("caustic", 30), 0);
    const auto maps = subset.maps();
    ASSERT_EQ(maps.size(), 2u);
    EXPECT_EQ(maps[0].shown.size(), 970u);
    EXPECT_EQ(maps[1].shown.size(), 30u);
    EXPECT_EQ(maps[0].stored, 100000u);
}

// Chi-square test at alpha = 0.001: photons fall into 16 bins by when they came, in four passes. Of 8000 photons each bin
// expects 500; being drawn without replacement from 160000 lowers the sum by 5 %, which makes the test stricter in the
// right direction only for the upper bound, 37.7 (15 degrees of freedom).
TEST(PhotonSubset, IsUniformOverPhotonsAndPasses) {
    constexpr std::size_t passes = 4, each = 40000, shown = 8000, bins = 16;
    PhotonSubset subset(shown);
    for (std::uint32_t pass = 0; pass < passes; ++pass)
        subset.add(photons_from("global", each, pass * each), pass);
    const auto maps = subset.maps();
    ASSERT_EQ(maps[0].shown.size(), shown);
    std::array<double, bins> counts{};
    for (const auto& one : maps[0].shown)
        ++counts[static_cast<std::size_t>(one.photon.p.x()) / (passes * each / bins)];
    double sum = 0;
    for (const double count : counts)
        sum += sqr(count - shown / bins) / (shown / bins);
    EXPECT_LT(sum, 37.7);
}

TEST(PhotonSubset, CountsPowersThatAreNotFinite) {
    StoredPhotons stored = photons_from("global", 3);
    stored.photons[1].set_power(Color::Constant(std::numeric_limits<float>::quiet_NaN()));
    PhotonSubset subset(10);
    subset.add(stored, 0);
    const auto maps = subset.maps();
    EXPECT_EQ(maps[0].not_finite, 1u);
    EXPECT_EQ(maps[0].mean_power(), 2) << "of the two others";
}

}  // namespace
}  // namespace gib::test::photon_subset_test
