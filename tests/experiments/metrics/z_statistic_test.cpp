// The z-tests of `gibench compare`: how often they reject a right image, and which differences they find.

#include "experiments/metrics/z_statistic.h"

#include "experiments/metrics/student_t.h"
#include "tests/support/constant_image.h"
#include "tests/support/matchers.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace gib::test::z_statistic_test {
namespace {

using Random = std::mt19937_64;

/// A scene as images: the true radiance of every pixel, and the distribution of its noise.
struct Truth {
    int width = 64, height = 64;
    double noise = 0.3;            ///< relative standard deviation of the test
    double reference_noise = 0.1;  ///< relative standard deviation of the reference's mean
    bool skewed = false;           ///< rare bright paths instead of normal noise

    /// The left half is bright and the right one dark, and the channels differ in brightness. Noise is proportional
    /// to brightness, and twice as large in the upper half.
    double radiance(int x, std::size_t channel) const {
        return (x < width / 2 ? 1.0 : 0.25) * (1 + 0.5 * static_cast<double>(channel));
    }
    double relative_noise(int y, double level) const { return level * (y < height / 2 ? 2 : 1); }

    double deviation(Random& random) const {
        if (!skewed) return std::normal_distribution<double>()(random);
        // Poisson's distribution with a mean of 0.05, scaled to variance 1: skewness 4.5, kurtosis 20.
        const int hits = std::poisson_distribution<int>(0.05)(random);
        return (hits - 0.05) / std::sqrt(0.05);
    }
    /// The image whose values are value(x, y, channel).
    Image image_of(const std::function<double(int, int, std::size_t)>& value) const {
        Image result(width, height);
        std::size_t i = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (std::size_t k = 0; k < 3; ++k, ++i)
                    result.rgb[i] = static_cast<float>(value(x, y, k));
        return result;
    }
    Image image(Random& random, double level) const {
        return image_of([&](int x, int y, std::size_t k) {
            return radiance(x, k) * (1 + relative_noise(y, level) * deviation(random));
        });
    }
    Image standard_error(double level) const {
        return image_of([&](int x, int y, std::size_t k) { return radiance(x, k) * relative_noise(y, level); });
    }
    ReferenceLayer reference(Random& random) const {
        // The mean of many samples is normal, whatever the distribution of one sample.
        Truth many = *this;
        many.skewed = false;
        return {many.image(random, reference_noise), standard_error(reference_noise), {}};
    }
    ReferenceLayer test(Random& random, int replicates) const {
        if (replicates == 1) return {image(random, noise), std::nullopt, {}};
        std::vector<Image> images;
        for (int i = 0; i < replicates; ++i)
            images.push_back(image(random, noise));
        return layer_of_groups(std::move(images));
    }
};

ZTestVerdict verdict(const ReferenceLayer& x, const ReferenceLayer& r, const ZTestLimits& limits = {}) {
    return verdict_of({{"total", z_test(x, r, r.mean)}}, limits);
}

/// The bounds of a count in `trials` of probability p: counts outside have a probability below 1e-4 together.
std::pair<int, int> binomial_bounds(int trials, double p) {
    std::vector<double> probability;
    for (int k = 0; k <= trials; ++k)
        probability.push_back(std::exp(std::lgamma(trials + 1) - std::lgamma(k + 1) - std::lgamma(trials - k + 1) +
                                       k * std::log(p) + (trials - k) * std::log1p(-p)));
    int lo = 0, hi = trials;
    for (double below = probability[0]; below < 5e-5; below += probability[static_cast<std::size_t>(++lo)]) {
    }
    for (double above = probability.back(); above < 5e-5; above += probability[static_cast<std::size_t>(--hi)]) {
    }
    return {lo, hi};
}

TEST(StudentT, TailsAreThoseOfTheKnownLaws) {
    EXPECT_NEAR(student_t_tail(1, 1), 0.5, 1e-12);
    for (const double t : {0.1, 1.0, 5.0, 100.0})
        EXPECT_NEAR(student_t_tail(t, 2) / (1 - t / std::sqrt(2 + t * t)), 1, 1e-7) << t;
    EXPECT_NEAR(student_t_tail(5, std::numeric_limits<double>::infinity()) / 5.733031437583878e-7, 1, 1e-9);
    EXPECT_NEAR(student_t_tail(student_t_two_sided(1e-7, 63), 63) / 1e-7, 1, 1e-7);
    EXPECT_EQ(student_t_tail(0, 5), 1);
    EXPECT_EQ(student_t_tail(std::numeric_limits<double>::infinity(), 5), 0);
}

struct Source {
    const char* name;
    int replicates;
    bool reference_error, skewed;
};
void PrintTo(const Source& source, std::ostream* out) { *out << source.name; }

class ZTestLevel : public ::testing::TestWithParam<Source> {};

// alpha is 0.2 instead of 0.01, so that few trials are conclusive. A right program breaks the upper bound once in
// 20000 times. The test may be cautious, but the lower bound demands that it rejects sometimes.
TEST_P(ZTestLevel, NoiseAloneIsRejectedAtMostAtAlpha) {
    constexpr int trials = 150;
    constexpr double alpha = 0.2;
    Random random(12);
    Truth truth;
    truth.skewed = GetParam().skewed;
    int rejected = 0;
    for (int i = 0; i < trials; ++i) {
        ReferenceLayer r = truth.reference(random);
        if (!GetParam().reference_error) r.standard_error.reset();
        rejected += verdict(truth.test(random, GetParam().replicates), r, {alpha, 0.002}).differs;
    }
    RecordProperty("rejected", rejected);
    EXPECT_LE(rejected, binomial_bounds(trials, alpha).second);
    EXPECT_GE(rejected, GetParam().skewed ? 0 : binomial_bounds(trials, alpha / 5).first);
}

INSTANTIATE_TEST_SUITE_P(
    Sources, ZTestLevel,
    ::testing::Values(Source{"OneImage", 1, true, false}, Source{"OneImagePlainReference", 1, false, false},
                      Source{"TwoReplicates", 2, true, false}, Source{"FourReplicates", 4, true, false},
                      Source{"OneSkewedImage", 1, true, true}, Source{"OneSkewedImagePlainReference", 1, false, true},
                      Source{"FourSkewedReplicates", 4, true, true}),
    [](const auto& test) { return std::string(test.param.name); });

/// Multiplies the test image by `factor` in ten trials, always with the same noise; returns the number of rejections.
int rejections(const Truth& truth, int replicates, const std::function<double(int x, int y)>& factor) {
    Random random(3);
    int rejected = 0;
    for (int i = 0; i < 10; ++i) {
        const ReferenceLayer r = truth.reference(random);
        ReferenceLayer x = truth.test(random, replicates);
        const Image factors = truth.image_of([&](int column, int row, std::size_t) { return factor(column, row); });
        const auto change = [&](Image& image) {
            std::transform(image.rgb.begin(), image.rgb.end(), factors.rgb.begin(), image.rgb.begin(),
                           std::multiplies());
        };
        change(x.mean);
        for (Image& group : x.groups)
            change(group);
        rejected += verdict(x, r).differs;
    }
    return rejected;
}

TEST(ZTest, CatchesSmallDifferences) {
    Truth truth;
    truth.noise = 0.03;
    truth.reference_noise = 0.01;
    for (const int replicates : {1, 3}) {
        EXPECT_EQ(rejections(truth, replicates, [](int, int) { return 1.0; }), 0);
        EXPECT_EQ(rejections(truth, replicates, [](int, int) { return 0.995; }), 10);
        EXPECT_EQ(rejections(truth, replicates, [](int x, int y) { return x < 32 && y >= 32 ? 0.99 : 1.0; }), 10);
        EXPECT_EQ(rejections(truth, replicates, [](int x, int y) { return x / 8 == 5 && y / 8 == 6 ? 1.05 : 1.0; }),
                  10);
    }
}

TEST(ZTest, SaysWhereTheDifferenceIs) {
    Random random(5);
    Truth truth;
    truth.noise = 0.02;
    truth.reference_noise = 0.01;
    const ReferenceLayer r = truth.reference(random);
    ReferenceLayer x = truth.test(random, 1);
    for (int y = 48; y < 56; ++y)
        for (int column = 16; column < 24; ++column)
            x.mean.rgb[static_cast<std::size_t>(3 * (64 * y + column) + 2)] *= 0.9f;
    const ZTestVerdict v = verdict_of({{"total", z_test(r, r, r.mean)}, {"direct", z_test(x, r, r.mean)}}, {});
    const auto& blocks = v.scales[0];
    EXPECT_EQ(blocks.layer, "direct");
    EXPECT_EQ(blocks.hypotheses, 2u * 3 * 64);
    EXPECT_EQ(blocks.rejected, 1u);
    EXPECT_LT(blocks.largest.t, -10);
    EXPECT_LT(blocks.adjusted_p, 1e-6);
    EXPECT_THAT((std::array{blocks.largest.x, blocks.largest.y, blocks.largest.width, blocks.largest.height}),
                ElementsAre(16, 48, 8, 8));
    EXPECT_EQ(blocks.largest.channel, 2u);
}

// A difference that changes within the block looks like noise to a single image, but replicates show it.
TEST(ZTest, ReplicatesSeeWhatScatterHides) {
    Truth truth;
    truth.noise = 0.02;
    truth.reference_noise = 0.005;
    const auto spike = [](int x, int y) { return x == 10 && y == 50 ? 3.0 : 1.0; };
    EXPECT_EQ(rejections(truth, 1, spike), 0);
    EXPECT_EQ(rejections(truth, 4, spike), 10);
}

TEST(ZTest, MeansAgreeOnlyIfThatIsShown) {
    Random random(8);
    Truth truth;
    const auto darkened = [](ReferenceLayer layer, float factor) {
        layer.mean = mapped(layer.mean, [&](float v) { return factor * v; });
        return layer;
    };
    const ReferenceLayer noisy = truth.reference(random);
    const ZTestVerdict unknown = verdict(truth.test(random, 1), noisy);
    EXPECT_FALSE(unknown.differs);
    EXPECT_FALSE(unknown.means_agree);

    truth.noise = 0.01;
    truth.reference_noise = 0.004;
    const ReferenceLayer r = truth.reference(random);
    const ReferenceLayer x = truth.test(random, 1);
    EXPECT_TRUE(verdict(x, r).accepted());
    EXPECT_FALSE(verdict(darkened(x, 0.997f), r).means_agree);
    EXPECT_TRUE(verdict(darkened(x, 0.997f), r).differs);
    const auto means = z_test(darkened(x, 0.997f), r, r.mean).means;
    for (const MeanDeviation& mean : means) {
        ASSERT_TRUE(mean.interval);
        EXPECT_NEAR(mean.value, -0.003, 0.0005);
        EXPECT_LT(mean.interval->lo, mean.value);
        EXPECT_GT(mean.interval->hi, mean.value);
        EXPECT_NEAR(mean.reference_share, 0.14, 0.04);  // 0.4^2 / (1 + 0.4^2)
    }
}

// If the deviation is exactly the margin, agreement is claimed by mistake in at most 2.5 % of all cases in a channel.
// Only one channel deviates: the channels' noise is independent here, so three of three would hardly ever pass.
TEST(ZTest, MeansThatDeviateByTheMarginRarelyPass) {
    constexpr int trials = 300;
    Random random(9);
    Truth truth;
    truth.width = truth.height = 32;
    truth.noise = 0.015;
    truth.reference_noise = 0.005;
    int passed = 0;
    for (int i = 0; i < trials; ++i) {
        const ReferenceLayer r = truth.reference(random);
        ReferenceLayer x = truth.test(random, 1);
        for (std::size_t p = 1; p < x.mean.rgb.size(); p += 3)
            x.mean.rgb[p] *= 1.002f;
        passed += verdict(x, r).means_agree;
    }
    EXPECT_LE(passed, binomial_bounds(trials, 0.025).second);
}

TEST(ZTest, BlocksWithoutNoiseAreEqualOrNot) {
    ReferenceLayer r{Image(32, 16), Image(32, 16), {}};
    for (std::size_t i = 0; i < r.mean.rgb.size(); ++i)
        r.mean.rgb[i] = i / 3 % 32 < 16 ? 0.f : 18.4f;
    ReferenceLayer x{r.mean, std::nullopt, {}};
    EXPECT_TRUE(verdict(x, r).accepted());
    // The rounding of sums of floats is no difference.
    x.mean = mapped(x.mean, [](float v) { return 1.000002f * v; });
    EXPECT_TRUE(verdict(x, r).accepted());

    for (const bool plain_reference : {false, true}) {
        ReferenceLayer reference = r, test{r.mean, std::nullopt, {}};
        if (plain_reference) reference.standard_error.reset();
        for (int y = 8; y < 16; ++y)
            for (int column = 0; column < 8; ++column)
                test.mean.rgb[static_cast<std::size_t>(3 * (32 * y + column))] = 1e-6f;
        const ZTestVerdict v = verdict(test, reference);
        EXPECT_TRUE(v.differs);
        EXPECT_EQ(v.scales[0].rejected, 1u);
        EXPECT_LT(v.scales[0].largest.p, 1e-100);
        EXPECT_EQ(v.scales[0].largest.x, 0);
        EXPECT_EQ(v.scales[0].largest.y, 8);
    }
    // If all is black, there is nothing to divide by.
    const ReferenceLayer black{Image(16, 16), std::nullopt, {}};
    EXPECT_TRUE(verdict(black, black).accepted());
    const ReferenceLayer grey{constant_image(0.5f, 16, 16), std::nullopt, {}};
    EXPECT_TRUE(verdict(grey, black).differs);
    EXPECT_FALSE(verdict(grey, black).means_agree);
}

TEST(ZTest, BlocksCoverEverySizeOnce) {
    Random random(1);
    for (const auto& [width, height] : {std::pair(1, 1), {2, 1}, {7, 3}, {8, 8}, {12, 13}, {65, 21}, {150, 90}}) {
        Truth truth;
        truth.width = width;
        truth.height = height;
        const ReferenceLayer r = truth.reference(random), x = truth.test(random, 1);
        const LayerZTest result = z_test(x, r, r.mean);
        for (std::size_t s = 0; s < scale_count; ++s) {
            std::vector<int> covered(r.mean.pixels(), 0);
            for (const BlockTest& block : result.tests[s]) {
                EXPECT_TRUE(block.p >= 0 && block.p <= 1);
                EXPECT_TRUE(s > 0 || width < 8 || (block.width >= 6 && block.width <= 11)) << width;
                for (int y = block.y; y < block.y + block.height; ++y)
                    for (int column = block.x; column < block.x + block.width; ++column)
                        ++covered[static_cast<std::size_t>(y * width + column)];
            }
            EXPECT_THAT(covered, Each(3)) << width << " x " << height << ", " << scale_names[s];
        }
        EXPECT_TRUE(verdict(r, r).accepted());
        EXPECT_TRUE(verdict({r.mean, std::nullopt, {}}, r).accepted());
        // The noise of a single pixel is unknown.
        EXPECT_EQ(result.means[0].interval.has_value(), width * height > 1);
    }
}

// Each 4 x 4 pixels get the same noise, as from photons that they share. If they counted as independent, the means of
// 8 x 8 blocks would seem to scatter four times too much.
TEST(ZTest, ReplicatesTellNoiseThatPixelsShare) {
    Random random(21);
    Truth truth;
    const auto shared_image = [&] {
        Truth coarse = truth;
        coarse.width = coarse.height = 16;
        const Image small = coarse.image(random, truth.noise);
        Image image(64, 64);
        for (std::size_t p = 0; p < image.pixels(); ++p)
            image.set(p, small.at(p / 64 / 4 * 16 + p % 64 / 4));
        return image;
    };
    constexpr int trials = 100;
    int rejected = 0;
    for (int i = 0; i < trials; ++i) {
        std::vector<Image> images;
        for (int k = 0; k < 4; ++k)
            images.push_back(shared_image());
        const ReferenceLayer x = layer_of_groups(std::move(images)), r = truth.reference(random);
        const LayerZTest result = z_test(x, r, r.mean);
        EXPECT_GT(result.shared_noise, 10);  // 16, with its uncertainty added
        EXPECT_LT(result.shared_noise, 40);
        rejected += verdict_of({{"total", result}}, {0.2, 0.002}).differs;
    }
    EXPECT_LE(rejected, binomial_bounds(trials, 0.2).second);
    EXPECT_EQ(z_test(truth.test(random, 4), truth.reference(random), truth.image(random, 0)).shared_noise, 1);
}

// Half of the noise of neighbours has opposite signs, as where samples are spread evenly over pixels. From pixels taken as independent,
// intervals of blocks would be twice too wide, and those of p are, by the surroundings, wider still.
TEST(ZTest, NineteenOfTwentyBlocksHoldZeroWhateverPixelsShare) {
    Random random(5);
    const Truth truth;
    const auto layer = [&](int replicates) {
        std::vector<Image> images;
        for (int k = 0; k < replicates; ++k) {
            Image& image = images.emplace_back(truth.image(random, 0.1));
            const Image shared = truth.image(random, 0.3);
            for (std::size_t i = 0; i < image.rgb.size(); ++i) {
                const std::size_t first = i - (i / 3 % 2) * 3;  // the same channel of the left one of two pixels
                const auto x = static_cast<int>(i / 3 % 64);
                const double noise = double{shared.rgb[first]} - truth.radiance(x - x % 2, i % 3);
                image.rgb[i] += static_cast<float>((x % 2 == 0 ? 1 : -1) * noise);
            }
        }
        return layer_of_groups(std::move(images));
    };
    int blocks = 0, holding = 0;
    for (int trial = 0; trial < 20; ++trial) {
        const ReferenceLayer x = layer(20), r = layer(16);
        const LayerZTest result = z_test(x, r, r.mean);
        for (const BlockTest& test : result.tests[0]) {
            ++blocks;
            holding += test.holds_zero;
        }
    }
    const auto [lo, hi] = binomial_bounds(blocks, 0.95);
    EXPECT_GE(holding, lo) << blocks;
    EXPECT_LE(holding, hi) << blocks;
}

}  // namespace
}  // namespace gib::test::z_statistic_test
