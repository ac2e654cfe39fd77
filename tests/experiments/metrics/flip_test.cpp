// FLIP against its paper's formulas: colour differences in closed form, and the whole map by plain sums in double.

#include "experiments/metrics/flip.h"

#include "common/color/srgb.h"
#include "common/core/error.h"
#include "common/core/float_traps.h"
#include "common/core/parallel.h"
#include "experiments/results/pictures.h"
#include "tests/experiments/metrics/paper_flip.h"
#include "tests/support/constant_image.h"
#include "tests/support/input_error.h"
#include "tests/support/matchers.h"

#include <limits>
#include <random>

namespace gib::test::flip_test {
namespace {

using ::testing::FloatEq;
using ::testing::FloatNear;
using ::testing::Le;

Image constant(const Color& color, int width = 5, int height = 4) { return constant_image(color, width, height); }

/// Independent values in [0, largest).
Image random_image(int width, int height, unsigned seed, float largest = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, largest);
    Image image(width, height);
    for (float& v : image.rgb)
        v = uniform(random);
    return image;
}

TEST(Flip, EqualImagesDifferByExactlyZero) {
    const Image image = random_image(33, 17, 1);
    EXPECT_THAT(ldr_flip(image, image).values, Each(0.f));
    EXPECT_THAT(hdr_flip(image, image).values, Each(0.f));
    EXPECT_EQ(hdr_flip(image, image).mean(), 0);
}

// Black and white are 100 apart in lightness and equal in colour. Green and blue are 203.302 apart: the knee is 0.4
// of 203.302^0.7 = 41.2761, so the error is 0.95 + 0.05 (100^0.7 - 16.5104) / (41.2761 - 16.5104) = 0.967380.
TEST(Flip, BlackAgainstWhiteIsAsTheFormulasSay) {
    const FlipMap map = ldr_flip(constant({0, 0, 0}), constant({1, 1, 1}));
    EXPECT_THAT(map.values, Each(FloatNear(0.967380f, 1e-5f)));
}

TEST(Flip, ConstantColorsDifferByTheirColorErrorAtEverySize) {
    const std::vector<Color> colors = {{0, 0, 0},          {0.2f, 0.2f, 0.2f}, {0.21f, 0.2f, 0.2f},
                                       {0.9f, 0.1f, 0.3f}, {0.1f, 0.5f, 0.9f}, {0.002f, 0.004f, 0.001f}};
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 2), std::pair(40, 30)})
        for (const Color& a : colors)
            for (const Color& b : colors) {
                const double expected =
                    paper::color_error(paper::hunt_lab(a.cast<double>()), paper::hunt_lab(b.cast<double>()));
                // Equal colours have the error 0; rounding is 1e-5 of 100 in lightness, to the power 0.7.
                EXPECT_THAT(ldr_flip(constant(a, width, height), constant(b, width, height)).values,
                            Each(FloatNear(static_cast<float>(expected), 2e-4f)));
            }
}

TEST(Flip, IsThePapersMapComputedByPlainSums) {
    for (const double pixels_per_degree : {8.0, 40.0}) {
        // The cases are noise, and an image with a bright point against one with an edge: features of both kinds.
        Image smooth = constant({0.3f, 0.4f, 0.2f}, 17, 13), edge = smooth;
        for (std::size_t i = 0; i < smooth.pixels(); ++i) {
            if (i % 17 > 8) edge.set(i, {0.7f, 0.6f, 0.1f});
            if (i == 100) smooth.set(i, {1, 1, 0.8f});
        }
        const std::vector<std::pair<Image, Image>> cases = {{random_image(17, 13, 4), random_image(17, 13, 5)},
                                                            {smooth, edge}};
        for (const auto& [a, b] : cases) {
            const FlipMap map = ldr_flip(a, b, pixels_per_degree);
            const std::vector<double> expected = paper::flip(a, b, pixels_per_degree);
            for (std::size_t i = 0; i < expected.size(); ++i)
                EXPECT_NEAR(map.values[i], expected[i], 2e-4) << i << ", " << pixels_per_degree;
        }
    }
}

// 2.118872 is the root of 0.16002 x^2 - 0.2829 x - 0.119 = 0, the radiance that the curve shows as 0.85.
TEST(HdrFlip, ExposuresReachFromTheBrightestToTheMedian) {
    constexpr float shown = 2.118872f;
    EXPECT_NEAR(filmic(2.118872), 0.85, 1e-6);
    EXPECT_EQ(filmic(0), 0);
    EXPECT_EQ(filmic(1e30), 1);

    Image image = constant(Color::Constant(shown / 8), 5, 1);
    image.set(1, Color::Constant(shown * 4));
    image.set(3, Color::Constant(shown / 1024));
    image.set(4, {-1, -1, -1});
    const ExposureRange range = flip_exposures(image);
    EXPECT_NEAR(range.start, -2, 1e-5);
    EXPECT_NEAR(range.stop, 3, 1e-5);
    EXPECT_NEAR(range.at(0), -2, 1e-5);
    EXPECT_NEAR(range.at(range.count - 1), 3, 1e-5);

    // The median of an even number of pixels lies between two: (1/8 + 7/8) / 2 = 1/2.
    Image even = constant(Color::Constant(shown / 8), 4, 1);
    even.set(0, Color::Constant(shown * 3.5f));
    even.set(1, Color::Constant(shown * 7 / 8));
    const ExposureRange of_even = flip_exposures(even);
    EXPECT_NEAR(of_even.stop, 1, 1e-5);
    EXPECT_NEAR(of_even.start, -std::log2(3.5), 1e-5);
    EXPECT_EQ(of_even.count, 3) << "2.8 exposures, rounded up";

    const ExposureRange of_constant = flip_exposures(constant({1, 1, 1}));
    EXPECT_EQ(of_constant.start, of_constant.stop);
    EXPECT_EQ(of_constant.count, 2);
}

TEST(HdrFlip, DarkPixelsOfTheReferenceSetNoExposure) {
    Image mostly_black = constant({0, 0, 0}, 5, 1);
    mostly_black.set(0, {2.118872f, 2.118872f, 2.118872f});
    // 1e-9 is rounding that is left where equal components were subtracted.
    mostly_black.set(2, {1e-9f, 1e-9f, 1e-9f});
    const ExposureRange range = flip_exposures(mostly_black);
    EXPECT_NEAR(range.start, 0, 1e-5);
    EXPECT_NEAR(range.stop, 0, 1e-5);

    const Image black = constant({0, 0, 0});
    EXPECT_EQ(flip_exposures(black).start, 0);
    EXPECT_EQ(flip_exposures(black).stop, 0);
    EXPECT_THAT(hdr_flip(black, black).values, Each(0.f));
    EXPECT_THAT(hdr_flip(constant({9, 9, 9}), black).values, Each(FloatNear(0.967380f, 1e-3f)));
}

TEST(HdrFlip, IsTheLargestErrorOverTheExposures) {
    const auto bright = [](float v) { return 30 * v * v * v * v; };
    const Image test = mapped(random_image(20, 10, 8), bright), reference = mapped(random_image(20, 10, 9), bright);
    const FlipMap map = hdr_flip(test, reference);
    const ExposureRange range = flip_exposures(reference);
    ASSERT_GE(range.count, 3);
    std::vector<float> largest(map.values.size(), 0.f);
    for (int i = 0; i < range.count; ++i) {
        const auto exposed = [&](float v) { return filmic(std::exp2(range.at(i)) * static_cast<double>(v)); };
        const FlipMap shown = ldr_flip(mapped(test, exposed), mapped(reference, exposed));
        for (std::size_t p = 0; p < largest.size(); ++p)
            largest[p] = std::max(largest[p], shown.values[p]);
    }
    EXPECT_THAT(map.values, ::testing::Pointwise(FloatEq(), largest));
}

TEST(HdrFlip, WrongInputIsAnErrorThatNamesIt) {
    const FloatTrapsPaused paused;  // a NaN is passed below
    const Image image = constant({1, 1, 1});
    Image bad = image;
    bad.rgb[7] = std::numeric_limits<float>::quiet_NaN();
    const auto error = [](const Image& test, const Image& reference) {
        return input_error_of([&] { hdr_flip(test, reference); });
    };
    EXPECT_THAT(error(bad, image), HasSubstr("not finite"));
    EXPECT_THAT(error(image, bad), HasSubstr("not finite"));
    EXPECT_THAT(error(constant({1, 1, 1}, 3, 7), image), AllOf(HasSubstr("3 x 7"), HasSubstr("5 x 4")));
    EXPECT_THAT(error(Image(), Image()), HasSubstr("one pixel"));
    for (const double pixels_per_degree : {0.5, -1.0, std::nan("")})
        EXPECT_THAT(input_error_of([&] { ldr_flip(image, image, pixels_per_degree); }), HasSubstr("per degree"));
}

}  // namespace
}  // namespace gib::test::flip_test
