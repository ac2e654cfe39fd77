// Tests of random numbers, of choices among items and of the power heuristic.

#include "common/sampling/sampler.h"
#include "common/sampling/power_heuristic.h"

#include <gtest/gtest.h>

#include <set>

namespace gib::test::sampler_test {
namespace {

TEST(Sampler, IsAPureFunctionOfItsArguments) {
    for (PointSet set : {PointSet::independent, PointSet::sobol}) {
        const Sampler a(set, 7, 123, 5), b(set, 7, 123, 5);
        EXPECT_EQ(a.get_2d(9), b.get_2d(9));
        EXPECT_EQ(a.get_2d(9), (a.get_2d(3), b.get_1d(2), a.get_2d(9)));
        EXPECT_NE(a.get_2d(9), a.get_2d(8));
        EXPECT_NE(a.get_2d(9), Sampler(set, 8, 123, 5).get_2d(9));
        EXPECT_NE(a.get_2d(9), Sampler(set, 7, 124, 5).get_2d(9));
        EXPECT_NE(a.get_2d(9), Sampler(set, 7, 123, 6).get_2d(9));
    }
}

TEST(Sampler, GivesAVertexTheNumbersOfItsDimensions) {
    for (PointSet set : {PointSet::independent, PointSet::sobol})
        for (std::uint32_t pass : {0u, 1u, 12345u, 0xffffffffu})
            for (int vertex = 0; vertex < 7; ++vertex) {
                const Sampler s(set, 7, 123, pass);
                const VertexNumbers u = s.at_vertex(vertex);
                const auto expected = [&](std::uint32_t what) { return s.get_2d(dimension::at_vertex(vertex, what)); };
                EXPECT_EQ(Vec2(u.light_choice(), u.roulette()), expected(dimension::choices));
                EXPECT_EQ(u.light_position(), expected(dimension::light_position));
                EXPECT_EQ(u.bsdf_lobe(), expected(dimension::bsdf_lobe));
                EXPECT_EQ(u.bsdf_direction(), expected(dimension::bsdf_direction));
            }
}

TEST(Sampler, GivesAStartTheNumbersOfItsDimensions) {
    struct Block : NumberStore {
        EightFloats block(std::uint64_t, std::uint32_t b, const EightFloats&) override {
            EightFloats numbers;
            for (std::size_t i = 0; i < 8; ++i)
                numbers[i] = (static_cast<float>(8 * b) + static_cast<float>(i)) / 64;
            return numbers;
        }
    } store;
    for (const Sampler& s : {Sampler(PointSet::sobol, 1, 2, 3), Sampler(PointSet::independent, 1, 2, 3),
                             Sampler(store, Sampler(PointSet::independent, 1, 2, 3))})
        for (std::uint32_t d = 0; d < 3; ++d)
            EXPECT_EQ(s.at_start()[d], s.get_2d(d)) << d;
}

// Sobol's points are a (0, 2)-sequence: every aligned run of 2^m points has one point in each elementary
// interval of area 2^-m. Owen's scrambling keeps this property, and so does the shuffling of indices,
// which permutes within aligned runs.
TEST(Sampler, SobolPointsFormNetsInEveryDimension) {
    constexpr int m = 6, n = 1 << m;
    for (std::uint64_t pixel : {0u, 1u, 77u})
        for (std::uint32_t dim : {0u, 1u, 13u})
            for (std::uint32_t first : {0u, 64u, 640u})
                for (int a = 0; a <= m; ++a) {
                    const int nx = 1 << a, ny = n / nx;
                    std::set<int> cells;
                    for (int i = 0; i < n; ++i) {
                        const Vec2 u =
                            Sampler(PointSet::sobol, 3, pixel, first + static_cast<std::uint32_t>(i)).get_2d(dim);
                        cells.insert(static_cast<int>(u.x() * static_cast<float>(nx)) * ny +
                                     static_cast<int>(u.y() * static_cast<float>(ny)));
                    }
                    EXPECT_EQ(cells.size(), static_cast<std::size_t>(n))
                        << pixel << ' ' << dim << ' ' << first << ' ' << a;
                }
}

// The mean of x y over [0,1)^2 is 1/4 for independent coordinates; the standard error of 2^20 points is 2.1e-4.
// Numbers of different dimensions or different pixels must be uncorrelated too.
TEST(Sampler, DimensionsAndPixelsAreUncorrelated) {
    constexpr int n = 1 << 20;
    for (PointSet set : {PointSet::independent, PointSet::sobol}) {
        double within = 0, across_dimensions = 0, across_pixels = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            const Sampler s(set, 1, i % 1024, i / 1024), t(set, 1, 5000 + i % 1024, i / 1024);
            const Vec2 u = s.get_2d(2);
            within += static_cast<double>(u.x() * u.y());
            across_dimensions += static_cast<double>(u.x() * s.get_2d(3).x());
            across_pixels += static_cast<double>(u.x() * t.get_2d(2).x());
        }
        // Five standard errors, six comparisons: family-wise alpha below 4e-6.
        EXPECT_NEAR(within / n, 0.25, 5 * 2.1e-4);
        EXPECT_NEAR(across_dimensions / n, 0.25, 5 * 2.1e-4);
        EXPECT_NEAR(across_pixels / n, 0.25, 5 * 2.1e-4);
    }
}

TEST(DiscreteDistribution, NeverChoosesAWeightOfZeroAndReturnsItsProbability) {
    const DiscreteDistribution d({0, 3, 0, 1, 0});
    for (float u : {0.f, 0.25f, 0.7499f, 0.7501f, 1.f - unit_roundoff}) {
        const auto c = d.sample(u);
        EXPECT_EQ(c.index, u < 0.75f ? 1u : 3u) << u;
        EXPECT_FLOAT_EQ(c.probability, c.index == 1 ? 0.75f : 0.25f);
        EXPECT_GE(c.u, 0.f);
        EXPECT_LT(c.u, 1.f);
    }
    EXPECT_EQ(d.total(), 4);
}

TEST(PowerHeuristic, WeightsOfTwoTechniquesSumToOneAtAnyMagnitude) {
    for (float a : {1e-30f, 1e-3f, 1.f, 1e30f})
        for (float b : {1e-30f, 1.f, 2.5f, 1e30f})
            EXPECT_NEAR(power_heuristic(a, b) + power_heuristic(b, a), 1.f, 1e-6f) << a << ' ' << b;
    EXPECT_EQ(power_heuristic(infinity, 3.f), 1.f);
    EXPECT_EQ(power_heuristic(0.f, 3.f), 0.f);
}

}  // namespace
}  // namespace gib::test::sampler_test
