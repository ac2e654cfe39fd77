// Connections to the light paths of a group of pixels, on numbers that stand for vertices.

#include "methods/parts/vertices/shared_vertices.h"
#include "methods/parts/vertices/connections.h"
#include "tests/support/moments.h"

#include <gtest/gtest.h>
#include <cmath>
#include <random>

namespace gib::test::shared_vertices_test {
namespace {

/// A connection makes nothing for four of five pairs, as behind a door, and else a lognormal number. Vertices keep their factor
/// for all walks, so that there is something to learn.
struct Vertex {
    double factor;
};

class Groups {
public:
    /// One group of `paths` light paths with up to three vertices, and of as many walks: the differences between what the walks are
    /// given and the mean over the light paths.
    double error(std::size_t paths) {
        SharedVertices<Vertex> shared;
        std::vector<Vertex> all;
        for (std::size_t i = 0; i < paths; ++i) {
            shared.begin_path();
            for (int count = std::uniform_int_distribution(0, 3)(random_); count > 0; --count) {
                all.push_back({hidden(0.6) ? 0 : std::exp(1.5 * normal_(random_))});
                shared.add(all.back());
            }
        }
        double error = 0;
        for (std::size_t walk = 0; walk < paths; ++walk) {
            std::vector<double> made;
            for (const Vertex& vertex : all)
                made.push_back(hidden(0.5) ? 0 : vertex.factor * std::exp(normal_(random_)));
            double exact = 0, given = 0;
            for (const double c : made)
                exact += c / static_cast<double>(paths);
            const Sampler sampler(PointSet::independent, 1, next_++, 0);
            NumberStream u(sampler);
            shared.join_first(u, [&](const Vertex& vertex, double factor) {
                const double c = made[static_cast<std::size_t>(&vertex - shared.path(0).data())];
                given += factor * c;
                return c;
            });
            error += given - exact;
        }
        return error;
    }

private:
    bool hidden(double probability) { return std::bernoulli_distribution(probability)(random_); }

    std::mt19937_64 random_{5};
    std::normal_distribution<double> normal_;
    std::uint64_t next_ = 0;
};

// Student's t at alpha = 1e-4, both sides. With a factor of 1.05 in the estimate it is 5 and 9 for 16 and 40 light paths.
TEST(SharedVertices, GiveTheMeanOverAllLightPaths) {
    for (const std::size_t paths : {1u, 3u, 16u, 40u}) {
        Groups groups;
        Moments errors;
        for (int i = 0; i < 20000; ++i)
            errors.add(groups.error(paths));
        EXPECT_LE(std::abs(errors.mean()), 3.89 * errors.standard_error()) << paths << " light paths";
    }
}

TEST(SharedVertices, KeepTheVerticesOfEachPath) {
    SharedVertices<Vertex> shared;
    shared.begin_path();
    shared.begin_path();
    shared.add({1});
    shared.add({2});
    EXPECT_TRUE(shared.path(0).empty());
    EXPECT_EQ(shared.path(1).size(), 2u);
    shared.clear();
    shared.begin_path();
    shared.add({3});
    ASSERT_EQ(shared.path(0).size(), 1u);
    EXPECT_EQ(shared.path(0)[0].factor, 3);
}

// Over all random starts, each connection survives with the probability size / least: the starts at which it does so are an
// interval of this length. The number of survivors is within 1 of its mean at every start.
TEST(ConnectionRoulette, KeepsEachConnectionsMeanAndTheirNumber) {
    constexpr std::array sizes = {0.002, 0.3, 0.9, 2.5, 0.0, 0.05, 0.7, 1.0, 0.4};
    constexpr double least = 1, small = 0.002 + 0.3 + 0.9 + 0.05 + 0.7 + 0.4;
    constexpr int starts = 10000;
    std::array<double, sizes.size()> means = {};
    for (int i = 0; i < starts; ++i) {
        ConnectionRoulette roulette(least, (static_cast<float>(i) + 0.5f) / starts);
        int survivors = 0;
        for (std::size_t k = 0; k < sizes.size(); ++k) {
            const double survival = roulette.survival(sizes[k]);
            if (!(survival > 0)) continue;
            means[k] += sizes[k] / survival / starts;
            survivors += sizes[k] < least ? 1 : 0;
        }
        EXPECT_LT(std::abs(survivors - small), 1) << i;
    }
    for (std::size_t k = 0; k < sizes.size(); ++k)
        EXPECT_NEAR(means[k], sizes[k], 3. / starts) << k;
}

}  // namespace
}  // namespace gib::test::shared_vertices_test
