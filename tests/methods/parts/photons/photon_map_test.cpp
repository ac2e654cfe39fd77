// The photon map's searches against a search over all photons.
#include "methods/parts/photons/photon_map.h"
#include "common/core/parallel.h"
#include "methods/parts/kd_tree/nearest.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/support/scene_fixtures.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace gib::test::photon_map_test {
namespace {

std::vector<Photon> random_photons(std::size_t n, std::uint64_t seed, float z_extent) {
    std::vector<Photon> photons(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Sampler u(PointSet::independent, seed, i, 0);
        const Vec2 xy = u.get_2d(0);
        photons[i] = {Vec3(xy.x(), xy.y(), z_extent * u.get_1d(1)), Color::Ones(), Vec3(0, 0, 1), Vec3(0, 0, 1), 2};
    }
    return photons;
}

const auto accept_all = [](const Photon&, float) { return true; };

/// The squared distance in the order of operations that the map promises, so
/// that results can be compared for equality.
float squared_distance(const Vec3& a, const Vec3& b) {
    return (sqr(a.x() - b.x()) + sqr(a.y() - b.y())) + sqr(a.z() - b.z());
}

using Neighbours = std::vector<Neighbour>;

Neighbours sorted(Neighbours found) {
    std::sort(found.begin(), found.end());
    return found;
}

/// All photons within r, the nearest first.
Neighbours search_over_all(const PhotonMap& map, const Vec3& p, float r) {
    Neighbours all;
    for (std::uint32_t i = 0; i < map.size(); ++i)
        if (const float d2 = squared_distance(map[i].p, p); d2 <= r * r) all.push_back({d2, i});
    return sorted(all);
}

/// Compares both searches of the map with a search over all photons, for several k and radii.
void expect_right_results(const PhotonMap& map, const Vec3& p, const std::vector<float>& radii,
                          const std::vector<std::size_t>& ks) {
    Neighbours found;
    for (float r : radii) {
        const Neighbours all = search_over_all(map, p, r);
        std::vector<float> distances;
        map.within(p, r, [&](const Photon& photon, float d2) {
            EXPECT_EQ(d2, squared_distance(photon.p, p));
            distances.push_back(d2);
        });
        std::sort(distances.begin(), distances.end());
        ASSERT_EQ(distances.size(), all.size()) << r;
        for (std::size_t i = 0; i < all.size(); ++i)
            ASSERT_EQ(distances[i], all[i].distance2);
        const auto is_farthest = [&](const Photon&, float d2) { return d2 == all.back().distance2; };
        EXPECT_EQ(map.any_within(p, r, is_farthest), !all.empty()) << r;

        for (std::size_t k : ks) {
            find_nearest(map, p, k, r, accept_all, found);
            Neighbours expected = all;
            if (expected.size() > k) expected.resize(k);
            if (k > 0 && found.size() == k) {
                EXPECT_EQ(found.back(), expected.back());
            }
            ASSERT_EQ(sorted(found), expected) << map.size() << ' ' << k << ' ' << r;
        }
        const auto nearest = find_nearest(map, p, r, accept_all);
        ASSERT_EQ(nearest.has_value(), !all.empty());
        if (nearest) {
            EXPECT_EQ(*nearest, all.front());
        }
    }
}

TEST(PhotonMap, FindsTheSamePhotonsAsASearchOverAll) {
    for (std::size_t n : {0u, 1u, 7u, 8u, 9u, 1000u, 5003u})
        for (float z_extent : {0.f, 1.f}) {
            const PhotonMap map(random_photons(n, n, z_extent), 1);
            ASSERT_EQ(map.size(), n);
            for (std::uint64_t q = 0; q < 40; ++q) {
                const Sampler u(PointSet::independent, 99, q, 0);
                const Vec3 p(2 * u.get_1d(0) - 0.5f, u.get_1d(1), u.get_1d(2));
                expect_right_results(map, p, {0.05f, 0.3f, 10.f, std::numeric_limits<float>::max()},
                                     {0, 1, 5, 50, 300, 2500});
            }
        }
}

TEST(PhotonMap, HoldsEveryPhotonOnceWithAllThatItCarries) {
    std::vector<Photon> photons = random_photons(5003, 1, 1.f);
    for (std::size_t i = 0; i < photons.size(); ++i) {
        const auto number = static_cast<int>(i);
        photons[i] = {
            photons[i].p, Color::Constant(static_cast<float>(i)), Vec3::UnitX(), Vec3::UnitY(), number, i % 2 == 0,
            number % 32};
    }
    const PhotonMap map(photons, 1);
    std::vector<int> seen(photons.size(), 0);
    for (std::size_t i = 0; i < map.size(); ++i) {
        const Photon photon = map[i];
        const Photon& original = photons[photon.edges];
        ++seen[photon.edges];
        EXPECT_EQ(photon.p, original.p);
        EXPECT_TRUE((photon.power() == original.power()).all());
        EXPECT_EQ(photon.in_medium(), original.in_medium());
        EXPECT_EQ(photon.stratum(), original.stratum());
        EXPECT_EQ(photon.direction(), Vec3::UnitX());
        EXPECT_EQ(photon.surface_normal(), Vec3::UnitY());
    }
    EXPECT_EQ(seen, std::vector<int>(photons.size(), 1));
    EXPECT_LE(map.memory(), 30 * photons.size());
}

TEST(PhotonMap, FewerEquallyManyAndMorePhotonsThanWanted) {
    for (std::size_t k : {1u, 8u, 50u})
        for (std::size_t n : {std::size_t{0}, std::size_t{1}, k - 1, k, k + 1}) {
            const PhotonMap map(random_photons(n, 3, 1.f), 1);
            expect_right_results(map, Vec3(0.5f, 0.5f, 0.5f), {0.f, 0.4f, 10.f}, {k});
        }
}

// Tree nodes have no extent, or all photons have the same distance; then the lower indices win.
TEST(PhotonMap, PhotonsAtOnePointOnALineAndDuplicated) {
    const auto random = random_photons(3001, 4, 1.f);
    auto point = random, line = random, duplicated = random, far = random, signed_zeros = random;
    for (std::size_t i = 0; i < random.size(); ++i) {
        point[i].p = Vec3(0.25f, -1.f, 3.f);
        line[i].p = Vec3(0.f, random[i].p.y(), 0.f);
        duplicated[i].p = random[i % 7].p;
        far[i].p = Vec3::Constant(1e6f) + random[i].p;  // coordinates of few distinct values
        signed_zeros[i].p = Vec3(i % 2 == 0 ? 0.f : -0.f, random[i].p.y(), i % 3 == 0 ? -0.f : 0.f);
    }
    for (const auto& photons : {point, line, duplicated, far, signed_zeros}) {
        const PhotonMap map(photons, 1);
        for (std::size_t i : {0u, 1u, 1500u, 3000u})
            expect_right_results(map, photons[i].p, {0.f, 0.1f, 1e9f}, {1, 49, 50, 2999, 3000, 3001, 3002});
    }
}

TEST(PhotonMap, QueriesFarAwayAndOfRadiusZero) {
    const auto photons = random_photons(3001, 5, 1.f);
    const PhotonMap map(photons, 1);
    for (const Vec3& p : {Vec3(1e3f, 0, 0), Vec3(-1e6f, 1e6f, 1e6f), Vec3(0, 0, 1e15f), photons[5].p})
        expect_right_results(map, p, {0.f, 1.f, 2e6f, std::numeric_limits<float>::max(), infinity}, {1, 50, 4000});
}

TEST(PhotonMap, AcceptIsAskedOnlyAboutPhotonsWithinTheBound) {
    const PhotonMap map(random_photons(20000, 6, 1.f), 1);
    Neighbours found;
    std::size_t asked = 0;
    find_nearest(
        map, Vec3(0.5f, 0.5f, 0.5f), 50, 0.2f,
        [&](const Photon& photon, float d2) {
            EXPECT_EQ(d2, squared_distance(photon.p, Vec3(0.5f, 0.5f, 0.5f)));
            EXPECT_LE(d2, 0.2f * 0.2f);
            ++asked;
            return true;
        },
        found);
    EXPECT_GE(asked, 50u);
    EXPECT_LT(asked, 500u);  // 670 lie within 0.2
}

TEST(Selection, PutsTheKthWhereSortingWould) {
    for (std::size_t n : {1u, 2u, 3u, 4u, 47u, 48u, 1000u, 30000u})
        for (int order = 0; order < 4; ++order) {
            std::vector<std::uint32_t> values(n);
            for (std::uint32_t i = 0; i < n; ++i)
                values[i] = order == 0 ? i : order == 1 ? ~i : order == 2 ? i * 2654435761u : i ^ 21845u;
            std::vector<std::uint32_t> expected = values;
            std::sort(expected.begin(), expected.end());
            for (std::size_t k : {std::size_t{0}, n / 3, n / 2, n - 1}) {
                auto selected = values;
                select_kth(selected.data(), selected.data() + k, selected.data() + n, std::identity());
                ASSERT_EQ(selected[k], expected[k]);
                EXPECT_TRUE(std::all_of(selected.begin(), selected.begin() + static_cast<std::ptrdiff_t>(k),
                                        [&](auto x) { return x < expected[k]; }));
                std::sort(selected.begin(), selected.end());
                EXPECT_EQ(selected, expected);
            }
        }
}

TEST(PhotonMap, RejectedPhotonsDoNotTakeThePlaceOfOthers) {
    auto photons = random_photons(2000, 5, 0.f);
    for (std::size_t i = 0; i < photons.size(); i += 2)
        photons[i].edges = 9;
    const PhotonMap map(photons, 1);
    std::vector<Neighbour> found;
    find_nearest(
        map, {0.5f, 0.5f, 0.f}, 50, 1.f, [](const Photon& p, float) { return p.edges < 9; }, found);
    EXPECT_EQ(found.size(), 50u);
    for (const auto& f : found)
        EXPECT_LT(map[f.index].edges, 9);
}

}  // namespace
}  // namespace gib::test::photon_map_test
