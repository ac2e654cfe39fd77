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

/// Runs of a method whose light comes in events of mean size 1.
struct Runs {
    std::vector<EnergyCurve> curves;
    std::vector<Image> images;
};

using Event = std::function<double(std::mt19937&)>;

struct Kind {
    double rate;              ///< mean number of events of a pixel and pass, or of an image and pass
    bool lights_all = false;  ///< an event lights the whole image
    Event size;
};

/// `share` is the part of the light that the method has.
Runs runs_of(const Kind& kind, int count, std::uint32_t passes, double share, std::mt19937& random) {
    Runs runs;
    const std::size_t pixels = edge * edge;
    std::poisson_distribution<int> events(kind.lights_all ? kind.rate : kind.rate * static_cast<double>(pixels));
    std::uniform_int_distribution<std::size_t> pixel(0, pixels - 1);
    for (int r = 0; r < count; ++r) {
        std::vector<double> sums(pixels, 0.0);
        double all = 0;
        EnergyCurve& curve = runs.curves.emplace_back();
        for (std::uint32_t pass = 1; pass <= passes; ++pass) {
            for (int e = events(random); e > 0; --e) {
                const double size = share * kind.size(random);
                if (kind.lights_all) all += size;
                else sums[pixel(random)] += size;
            }
            if ((pass & (pass - 1)) != 0 && pass != passes) continue;
            double sum = all;
            for (const double s : sums)
                sum += s / static_cast<double>(pixels);
            curve.push_back({pass, sum / pass});
        }
        Image& image = runs.images.emplace_back(edge, edge);
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            image.rgb[i] = static_cast<float>((all + sums[i / 3]) / passes);
    }
    return runs;
}

/// A reference of mean `energy`, whose groups scatter by 1 %.
ReferenceLayer reference_of(double energy) {
    std::vector<Image> groups;
    for (int g = 0; g < reference_groups; ++g)
        groups.push_back(constant_image(static_cast<float>(energy * (g % 2 == 0 ? 1.01 : 0.99)), edge, edge));
    return layer_of_groups(std::move(groups));
}

std::optional<EnergyTest> tested(const Runs& runs, const ReferenceLayer& reference) {
    double unmet = 0;
    for (std::size_t i = 0; i < reference.mean.rgb.size(); ++i)
        if (std::ranges::all_of(runs.images, [i](const Image& x) { return x.rgb[i] == 0.f; }))
            unmet += double{reference.mean.rgb[i]} / static_cast<double>(reference.mean.rgb.size());
    const auto footing = equal_footing(runs.images, reference, reference.mean);
    return energy_test(runs.curves, runs.images, reference, *footing, unmet, 1e-4);
}

double exponential(std::mt19937& random) { return std::exponential_distribution<double>(1)(random); }
double lognormal(std::mt19937& random) { return std::exp(2 * std::normal_distribution<double>()(random) - 2); }
/// Index 1.5.
double pareto(std::mt19937& random) {
    return std::pow(1 - std::uniform_real_distribution<double>(0, 1)(random), -1 / 1.5) / 3;
}
double constant(std::mt19937&) { return 1; }

TEST(EnergyTest, ThreeRunsShowALossOfThreePercent) {
    std::mt19937 random(3);
    const Kind kind{.rate = 2, .size = exponential};
    const ReferenceLayer reference = reference_of(kind.rate);
    for (const double share : {0.9, 1.0, 1.1}) {
        const auto test = tested(runs_of(kind, 3, 64, share, random), reference);
        ASSERT_TRUE(test.has_value());
        EXPECT_EQ(test->is_rejected, share != 1) << share;
        EXPECT_LE(test->excess.interval->lo, share - 1);
        EXPECT_GE(test->excess.interval->hi, share - 1);
    }
    const auto lossy = tested(runs_of({.rate = 2, .size = constant}, 3, 256, 0.97, random), reference);
    EXPECT_TRUE(lossy->is_rejected) << lossy->excess.value;
}

// Each test is at a level of 1e-4: of 12 x 100, one is rejected with a probability of 11 %, and two of 0.7 %.
TEST(EnergyTest, RareBrightLightIsNoLoss) {
    std::mt19937 random(5);
    const std::vector<Kind> kinds = {{.rate = 0.01, .size = exponential},
                                     {.rate = 0.3, .size = lognormal},
                                     {.rate = 0.3, .size = pareto},
                                     {.rate = 0.1, .lights_all = true, .size = constant},
                                     {.rate = 0.1, .lights_all = true, .size = exponential},
                                     {.rate = 1, .lights_all = true, .size = pareto}};
    int rejected = 0;
    for (const Kind& kind : kinds)
        for (const int runs : {2, 3})
            for (int i = 0; i < 100; ++i)
                if (const auto test = tested(runs_of(kind, runs, 16, 1, random), reference_of(kind.rate)))
                    rejected += test->is_rejected ? 1 : 0;
    EXPECT_LE(rejected, 1);
}

TEST(EnergyTest, ImagesThatAreAlmostAllBlackShowNothing) {
    const ReferenceLayer reference = reference_of(1);
    std::mt19937 random(1);
    Runs runs = runs_of({.rate = 1e-9, .lights_all = true, .size = constant}, 3, 4, 1, random);
    EXPECT_FALSE(tested(runs, reference).has_value()) << "all black";
    runs.images[0] = constant_image(1e-3f, edge, edge);
    runs.curves[0].back().energy = 1e-3;
    const auto test = tested(runs, reference);
    ASSERT_TRUE(test.has_value());
    EXPECT_FALSE(test->is_rejected);
    EXPECT_GT(test->excess.interval->hi, -1 + 1e-3);
}

}  // namespace
}  // namespace gib::test::energy_test_test
