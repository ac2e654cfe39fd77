// The test of a mean energy against the reference's: it finds a small loss from three runs, and accuses no right method whose
// light is rare.
#include "experiments/metrics/energy_test.h"

#include "tests/support/constant_image.h"

#include <gtest/gtest.h>
#include <cmath>
#include <functional>
#include <random>

namespace gib::test::energy_test_test {
namespace {

constexpr int edge = 16;
constexpr double alpha = 1e-4;
using Event = std::function<double(std::mt19937&)>;

/// The light of a method: in each pixel a plenty of samples of mean `regular`, and rare events.
struct Kind {
    double regular = 0;
    double rate = 0;  ///< mean number of events of a pixel and pass
    Event size = [](std::mt19937&) { return 1.; };
    double mean = 1;  ///< of an event

    double energy() const { return regular + rate * mean; }
};

double exponential(std::mt19937& random) { return std::exponential_distribution<double>(1)(random); }
double lognormal(std::mt19937& random) { return std::exp(2 * std::normal_distribution<double>()(random) - 2); }
/// Index 1.5, mean 1.
double pareto(std::mt19937& random) {
    return std::pow(1 - std::uniform_real_distribution<double>(0, 1)(random), -1 / 1.5) / 3;
}

/// `share`: the part of the light that the method has.
std::vector<Image> images_of(const Kind& kind, int count, std::uint32_t passes, double share, std::mt19937& random) {
    constexpr std::size_t pixels = edge * edge;
    std::poisson_distribution<int> events(kind.rate * static_cast<double>(pixels));
    std::uniform_int_distribution<std::size_t> pixel(0, pixels - 1);
    std::vector<Image> images;
    for (int r = 0; r < count; ++r) {
        std::vector<double> sums(pixels, 0.0);
        for (std::uint32_t pass = 0; pass < passes; ++pass) {
            if (kind.regular > 0)
                for (double& sum : sums)
                    sum += share * kind.regular * exponential(random);
            for (int e = events(random); e > 0; --e)
                sums[pixel(random)] += share * kind.size(random);
        }
        Image& image = images.emplace_back(edge, edge);
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            image.rgb[i] = static_cast<float>(sums[i / 3] / passes);
    }
    return images;
}

/// A reference of mean `energy`, whose groups scatter by 1 %.
ReferenceLayer reference_of(double energy) {
    std::vector<Image> groups;
    for (int g = 0; g < reference_groups; ++g)
        groups.push_back(constant_image(static_cast<float>(energy * (g % 2 == 0 ? 1.01 : 0.99)), edge, edge));
    return layer_of_groups(std::move(groups));
}

std::optional<EnergyTest> tested(const std::vector<Image>& images, const SampledLight& sampled,
                                 const ReferenceLayer& reference) {
    double unsampled = 0;
    for (std::size_t i = 0; i < reference.mean.rgb.size(); ++i)
        if (std::ranges::all_of(images, [i](const Image& x) { return x.rgb[i] == 0.f; }))
            unsampled += double{reference.mean.rgb[i]} / static_cast<double>(reference.mean.rgb.size());
    const auto balance = energy_balance(images, reference, reference.mean);
    return energy_test(images, sampled, reference, *balance, unsampled, alpha);
}

TEST(EnergyTest, ThreeRunsShowALossOfThreePercent) {
    std::mt19937 random(3);
    const Kind kind{.regular = 1};
    const ReferenceLayer reference = reference_of(1);
    const SampledLight sampled{.passes = 256, .brightest = 20};
    for (const double share : {0.9, 0.97, 1.0}) {
        const auto test = tested(images_of(kind, 3, 256, share, random), sampled, reference);
        ASSERT_TRUE(test.has_value());
        EXPECT_EQ(test->is_rejected, share != 1) << share;
        EXPECT_LE(test->excess.interval->lo, share - 1);
        EXPECT_GE(test->excess.interval->hi, share - 1);
    }
}

// Right methods, each with light that its samples seldom find: half of the energy comes from events as bright as `brightest`, or from
// events with heavy tails. Each test is at a level of 1e-4: of 6 x 2 x 200, two are rejected with a probability of 2.5 %.
TEST(EnergyTest, RareBrightLightIsNoLoss) {
    std::mt19937 random(5);
    const auto bright = [](double size) { return [size](std::mt19937&) { return size; }; };
    std::vector<Kind> kinds = {
        {.rate = 0.01, .size = exponential}, {.rate = 0.3, .size = lognormal}, {.rate = 0.3, .size = pareto}};
    // 0.5, 2 or 6 events are expected in three images of 16 passes.
    for (const double expected : {0.5, 2., 6.}) {
        const double rate = expected / (3 * 16 * edge * edge);
        kinds.push_back({.regular = 1, .rate = rate, .size = bright(1 / rate), .mean = 1 / rate});
    }
    int rejected = 0;
    for (const Kind& kind : kinds)
        for (const int runs : {2, 3})
            for (int i = 0; i < 200; ++i) {
                const SampledLight sampled{.passes = 16, .brightest = std::max(kind.mean, 1.)};
                const auto test = tested(images_of(kind, runs, 16, 1, random), sampled, reference_of(kind.energy()));
                rejected += test && test->is_rejected ? 1 : 0;
            }
    EXPECT_LE(rejected, 1);
}

TEST(EnergyTest, NeedsABoundOfWhatASampleFinds) {
    std::mt19937 random(1);
    const auto images = images_of({.regular = 1}, 3, 256, 0.9, random);
    EXPECT_FALSE(tested(images, {.passes = 256}, reference_of(1)).has_value());
    const SampledLight sun{.passes = 256, .brightest = 1e6};
    EXPECT_FALSE(tested(images, sun, reference_of(1))->is_rejected);
}

TEST(EnergyTest, ImagesThatAreAlmostAllBlackShowNothing) {
    const ReferenceLayer reference = reference_of(1);
    const SampledLight sampled{.brightest = 1e3};
    EXPECT_FALSE(tested(std::vector<Image>(3, constant_image(0.f, edge, edge)), sampled, reference).has_value());
    const std::vector<Image> dim = {constant_image(1e-3f, edge, edge), constant_image(0.f, edge, edge),
                                    constant_image(0.f, edge, edge)};
    const auto test = tested(dim, sampled, reference);
    ASSERT_TRUE(test.has_value());
    EXPECT_FALSE(test->is_rejected);
    EXPECT_GT(test->excess.interval->hi, 0);
}

}  // namespace
}  // namespace gib::test::energy_test_test
