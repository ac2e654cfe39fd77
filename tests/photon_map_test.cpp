#include "methods/photon_map.h"
#include "common/parallel.h"
#include "tests/scene_fixtures.h"

#include <algorithm>
#include <numeric>

namespace gib {
namespace {

using test::scene_of;

std::vector<Photon> random_photons(std::size_t n, std::uint64_t seed, float z_extent) {
    std::vector<Photon> photons(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Sampler u(PointSet::independent, seed, i, 0);
        const Vec2 xy = u.get_2d(0);
        photons[i] = {Vec3(xy.x(), xy.y(), z_extent * u.get_1d(1)), Color::Ones(), encode_direction(Vec3(0, 0, 1)),
                      encode_normal(Vec3(0, 0, 1)), 2};
    }
    return photons;
}

const auto accept_all = [](const Photon&, float) { return true; };

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

TEST(PhotonMap, FindsTheSameNeighboursAsASearchOverAll) {
    for (std::size_t n : {0u, 1u, 7u, 8u, 9u, 1000u, 5003u}) {
        const PhotonMap map(random_photons(n, n, 1.f));
        ASSERT_EQ(map.size(), n);
        std::vector<PhotonMap::Neighbour> found, all(n);
        for (std::uint64_t q = 0; q < 40; ++q) {
            const Sampler u(PointSet::independent, 99, q, 0);
            const Vec3 p(2 * u.get_1d(0) - 0.5f, u.get_1d(1), u.get_1d(2));
            for (std::size_t k : {1u, 5u, 50u, 300u})
                for (float r : {0.05f, 0.3f, 10.f}) {
                    map.nearest(p, k, r, accept_all, found);
                    std::vector<PhotonMap::Neighbour> expected;
                    for (std::uint32_t i = 0; i < n; ++i)
                        if (const float d2 = (map[i].p - p).squaredNorm(); d2 <= r * r) expected.push_back({d2, i});
                    std::sort(expected.begin(), expected.end());
                    if (expected.size() > k) expected.resize(k);
                    if (found.size() == k) {
                        EXPECT_EQ(found.back(), expected.back());
                    }
                    std::sort(found.begin(), found.end());
                    EXPECT_EQ(found, expected) << n << ' ' << k << ' ' << r;
                }
        }
    }
}

TEST(PhotonMap, RejectedPhotonsDoNotTakeThePlaceOfOthers) {
    auto photons = random_photons(2000, 5, 0.f);
    for (std::size_t i = 0; i < photons.size(); i += 2)
        photons[i].edges = 9;
    const PhotonMap map(photons);
    std::vector<PhotonMap::Neighbour> found;
    map.nearest(
        {0.5f, 0.5f, 0.f}, 50, 1.f, [](const Photon& p, float) { return p.edges < 9; }, found);
    EXPECT_EQ(found.size(), 50u);
    for (const auto& f : found)
        EXPECT_LT(map[f.photon].edges, 9);
}

TEST(PhotonMap, IsTheSameForAnyNumberOfThreads) {
    const auto photons = random_photons(200000, 3, 1.f);
    const auto order = [&](int threads) {
        std::vector<float> xs;
        with_threads(threads, [&] {
            const PhotonMap map(photons);
            for (std::size_t i = 0; i < map.size(); ++i)
                xs.push_back(map[i].p.x());
        });
        return xs;
    };
    const auto one = order(1);
    EXPECT_EQ(one, order(2));
    EXPECT_EQ(one, order(5));
}

}  // namespace
}  // namespace gib
