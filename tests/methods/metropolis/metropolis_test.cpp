// Metropolis light transport: chains in primary sample space have the distribution that they should, and images have the
// means of bidirectional path tracing, however few steps a chain takes.

#include "methods/metropolis/primary_sample.h"
#include "tests/support/lit_rooms.h"
#include "tests/support/same_means.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace gib::test::metropolis_test {
namespace {

using namespace lit_rooms;

/// A number of a state; a proposal has fresh numbers of its own.
float number(PrimarySample& sample, std::uint32_t proposal, std::uint32_t block, std::uint64_t seed = 1) {
    return sample.block(5, block, Sampler(PointSet::independent, seed, block, proposal).at_vertex(0).all())[3];
}

TEST(PrimarySample, IsWhatItWasAfterARejectedStep) {
    for (const bool is_large : {false, true}) {
        PrimarySample sample;
        const float kept = number(sample, 0, 0);
        sample.accept();
        sample.propose(is_large);
        EXPECT_NE(number(sample, 1, 0), kept);
        const float new_block = number(sample, 1, 1);
        sample.reject();
        EXPECT_EQ(number(sample, 1, 0), kept);
        // Numbers that only a rejected step has seen are forgotten.
        sample.propose(false);
        EXPECT_GT(std::abs(number(sample, 2, 1) - new_block), 1.f / 64);
    }
}

TEST(PrimarySample, SmallStepsHaveTheLengthsOfKelemen) {
    PrimarySample sample;
    double below_the_middle = 0;
    constexpr std::uint32_t steps = 20000;
    for (std::uint32_t i = 0; i < steps; ++i) {
        const float before = number(sample, i, 0);
        sample.accept();
        sample.propose(false);
        float step = std::abs(number(sample, i + 1, 0) - before);
        step = std::min(step, 1 - step);
        EXPECT_GE(step, 0.99f / 1024);
        EXPECT_LE(step, 1.01f / 64);
        if (step < 1.f / 256) ++below_the_middle;  // the geometric mean of both limits
    }
    // Half of the lengths are shorter, within four standard deviations.
    EXPECT_NEAR(below_the_middle / steps, 0.5, 4 * 0.5 / std::sqrt(steps));
}

// A Metropolis chain for the density 2 u of one number, while the other numbers of its states are read every third step only:
// the number of states in each of eight parts of [0, 1) against their probabilities, by the means of 64 chains.
TEST(PrimarySample, ChainsSampleAGivenDensity) {
    constexpr int chains = 64, steps = 4000, parts = 8;
    std::array<double, parts> mean{}, mean_of_squares{};
    for (int chain = 0; chain < chains; ++chain) {
        PrimarySample sample;
        const auto seed = static_cast<std::uint64_t>(chain);
        std::array<double, parts> share{};
        float u = number(sample, 0, 0, seed);
        sample.accept();
        for (std::uint32_t step = 0; step < steps; ++step) {
            const Vec2 choice = Sampler(PointSet::independent, seed, 7, step).get_2d(0);
            sample.propose(choice.x() < 0.3f);
            const float next = number(sample, step + 1, 0, seed);
            if (step % 3 == 0) number(sample, step + 1, 1, seed);
            if (choice.y() < next / u) {
                sample.accept();
                u = next;
            } else {
                sample.reject();
                ASSERT_EQ(number(sample, step + 1, 0, seed), u);
            }
            share[static_cast<std::size_t>(u * parts)] += 1. / steps;
        }
        for (std::size_t i = 0; i < parts; ++i) {
            mean[i] += share[i] / chains;
            mean_of_squares[i] += share[i] * share[i] / chains;
        }
    }
    for (std::size_t i = 0; i < parts; ++i) {
        const double expected = (2 * static_cast<double>(i) + 1) / (parts * parts);
        const double error = std::sqrt((mean_of_squares[i] - mean[i] * mean[i]) / (chains - 1));
        EXPECT_NEAR(mean[i], expected, 4 * error) << "part " << i;
    }
}

const std::vector<std::string> both = {"bidirectional", "metropolis", "metropolis large_steps=0.05"};

TEST(Metropolis, AgreesWithBidirectional) {
    expect_same_means(room_xml({.light = lamp}), both);
    expect_same_means(room_xml({.light = lamp, .ball = glass_ball}), both);
    expect_same_means(room_xml({.light = lit_rooms::point, .filter = "gaussian", .ball = diffuse_ball}), both);
}
// Nearly all starts behind the door are dark, and in an image of one pixel a pass has one. What its large steps find counts
// nevertheless; without them the image would be 9 % too dark.
TEST(Metropolis, AgreesWhereManyPassesStartInTheDark) {
    expect_same_means(shipped_scene("door-ajar.xml", {{}, std::pair{1, 1}}),
                      {"bidirectional", "metropolis large_steps=1"}, 8192);
}
TEST(Metropolis, AgreesInFogAndUnderTheSky) {
    expect_same_means(room_xml({.light = lamp, .more = fog}), both);
    expect_same_means(room_xml({.light = sky + lamp}), both);
}
TEST(Metropolis, AgreesForALensAndAnOrthographicCamera) {
    const std::string lens = test::number("aperture_radius", 0.2) + test::number("focus_distance", 2);
    expect_same_means(room_xml({.light = lamp, .sensor = "thinlens", .sensor_more = lens}), both);
    expect_same_means(room_xml({.light = lamp, .sensor = "orthographic", .filter = "tent"}), both);
}

}  // namespace
}  // namespace gib::test::metropolis_test
