// Non-local means: laws that hold whatever the image, with noise whose weights are known.

#include "common/images/non_local_means.h"

#include "common/core/parallel.h"
#include "tests/support/constant_image.h"
#include "tests/support/moments.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gib::test::non_local_means_test {
namespace {

constexpr int size = 32;

ComponentImages of_direct(Image image) {
    ComponentImages images{.width = image.width, .height = image.height, .parts = {}};
    images[Component::direct] = std::move(image);
    return images;
}

/// The mean of n numbers of the exponential distribution with this mean: the noise is skewed.
float skewed(Random& u, float mean, int n) {
    double sum = 0;
    for (int i = 0; i < n; ++i)
        sum -= std::log(1 - double{u.next()});
    return mean * static_cast<float>(sum / n);
}

/// A half of 4 passes, with noise around the truth.
HalfImage noisy_half(const Image& truth, Random& u) {
    std::array<Image, 2> parts = {truth, truth};
    Image mean = truth;
    for (std::size_t i = 0; i < truth.rgb.size(); ++i) {
        for (Image& part : parts)
            part.rgb[i] = skewed(u, truth.rgb[i], 2);
        mean.rgb[i] = 0.5f * (parts[0].rgb[i] + parts[1].rgb[i]);
    }
    return {of_direct(mean), variance_of_mean(parts[0], 2, parts[1], 2), 4};
}

std::array<HalfImage, 2> noisy_halves(const Image& truth, std::uint64_t seed) {
    Random u(seed);
    HalfImage first = noisy_half(truth, u), second = noisy_half(truth, u);
    return {std::move(first), std::move(second)};
}

/// Features without noise: a depth of 1, and this albedo.
std::array<FeatureImages, 2> features_of(const Image& albedo) {
    const Image black(albedo.width, albedo.height);
    const FeatureImages features{albedo, black, constant_image(1, albedo.width, albedo.height)};
    return {features, features};
}

/// value_of(x) in each row.
template <typename ValueOf>
Image columns(const ValueOf& value_of) {
    Image image(size, size);
    for (int i = 0; i < size * size; ++i)
        image.set(static_cast<std::size_t>(i), Color::Constant(value_of(i % size)));
    return image;
}

/// The variance of a pixel that is at least `margin` away from the border, over seeds and pixels.
double variance_inside(const NonLocalMeansSettings& settings, const std::array<FeatureImages, 2>* features,
                       int margin) {
    Moments squares;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const auto halves = noisy_halves(constant_image(1, size, size), seed);
        const Image image = *non_local_means(halves, features, settings)[Component::direct];
        for (int y = margin; y < size - margin; ++y)
            for (int x = margin; x < size - margin; ++x)
                squares.add(std::pow(double{image.rgb[static_cast<std::size_t>(3 * (y * size + x))]} - 1, 2));
    }
    return squares.mean();
}

constexpr double variance_of_input = 1.0 / 8;  // 8 numbers of variance 1 a pixel

// A sum of 15^2 equal terms rounds by 2^-24 of itself for each.
TEST(NonLocalMeans, AConstantImageStaysConstant) {
    constexpr float rounding = 0.7f * 225 * 0x1p-24f;
    HalfImage half{of_direct(constant_image(0.7f, 9, 5)), Image(9, 5), 4};
    half.mean[Component::caustic] = Image(9, 5);
    const ComponentImages image = non_local_means({half, half}, nullptr);
    for (const float v : image[Component::direct]->rgb)
        ASSERT_NEAR(v, 0.7f, rounding);
    EXPECT_EQ(image[Component::caustic]->rgb, Image(9, 5).rgb);
    EXPECT_FALSE(image[Component::emission]);
}

// Where color accepts everything, each half is the mean of the (2 r + 1)^2 pixels around, whose noise is independent.
TEST(NonLocalMeans, EqualWeightsDivideTheVarianceByTheNumberOfPixels) {
    const double variance = variance_inside({.search_radius = 2, .k = 1e4f}, nullptr, 2);
    EXPECT_NEAR(variance * 25 / variance_of_input, 1, 0.15);
}

// An albedo that grows by s a column has the slope s^2, so that a pixel dx columns away has the weight exp(-(dx / k)^2): the
// variance falls by sum w^2 / (sum w)^2.
TEST(NonLocalMeans, KnownWeightsOfFeaturesDivideTheVarianceAsTheyShould) {
    constexpr float k = 2;
    const auto features = features_of(columns([](int x) { return 0.1f * static_cast<float>(x); }));
    double sum = 0, squares = 0;
    for (int dx = -5; dx <= 5; ++dx) {
        const double w = std::pow(1 - dx * dx / double{k * k} / 16, 16);
        sum += 11 * w;
        squares += 11 * w * w;
    }
    const double variance = variance_inside({.search_radius = 5, .k = 1e4f, .k_feature = k}, &features, 6);
    EXPECT_NEAR(variance / (squares / (sum * sum) * variance_of_input), 1, 0.25);
}

// The edge is lower than the noise: color alone blurs it, an albedo does not.
TEST(NonLocalMeans, AnEdgeOfFeaturesStays) {
    const auto edge = [](int x) { return x < size / 2 ? 1.f : 1.2f; };
    const auto halves = noisy_halves(columns(edge), 3);
    const auto features = features_of(columns(edge));
    const auto height_of_edge = [&](const std::array<FeatureImages, 2>* guide) {
        const Image image = *non_local_means(halves, guide)[Component::direct];
        double difference = 0;
        for (int y = 0; y < size; ++y)
            difference += double{image.at(static_cast<std::size_t>(y * size + size / 2)).mean()} -
                          double{image.at(static_cast<std::size_t>(y * size + size / 2 - 1)).mean()};
        return difference / size;
    };
    EXPECT_NEAR(height_of_edge(&features), 0.2, 0.05);
    EXPECT_LT(height_of_edge(nullptr), 0.1);
}

// Noise that chose its own neighbours would make the image darker: of skewed noise most values lie below the mean. The mean over an image
// is a number for each seed; 3.29 standard errors are exceeded with a probability of 0.1 %.
TEST(NonLocalMeans, TheMeanOfSkewedNoiseStays) {
    Moments means;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const Image image =
            *non_local_means(noisy_halves(constant_image(1, size, size), seed), nullptr)[Component::direct];
        double sum = 0;
        for (const float v : image.rgb)
            sum += double{v};
        means.add(sum / static_cast<double>(image.rgb.size()));
    }
    EXPECT_NEAR(means.mean(), 1, 3.29 * means.standard_error());
    EXPECT_LT(means.standard_error(), 0.002);
}

TEST(NonLocalMeans, ComponentsAddUpToTheFilteredSum) {
    auto halves = noisy_halves(columns([](int x) { return x < 20 ? 1.f : 3.f; }), 5);
    auto sums = halves;
    for (std::size_t h : {0, 1}) {
        halves[h].mean[Component::indirect] =
            mapped(*sums[h].mean[Component::direct], [](float v) { return 0.25f * v; });
        sums[h].mean[Component::direct] = halves[h].mean.total();
    }
    const Image parts = non_local_means(halves, nullptr).total();
    const Image whole = non_local_means(sums, nullptr).total();
    for (std::size_t i = 0; i < whole.rgb.size(); ++i)
        ASSERT_NEAR(parts.rgb[i], whole.rgb[i], 1e-5f * whole.rgb[i]);
}

TEST(NonLocalMeans, ThreadsChangeNothing) {
    const auto halves = noisy_halves(columns([](int x) { return static_cast<float>(1 + x % 7); }), 7);
    const auto features = features_of(columns([](int x) { return 0.1f * static_cast<float>(x % 5); }));
    std::vector<std::vector<float>> images;
    for (const int threads : {1, 2, 3})
        with_threads(threads, [&] { images.push_back(non_local_means(halves, &features)[Component::direct]->rgb); });
    EXPECT_EQ(images[0], images[1]);
    EXPECT_EQ(images[0], images[2]);
}

// No verdict depends on the unit of light.
TEST(NonLocalMeans, TheUnitOfLightChangesNothing) {
    const auto halves = noisy_halves(columns([](int x) { return x < 9 ? 0.f : 1.f; }), 9);
    auto brighter = halves;
    for (HalfImage& half : brighter) {
        half.mean[Component::direct] = mapped(*half.mean[Component::direct], [](float v) { return 1024 * v; });
        half.variance = mapped(half.variance, [](float v) { return 1024 * 1024 * v; });
    }
    const Image image = *non_local_means(halves, nullptr)[Component::direct];
    const Image bright = *non_local_means(brighter, nullptr)[Component::direct];
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        ASSERT_NEAR(bright.rgb[i], 1024 * image.rgb[i], 1e-3f * 1024 * image.rgb[i]);
}

}  // namespace
}  // namespace gib::test::non_local_means_test
