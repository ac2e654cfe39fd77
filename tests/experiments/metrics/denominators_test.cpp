// Errors by a reference whose noise is skewed: rare bright hits, as paths through glass make them, are in few pixels of few groups.
// Everything about the references is known here, so that what is claimed can be compared with what is true.
#include "experiments/metrics/denominators.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/metrics/statistics.h"

#include "common/core/math.h"
#include "tests/support/moments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace gib::test::denominators_test {
namespace {

using Random = std::mt19937_64;
constexpr int edge = 64;

/// Part of the light, which comes in this many hits a pixel of the whole reference.
struct Hits {
    double share, per_pixel;
    bool equal = true;  ///< all hits are equally bright; false: exponentially distributed
};

constexpr float lamp = 200;  ///< pixels as bright as this have no noise

/// A dark picture with lamps in it, 7 pixels apart.
Image picture_of_lamps() {
    Image image(edge, edge);
    for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x)
            image.set(static_cast<std::size_t>(y * edge + x), Color::Constant(x % 7 < 2 && y % 7 == 3 ? lamp : 0.5f));
    return image;
}

/// A grey picture: flat, or with an edge, a texture, a shadow and a lamp.
Image picture(bool flat) {
    Image image(edge, edge);
    for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x) {
            float value = 0.3f + 0.7f * static_cast<float>(y) / edge;
            if ((x / 4 + y / 4) % 2 == 0) value *= 0.6f;
            if (std::hypot(x - 20, y - 40) < 11) value *= 0.15f;
            if (x > 58) value *= 0.02f;
            if (std::abs(x - 32) < 4 && y < 4) value = 20;
            image.set(static_cast<std::size_t>(y * edge + x), Color::Constant(flat ? 1 : value));
        }
    return image;
}

ReferenceLayer noisy(const Image& truth, const Hits& hits, Random& random) {
    std::poisson_distribution<int> count(hits.per_pixel / reference_groups);
    std::exponential_distribution<double> brightness;
    std::vector<Image> groups(reference_groups, truth);
    for (Image& group : groups)
        for (std::size_t p = 0; p < group.pixels(); ++p) {
            double bright = 0;
            for (int left = count(random); left > 0; --left)
                bright += hits.equal ? 1 : brightness(random);
            if (truth.at(p)[0] >= lamp) continue;
            const double factor = 1 - hits.share + hits.share * bright * reference_groups / hits.per_pixel;
            group.set(p, static_cast<float>(factor) * truth.at(p));
        }
    return layer_of_groups(std::move(groups));
}

/// An image whose relative error against the truth is `error`.
Image image_of(const Image& truth, double error, double epsilon) {
    Image image = truth;
    double square = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        const double r{truth.rgb[i]}, sign = i / 3 % 2 == 0 ? 1 : -1;
        image.rgb[i] = static_cast<float>(sign * r);
        square += r * r / (r * r + epsilon) / static_cast<double>(image.rgb.size());
    }
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        image.rgb[i] = truth.rgb[i] + image.rgb[i] * static_cast<float>(error / std::sqrt(square));
    return image;
}

double true_error(const ReferenceLayer& r, const Image& truth, double epsilon) {
    return std::sqrt(image_error(r.mean, {truth, std::nullopt, {}}, {truth, epsilon}).rel_mse);
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

// 4.7 to 5.3 % of 5 % is what the bench promises. The noise of the mean over 60 references, 0.1 and 0.2 % of its square, is
// a fifth of that.
TEST(SkewedNoise, LeavesTheErrorOfAnImageAsItIs) {
    for (const bool flat : {true, false})
        for (const Hits& hits : {Hits{0.1, 0.5}, Hits{0.3, 2}}) {
            Random random(1);
            const Image truth = picture(flat);
            const double epsilon = epsilon_of(std::nullopt, truth);
            const Image x = image_of(truth, 0.05, epsilon);
            Moments square, bias2;
            for (int i = 0; i < 60; ++i) {
                const ReferenceLayer r = noisy(truth, hits, random);
                const Denominators denominators(r, epsilon);
                square.add(image_error(x, r, denominators).rel_mse_corrected);
                const auto s = replicate_statistics({x, x}, r, denominators);
                EXPECT_NEAR(s.rel_mse_corrected, s.rel_bias2->value, 1e-6) << "equal images have no variance";
                bias2.add(s.rel_bias2->value);
            }
            EXPECT_GT(square.mean(), sqr(0.047)) << hits.share << (flat ? " flat" : "");
            EXPECT_LT(square.mean(), sqr(0.053)) << hits.share << (flat ? " flat" : "");
            EXPECT_NEAR(bias2.mean(), square.mean(), 1e-6);
        }
}

// The claimed error over the true one lies between 0.8 and 1.25 in the median and above 0.6 in nine of ten, down to one hit
// in twenty pixels.
TEST(SkewedNoise, IsInTheErrorThatAReferenceClaims) {
    for (const bool flat : {true, false})
        for (const Hits& hits :
             {Hits{0.1, 0.5}, Hits{0.3, 2}, Hits{1, 4}, Hits{0.5, 0.2, false}, Hits{0.2, 0.05, false}}) {
            Random random(2);
            const Image truth = picture(flat);
            const double epsilon = epsilon_of(std::nullopt, truth);
            std::vector<double> ratios;
            for (int i = 0; i < 20; ++i) {
                const ReferenceLayer r = noisy(truth, hits, random);
                ratios.push_back(relative_standard_error(r, {r, epsilon}) / true_error(r, truth, epsilon));
            }
            EXPECT_GT(median(ratios), 0.8) << hits.per_pixel << (flat ? " flat" : "");
            EXPECT_LT(median(ratios), 1.25) << hits.per_pixel << (flat ? " flat" : "");
            EXPECT_GE(std::count_if(ratios.begin(), ratios.end(), [](double ratio) { return ratio > 0.6; }), 18);
        }
}

// The lamps are no part of the picture around them, from which pixels that no path has met borrow their noise.
TEST(SkewedNoise, IsClaimedInTheLightOfLampsInView) {
    Random random(5);
    const Image truth = picture_of_lamps();
    std::vector<double> ratios;
    for (int i = 0; i < 20; ++i) {
        const ReferenceLayer r = noisy(truth, {0.7, 3}, random);
        ratios.push_back(relative_standard_error(r, {r, 1e-3}) / true_error(r, truth, 1e-3));
    }
    EXPECT_GT(median(ratios), 0.8);
    EXPECT_LT(median(ratios), 1.25);
}

// The error's own uncertainty: the estimates of 100 references scatter by what each says of itself, within a factor that 100
// values of a heavy tail leave open. One group that holds a firefly of ten thousand is as uncertain as it is large.
TEST(SkewedNoise, IsInTheUncertaintyOfTheError) {
    Random random(3);
    const Image truth = picture(false);
    const double epsilon = epsilon_of(std::nullopt, truth);
    Moments value, variance;
    for (int i = 0; i < 100; ++i) {
        const ReferenceLayer r = noisy(truth, {0.5, 0.2, false}, random);
        const SampleMean error2 = Denominators(r, epsilon).variance_of(r);
        value.add(error2.value);
        variance.add(error2.variance.variance);
    }
    const double scatter = value.standard_error() * std::sqrt(100.0);
    EXPECT_NEAR(std::log(std::sqrt(variance.mean()) / scatter), 0, std::log(1.5));
    ReferenceLayer r = noisy(truth, {0.1, 100}, random);
    r.groups[3].rgb[300] += 1e4f;
    r = layer_of_groups(std::move(r.groups));
    const SampleMean error2 = Denominators(r, epsilon).variance_of(r);
    EXPECT_NEAR(std::sqrt(error2.variance.variance) / error2.value, 0.93, 0.05);
}

TEST(Denominators, AreThePlainOnesWithoutNoise) {
    const Image truth = picture(false);
    const ReferenceLayer r = layer_of_groups(std::vector<Image>(reference_groups, truth));
    const double epsilon = epsilon_of(std::nullopt, truth);
    const Denominators denominators(r, epsilon);
    EXPECT_EQ(denominators.smooth().rgb, truth.rgb);
    EXPECT_EQ(relative_standard_error(r, denominators), 0);
    const ImageError e = image_error(image_of(truth, 0.05, epsilon), r, denominators);
    EXPECT_NEAR(e.rel_mse, 0.0025, 1e-7);
    EXPECT_NEAR(e.rel_mse_corrected, e.rel_mse, 1e-9);
}

}  // namespace
}  // namespace gib::test::denominators_test
