// Spectra of noise and of bias: noise of known spectra, masks, and patterns below the noise.
#include "experiments/metrics/spectrum.h"

#include "tests/support/constant_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace gib::test::spectrum_test {
namespace {

/// White noise after a convolution with a Gaussian (periodic), or, if `blue`, the white noise less the result.
struct Filter {
    double sigma = 0;  // [pixels]
    bool blue = false;

    std::vector<double> kernel() const {
        if (sigma == 0) return {1.0};
        std::vector<double> k;
        const int reach = static_cast<int>(std::ceil(5 * sigma));
        double sum = 0;
        for (int d = -reach; d <= reach; ++d)
            sum += k.emplace_back(std::exp(-0.5 * sqr(d / sigma)));
        for (double& v : k)
            v /= sum;
        return k;
    }
    std::vector<double> transfer(int size) const {
        const auto k = kernel();
        const int reach = static_cast<int>(k.size()) / 2;
        std::vector<double> t(static_cast<std::size_t>(size));
        for (int i = 0; i < size; ++i)
            for (int d = -reach; d <= reach; ++d)
                t[static_cast<std::size_t>(i)] +=
                    k[static_cast<std::size_t>(d + reach)] * std::cos(2 * M_PI * i * d / size);
        return t;
    }
    double power(const std::vector<double>& t, int x, int y) const {
        const double h = t[static_cast<std::size_t>(x)] * t[static_cast<std::size_t>(y)];
        return sqr(blue ? 1 - h : h);
    }
};

using Noise = std::vector<double>;

Noise draw(std::mt19937_64& random, int size, const Filter& filter) {
    std::normal_distribution<double> normal;
    Noise white(static_cast<std::size_t>(size * size));
    for (double& v : white)
        v = normal(random);
    const auto k = filter.kernel();
    const int reach = static_cast<int>(k.size()) / 2;
    const auto convolve = [&](const Noise& in, int dx, int dy) {
        Noise out(in.size());
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                for (int d = -reach; d <= reach; ++d) {
                    const int sx = (x + dx * d + size) % size, sy = (y + dy * d + size) % size;
                    out[static_cast<std::size_t>(y * size + x)] +=
                        k[static_cast<std::size_t>(d + reach)] * in[static_cast<std::size_t>(sy * size + sx)];
                }
        return out;
    };
    Noise noise = convolve(convolve(white, 1, 0), 0, 1);
    if (filter.blue)
        for (std::size_t p = 0; p < noise.size(); ++p)
            noise[p] = white[p] - noise[p];
    return noise;
}

struct Theory {
    double centroid, low_ratio;
};

Theory theory(const Filter& filter, int size) {
    const auto t = filter.transfer(size);
    double sum = 0, moment = 0, low = 0, count = 0, low_count = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            if (x == 0 && y == 0) continue;
            const double f = std::hypot(std::min(x, size - x), std::min(y, size - y)) / size;
            const double p = filter.power(t, x, y);
            sum += p;
            moment += p * f;
            count += 1;
            low += f < 0.1 ? p : 0;
            low_count += f < 0.1 ? 1 : 0;
        }
    return {moment / sum, low / sum * count / low_count};
}

using Amplitude = std::function<double(int x, int y, int size)>;
double flat(int, int, int) { return 1; }
double smooth(int x, int, int size) { return std::pow(10.0, static_cast<double>(x) / size); }  // variance times 100
double step(int x, int, int size) { return x < size / 2 ? 1 : 10; }
double black_disc(int x, int y, int size) { return std::hypot(x - size / 2, y - size / 2) < size / 5 ? 0 : 1; }

/// The grey image of value(x, y).
Image image_of(int size, const std::function<double(int, int)>& value) {
    Image image(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            image.set(static_cast<std::size_t>(y * size + x), Color::Constant(static_cast<float>(value(x, y))));
    return image;
}

/// A spectrum from `seeds` replicates; the brightness of their noise and of the reference is `amplitude`.
NoiseSpectrum measure(const Filter& filter, int size, int seeds, const Amplitude& amplitude, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const Image reference = image_of(size, [&](int x, int y) { return 5 * amplitude(x, y, size); });
    std::vector<Image> replicates;
    for (int i = 0; i < seeds; ++i) {
        const Noise noise = draw(random, size, filter);
        Image image = reference;
        for (std::size_t j = 0; j < image.rgb.size(); ++j)
            image.rgb[j] += static_cast<float>(static_cast<double>(reference.rgb[j]) / 5 * noise[j / 3]);
        replicates.push_back(image);
    }
    return noise_spectrum(replicates, reference).value();
}

TEST(NoiseSpectrum, WhiteNoiseHasTheCentroidOfTheSquareAndPowerOne) {
    for (const Amplitude& amplitude : {Amplitude(flat), Amplitude(smooth), Amplitude(step), Amplitude(black_disc)}) {
        const NoiseSpectrum s = measure({}, 128, 5, amplitude, 11);
        EXPECT_NEAR(s.centroid, 0.3826, 0.01 * 0.3826);
        // 508 frequencies from 5 seeds have a standard deviation of 4 %.
        EXPECT_NEAR(s.low_ratio, 1, 0.15);
        double power = 0, points = 0;
        for (const SpectrumPoint& p : s.curve) {
            if (p.frequency < 0.1 || p.frequency > 0.5) continue;
            power += p.power;
            points += 1;
        }
        EXPECT_NEAR(power / points, 1, 0.03);
        EXPECT_EQ(s.curve.front().frequency, 0);
        EXPECT_NEAR(s.curve.back().frequency, std::sqrt(0.5), 0.01);
    }
}

// The mean over 8 data sets of 5 seeds shows the estimator's bias; single data sets show that one
// suffices. The standard deviation of one centroid is 0.4 % (white) to 1.5 % (sigma 2): an image with so
// few areas of correlation allows no better.
TEST(NoiseSpectrum, GaussianNoiseHasItsCentroidFlatUnequalAndMasked) {
    for (const double sigma : {0.7, 1.0, 2.0})
        for (const Amplitude& amplitude : {Amplitude(flat), Amplitude(smooth), Amplitude(black_disc)}) {
            const Filter filter{sigma, false};
            const Theory truth = theory(filter, 128);
            double mean = 0, low = 0;
            for (std::uint64_t i = 0; i < 8; ++i) {
                const NoiseSpectrum s = measure(filter, 128, 5, amplitude, 100 + i);
                mean += s.centroid / 8;
                low += s.low_ratio / 8;
            }
            EXPECT_NEAR(mean / truth.centroid, 1, 0.02) << "sigma " << sigma;
            EXPECT_NEAR(low / truth.low_ratio, 1, 0.03) << "sigma " << sigma;
        }
    const Filter filter{2, false};
    EXPECT_NEAR(measure(filter, 256, 5, flat, 5).centroid / theory(filter, 256).centroid, 1, 0.02);
    EXPECT_NEAR(measure(filter, 128, 3, flat, 5).centroid / theory(filter, 128).centroid, 1, 0.05);
    // Beside a step the variance is pooled over both sides, and no mask can undo that.
    EXPECT_NEAR(measure(filter, 256, 5, step, 5).centroid / theory(filter, 256).centroid, 1, 0.03);
}

// Small images, as of a first look: the mean over 24 data sets of 5 seeds, whose standard error is 1 %.
TEST(NoiseSpectrum, SmoothNoiseHasItsCentroidInSmallImages) {
    const Filter filter{3, false};
    for (const int size : {32, 48, 64, 96}) {
        double mean = 0;
        for (std::uint64_t i = 0; i < 24; ++i)
            mean += measure(filter, size, 5, flat, 300 + i).centroid / 24;
        EXPECT_NEAR(mean / theory(filter, size).centroid, 1, 0.025) << size << " pixels";
    }
}

TEST(NoiseSpectrum, BlueNoiseHasItsCentroid) {
    for (const double sigma : {0.5, 1.0, 2.0})
        for (const Amplitude& amplitude : {Amplitude(flat), Amplitude(smooth), Amplitude(black_disc)}) {
            const Filter filter{sigma, true};
            EXPECT_NEAR(measure(filter, 128, 5, amplitude, 21).centroid / theory(filter, 128).centroid, 1, 0.01);
        }
}

TEST(NoiseSpectrum, TheNoiseOfEdgesIsMasked) {
    // The pixels of an edge scatter a hundred times more, as sampling positions in a pixel make them do.
    std::mt19937_64 random(3);
    const int size = 96;
    const Image reference = image_of(size, [](int x, int) { return x < 40 ? 1 : 2; });
    std::vector<Image> replicates;
    for (int i = 0; i < 4; ++i) {
        const Noise noise = draw(random, size, {});
        Image image = reference;
        for (std::size_t p = 0; p < image.pixels(); ++p) {
            const std::size_t x = p % static_cast<std::size_t>(size);
            // The noise is equal down the whole edge, so that all its power is at low vertical frequencies.
            const double n = x == 40 ? 30 * noise[0] : noise[p];
            image.set(p, image.at(p) + Color::Constant(static_cast<float>(0.01 * n)));
        }
        replicates.push_back(image);
    }
    EXPECT_NEAR(noise_spectrum(replicates, reference)->centroid, 0.3826, 0.015 * 0.3826);
}

TEST(NoiseSpectrum, IsEmptyWithoutScatterOrWithTwoSeeds) {
    const Image image = constant_image(0.3f, 16, 12);
    EXPECT_FALSE(noise_spectrum({image, image, image}, image).has_value());
    Image other = image;
    other.rgb[40] = 1;
    EXPECT_FALSE(noise_spectrum({image, other}, image).has_value());
    // One scattering pixel, an image that is not square, and odd sizes give finite results.
    const auto s = noise_spectrum({image, other, image}, image);
    ASSERT_TRUE(s.has_value());
    EXPECT_TRUE(std::isfinite(s->centroid));
    Image odd(15, 7), odd2(15, 7);
    odd2.rgb[100] = 1;
    EXPECT_TRUE(std::isfinite(noise_spectrum({odd, odd, odd2}, odd)->centroid));
}

TEST(BiasSpectrum, FindsAPatternBelowTheNoiseAtItsFrequency) {
    std::mt19937_64 random(9);
    constexpr int size = 64;
    const Image truth(size, size);
    const Image biased = image_of(size, [](int x, int) { return 0.2 * std::cos(2 * M_PI * 8 * x / size); });
    const auto noisy = [&](const Image& mean) {
        Image image = mean;
        const Noise noise = draw(random, size, {});
        for (std::size_t j = 0; j < image.rgb.size(); ++j)
            image.rgb[j] += static_cast<float>(noise[j / 3]);
        return image;
    };
    std::vector<Image> replicates, groups;
    for (int i = 0; i < 8; ++i)
        replicates.push_back(noisy(biased));
    for (int i = 0; i < reference_groups; ++i)
        groups.push_back(noisy(truth));
    const auto curve = bias_spectrum(replicates, layer_of_groups(groups));
    const auto peak =
        std::max_element(curve.begin(), curve.end(), [](const auto& a, const auto& b) { return a.power < b.power; });
    EXPECT_NEAR(peak->frequency, 8.0 / size, 0.5 / size);
    // The power that noise has in the mean of all images, 1/8 + 1/16, is not in the rest of the curve.
    double rest = 0;
    for (const auto& p : curve)
        if (p.frequency > 0.25) rest += p.power / static_cast<double>(curve.size());
    EXPECT_LT(std::abs(rest), 0.02);
    EXPECT_TRUE(bias_spectrum({replicates[0]}, layer_of_groups(groups)).empty());
    EXPECT_TRUE(bias_spectrum(replicates, {truth, std::nullopt, {}}).empty());
}

}  // namespace
}  // namespace gib::test::spectrum_test
