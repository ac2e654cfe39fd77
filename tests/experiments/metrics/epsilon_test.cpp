// The epsilon of relative errors: what it is by default, and that no relative number depends on the unit of light.

#include "experiments/metrics/epsilon.h"

#include "experiments/measuring/reference_makers.h"
#include "experiments/metrics/robust_error.h"
#include "experiments/metrics/statistics.h"

#include <gtest/gtest.h>

#include <random>

namespace gib::epsilon_test {
namespace {

constexpr int size = 16;

/// Images of radiance `mean` with noise of a fifth of it, darker from left to right, times `unit`.
std::vector<Image> images(int count, double mean, double unit, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<Image> images(static_cast<std::size_t>(count), Image(size, size));
    for (Image& image : images)
        for (std::size_t i = 0; i < image.rgb.size(); ++i) {
            const double shade = 1.0 / (1.0 + static_cast<double>(i / 3 % size));
            image.rgb[i] = static_cast<float>(unit * mean * shade * (1 + 0.2 * normal(random)));
        }
    return images;
}

/// A reference of radiance 1 and an estimated bias of 5 %, in this unit of light.
ReferenceLayer reference_in(double unit) {
    ReferenceLayer r = layer_of_groups(images(reference_groups, 1, unit, 1));
    r.bias.push_back(layer_of_groups(images(reference_groups, 0.05, unit, 2)));
    return r;
}

/// Every relative number about replicates that are 10 % too bright, in this unit of light.
std::vector<double> relative_numbers(double unit, const std::optional<double>& given = std::nullopt) {
    const ReferenceLayer r = reference_in(unit);
    const std::vector<Image> x = images(5, 1.1, unit, 3);
    const double epsilon = epsilon_of(given, r.mean);
    const ImageError single = image_error(x[0], r, r.mean, epsilon);
    const ReplicateStatistics all = replicate_statistics(x, r, r.mean, epsilon);
    const RobustError robust = robust_error(x, r.mean, r.mean, epsilon);
    return {single.rel_mse,
            single.rel_mse_corrected,
            all.rel_mse.value,
            all.rel_mse.interval->lo,
            all.rel_mse_corrected,
            all.rel_bias2->value,
            all.rel_bias2->interval->hi,
            robust.median,
            robust.trimmed,
            robust.share,
            noise_floor_of(r, r.mean, epsilon),
            relative_standard_error(r, epsilon),
            relative_bias(r, epsilon)};
}

TEST(RelativeEpsilon, IsTheSquareOfATenthOfTheMeanLuminance) {
    Image r(2, 1);
    r.set(0, Color(3, 0, 0));
    r.set(1, Color(0, 1, 2));
    const double m = (0.212671 * 3 + 0.715160 + 0.072169 * 2) / 2;
    EXPECT_NEAR(epsilon_of(std::nullopt, r), 0.01 * m * m, 1e-8);
    std::fill(r.rgb.begin(), r.rgb.end(), 1.f);
    EXPECT_NEAR(epsilon_of(std::nullopt, r), 0.01, 1e-8) << "the papers' number at a mean of 1";
    EXPECT_EQ(epsilon_of(0.25, r), 0.25) << "a number that is given is absolute";
}

// A black or an enormous reference has an epsilon within the range that every relative error can hold.
TEST(RelativeEpsilon, StaysInItsRange) {
    EXPECT_EQ(epsilon_of(std::nullopt, Image(3, 2)), smallest_epsilon);
    Image r(1, 1);
    r.set(0, Color::Constant(3e38f));
    EXPECT_EQ(epsilon_of(std::nullopt, r), largest_epsilon);
    EXPECT_EQ(epsilon_of(std::nullopt, Image()), smallest_epsilon);
}

TEST(RelativeEpsilon, MakesEveryRelativeNumberTheSameInAnyUnitOfLight) {
    const std::vector<double> expected = relative_numbers(1);
    for (const double unit : {1e-12, 1e-4, 1e6}) {
        const std::vector<double> found = relative_numbers(unit);
        ASSERT_EQ(found.size(), expected.size());
        // Roundings of floats are all that differs.
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_NEAR(found[i], expected[i], 1e-5 * std::abs(expected[i]) + 1e-9) << "number " << i << ", " << unit;
    }
    EXPECT_LT(relative_numbers(1e-4, 0.01)[0], 1e-3 * expected[0])
        << "an absolute epsilon hides a dark picture's error";
}

// The pilot of a reference shares the time alike in any unit of light.
TEST(RelativeEpsilon, GivesMakersTheSameSharesInAnyUnitOfLight) {
    const auto plan = [](double unit) {
        std::vector<MakerPilot> pilots(2);
        for (std::size_t m = 0; m < 2; ++m) {
            for (const Component c : {Component::direct, Component::caustic}) {
                const bool better = (c == Component::caustic) == (m == 1);
                const auto noisy = images(4, better ? 1 : 1.01, unit, 10 * m + static_cast<std::uint64_t>(c));
                pilots[m].groups.resize(4);
                for (std::size_t g = 0; g < 4; ++g) {
                    pilots[m].groups[g].width = pilots[m].groups[g].height = size;
                    pilots[m].groups[g][c] = noisy[g];
                }
            }
            pilots[m].passes = 1;
            pilots[m].work = 1 + static_cast<double>(m);
        }
        return plan_of_least_variance({"a", "b"}, pilots, std::nullopt);
    };
    const MakerPlan bright = plan(1), dark = plan(1e-4);
    for (std::size_t m = 0; m < 2; ++m) {
        EXPECT_EQ(dark.shares[m].passes, bright.shares[m].passes);
        for (std::size_t c = 0; c < component_count; ++c)
            EXPECT_NEAR(dark.shares[m].weights[c], bright.shares[m].weights[c], 1e-4);
    }
    EXPECT_NEAR(dark.error2_work / bright.error2_work, 1, 1e-4);
}

}  // namespace
}  // namespace gib::epsilon_test
