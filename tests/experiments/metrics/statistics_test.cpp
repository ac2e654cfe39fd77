// Errors of images, their split into bias and variance with intervals, noise floors and times to an error.
#include "experiments/metrics/statistics.h"

#include "common/core/error.h"
#include "experiments/metrics/price_law.h"
#include "experiments/metrics/student_t.h"
#include "tests/support/constant_image.h"
#include "tests/support/moments.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace gib::test::statistics_test {
namespace {

using Random = std::mt19937_64;

Image constant(int width, int height, float value) { return constant_image(value, width, height); }

/// Normal noise of variance 1 with a Gaussian-like correlation (binomial filter of width 5, sigma 1 pixel; periodic).
std::vector<double> correlated_noise(Random& random, int size) {
    std::normal_distribution<double> normal;
    const double kernel[5] = {1 / std::sqrt(70.0), 4 / std::sqrt(70.0), 6 / std::sqrt(70.0), 4 / std::sqrt(70.0),
                              1 / std::sqrt(70.0)};
    const auto filtered = [&](const std::vector<double>& values, int dx, int dy) {
        std::vector<double> sums(values.size());
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                for (int d = -2; d <= 2; ++d)
                    sums[static_cast<std::size_t>(y * size + x)] +=
                        kernel[d + 2] * values[static_cast<std::size_t>((y + d * dy + size) % size * size +
                                                                        (x + d * dx + size) % size)];
        return sums;
    };
    std::vector<double> noise(static_cast<std::size_t>(size * size));
    for (double& v : noise)
        v = normal(random);
    return filtered(filtered(noise, 1, 0), 0, 1);
}

/// A method of known bias and variance, with its replicates and references.
struct Synthetic {
    int size = 16;
    double bias = 0, reference_noise = 0.5;
    Image truth{size, size}, biased{size, size};
    double bias2 = 0, variance = 0;

    Synthetic(double b, double group_noise) : bias(b), reference_noise(group_noise) {
        for (std::size_t i = 0; i < truth.rgb.size(); ++i) {
            truth.rgb[i] = 1 + 0.5f * std::sin(0.05f * static_cast<float>(i));
            biased.rgb[i] = truth.rgb[i] + static_cast<float>(bias) * (i % 2 ? 1.f : 0.2f);
            bias2 += sqr(static_cast<double>(biased.rgb[i]) - static_cast<double>(truth.rgb[i]));
            variance += sqr(amplitude(i / 3));
        }
        for (double* sum : {&bias2, &variance})
            *sum /= static_cast<double>(truth.rgb.size());
    }
    double amplitude(std::size_t pixel) const {
        return 0.5 + static_cast<double>(pixel) / static_cast<double>(truth.pixels());
    }
    /// All channels get the same noise, as most of a renderer's noise is.
    Image draw(Random& random, const Image& mean, double scale) const {
        Image image = mean;
        const auto noise = correlated_noise(random, size);
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            image.rgb[i] += static_cast<float>(scale * amplitude(i / 3) * noise[i / 3]);
        return image;
    }
    ReplicateStatistics measure(Random& random, int seeds) const {
        std::vector<Image> replicates, groups;
        for (int i = 0; i < seeds; ++i)
            replicates.push_back(draw(random, biased, 1));
        for (int g = 0; g < reference_groups; ++g)
            groups.push_back(draw(random, truth, reference_noise));
        return replicate_statistics(replicates, layer_of_groups(groups), {truth, 0.01});
    }
};

bool contains(const Estimate& e, double truth) {
    return e.interval && e.interval->lo <= truth && truth <= e.interval->hi;
}

TEST(StudentT, QuantilesAgreeWithTables) {
    // Abramowitz and Stegun, table 26.10, and closed forms for 1 and 2 degrees of freedom.
    for (const auto& [alpha, degrees, quantile, tolerance] :
         {std::tuple{0.05, 1., std::tan(0.475 * M_PI), 1e-7},
          {0.05, 2., 0.95 * std::sqrt(2 / (1 - 0.95 * 0.95)), 1e-8},
          {0.05, 4., 2.776, 5e-4},
          {0.05, 7., 2.365, 5e-4},
          {0.01, 30., 2.750, 5e-4},
          {0.05, 1e6, 1.959966, 1e-5},
          {0.05, std::numeric_limits<double>::infinity(), 1.9599639845, 1e-9}})
        EXPECT_NEAR(student_t_two_sided(alpha, degrees), quantile, tolerance) << degrees;
    const double between = student_t_two_sided(0.05, 4.5);
    EXPECT_LT(between, student_t_two_sided(0.05, 4));
    EXPECT_GT(between, student_t_two_sided(0.05, 5));
}

// The squares of the variances overflow a double from a unit of 1e154 on, and underflow below 1e-154.
TEST(StudentT, HalfWidthsScaleWithAnyUnit) {
    const double width = half_width({{1, 2}, {3, 7}}, 0.05);
    EXPECT_NEAR(width, std::hypot(student_t_two_sided(0.05, 2), std::sqrt(3) * student_t_two_sided(0.05, 7)), 1e-9);
    for (const double unit : {1e-140, 1e-100, 1e100, 1e150})
        EXPECT_NEAR(half_width({{unit * unit, 2}, {3 * unit * unit, 7}}, 0.05) / (unit * width), 1, 1e-9) << unit;
}

TEST(ImageError, IsThePlainFormula) {
    const Image r = constant(3, 2, 2), total = constant(3, 2, 4), x = constant(3, 2, 2.5f);
    ReferenceLayer reference{r, constant(3, 2, 0.1f), {}};
    const ImageError e = image_error(x, reference, {total, 0.01});
    EXPECT_NEAR(e.mse, 0.25, 1e-12);
    EXPECT_NEAR(e.rel_mse, 0.25 / 16.01, 1e-12);
    EXPECT_NEAR(e.mse_corrected, 0.24, 1e-8);
    EXPECT_NEAR(e.rel_mse_corrected, 0.24 / 16.01, 1e-8);
}

TEST(ImageError, NanIsNotHidden) {
    Image x = constant(3, 2, 1);
    x.rgb[7] = std::numeric_limits<float>::quiet_NaN();
    const ReferenceLayer reference{constant(3, 2, 1), std::nullopt, {}};
    const ImageError e = image_error(x, reference, {reference.mean, 0.01});
    EXPECT_TRUE(std::isnan(e.mse) && std::isnan(e.rel_mse));
    const auto s =
        replicate_statistics({x, x, constant(3, 2, 1), constant(3, 2, 1)}, reference, {reference.mean, 0.01});
    EXPECT_TRUE(std::isnan(s.mse.value) && std::isnan(s.rel_mse.value) && std::isnan(s.rmse.value));
    EXPECT_TRUE(std::isnan(s.bias2->value) && std::isnan(s.variance->value));
    EXPECT_FALSE(s.mse.interval || s.bias2->interval || s.variance->interval);
    EXPECT_THROW(image_error(constant(2, 3, 1), reference, {reference.mean, 0.01}), InputError);
}

TEST(ReferenceImage, LayerOfGroupsHasTheirMeanAndItsStandardError) {
    const ReferenceLayer layer = layer_of_groups({constant(2, 2, 1), constant(2, 2, 2), constant(2, 2, 6)});
    EXPECT_FLOAT_EQ(layer.mean.rgb[5], 3);
    EXPECT_FLOAT_EQ(layer.standard_error->rgb[5], std::sqrt(7.f / 3));
    EXPECT_NEAR(relative_standard_error(layer, {layer, 1}), std::sqrt(7.0 / 3 / 10), 1e-7);
    EXPECT_FALSE(layer_of_groups({constant(2, 2, 1)}).standard_error.has_value());
}

TEST(ReferenceImage, SurvivesAFile) {
    Reference reference;
    reference.total = layer_of_groups({constant(2, 2, 1), constant(2, 2, 2)});
    reference.components[2] = layer_of_groups({constant(2, 2, 0.5f), constant(2, 2, 0.25f)});
    reference.unresolved = {Component::caustic, Component::volume};
    reference.metadata["method"] = "path";
    const TemporaryFolder folder;
    const std::string path = folder / "r.exr";
    write_exr(path, layers_of(reference, true));
    const Reference read = read_reference(path);
    EXPECT_EQ(read.total.mean.rgb, reference.total.mean.rgb);
    EXPECT_EQ(read.total.standard_error->rgb, reference.total.standard_error->rgb);
    ASSERT_EQ(read.total.groups.size(), 2u);
    EXPECT_EQ(read.total.groups[1].rgb, reference.total.groups[1].rgb);
    ASSERT_TRUE(read[Component::caustic].has_value());
    EXPECT_EQ(read[Component::caustic]->groups.size(), 2u);
    EXPECT_FALSE(read[Component::direct].has_value());
    EXPECT_EQ(read.unresolved, reference.unresolved);
    EXPECT_EQ(read.metadata.at("method"), "path");
    write_exr(path, layers_of(reference, false));
    EXPECT_TRUE(read_reference(path).total.groups.empty());
    EXPECT_TRUE(read_reference(path).total.standard_error.has_value());
}

TEST(ReplicateStatistics, MseIsBias2PlusVarianceWithAnExactReference) {
    Random random(1);
    const Synthetic method(0.3, 0);
    const ReferenceLayer exact{method.truth, std::nullopt, {}};
    std::vector<Image> replicates;
    for (int i = 0; i < 4; ++i)
        replicates.push_back(method.draw(random, method.biased, 1));
    const auto s = replicate_statistics(replicates, exact, {method.truth, 0.01});
    EXPECT_NEAR(s.mse.value, s.bias2->value + s.variance->value, 1e-9);
    double mse = 0, rel_mse = 0;
    for (const Image& x : replicates) {
        mse += image_error(x, exact, {method.truth, 0.01}).mse / 4;
        rel_mse += image_error(x, exact, {method.truth, 0.01}).rel_mse / 4;
    }
    EXPECT_NEAR(s.mse.value, mse, 1e-9);
    EXPECT_NEAR(s.rel_mse.value, rel_mse, 1e-9);
    EXPECT_NEAR(s.rmse.value, std::sqrt(mse), 1e-9);
}

TEST(ReplicateStatistics, OneSeedHasNoIntervalAndNoSplit) {
    const ReferenceLayer exact{constant(4, 4, 1), std::nullopt, {}};
    const auto s = replicate_statistics({constant(4, 4, 2)}, exact, {exact.mean, 0.01});
    EXPECT_EQ(s.seeds, 1);
    EXPECT_NEAR(s.mse.value, 1, 1e-12);
    EXPECT_FALSE(s.mse.interval || s.bias2 || s.variance);
    // Deterministic replicates have only bias, with intervals of width zero.
    const auto same = replicate_statistics(std::vector<Image>(4, constant(4, 4, 2)), exact, {exact.mean, 0.01});
    EXPECT_NEAR(same.bias2->value, 1, 1e-12);
    EXPECT_NEAR(same.bias2->interval->hi, 1, 1e-12);
    EXPECT_EQ(same.variance->value, 0);
}

// Over 400 repetitions the mean of an unbiased estimator lies within 4 of its
// standard errors (alpha = 6e-5, fixed seed).
TEST(ReplicateStatistics, Bias2AndVarianceAreUnbiased) {
    for (const double bias : {0.0, 0.5}) {
        Random random(7);
        const Synthetic method(bias, 2);
        Moments bias2, variance;
        for (int i = 0; i < 400; ++i) {
            const auto s = method.measure(random, 3);
            bias2.add(s.bias2->value - method.bias2);
            variance.add(s.variance->value - method.variance);
        }
        for (const Moments& error : {bias2, variance})
            EXPECT_LT(std::abs(error.mean()), 4 * error.standard_error()) << "bias " << bias;
    }
}

// The 95 % intervals contain the truth in 92 % or more of 1000 repetitions, with correlated noise
// and a reference redrawn each time, and those of bias^2, which allow for nothing unseen, in at most 98.5 %. Three
// seeds, fewer than the intervals are made for, are allowed two standard errors of a proportion more.
TEST(ReplicateStatistics, IntervalsContainTheTruth) {
    constexpr int repetitions = 1000;
    for (const int seeds : {3, 5, 8})
        for (const double bias : {0.0, 0.15, 2.0}) {
            Random random(static_cast<std::uint64_t>(100 * seeds) + 1);
            const Synthetic method(bias, 0.8);
            const double reference_variance = sqr(0.8) * method.variance / reference_groups;
            int bias2 = 0, variance = 0, mse = 0;
            for (int i = 0; i < repetitions; ++i) {
                const auto s = method.measure(random, seeds);
                bias2 += contains(*s.bias2, method.bias2);
                variance += contains(*s.variance, method.variance);
                mse += contains(s.mse, method.bias2 + method.variance + reference_variance);
            }
            for (const auto& [name, hits] : {std::pair{"bias2", bias2}, {"variance", variance}, {"mse", mse}}) {
                const double coverage = static_cast<double>(hits) / repetitions;
                RecordProperty(std::string(name) + "_" + std::to_string(seeds), std::to_string(coverage));
                const double more = seeds < 5 ? 2 * std::sqrt(0.05 * 0.95 / repetitions) : 0;
                EXPECT_GE(coverage, 0.92 - more) << name << " bias " << bias << " seeds " << seeds;
                const double most = std::string(name) == "bias2" ? 0.985 + more : 1;
                EXPECT_LE(coverage, most) << name << " bias " << bias << " seeds " << seeds;
            }
        }
}

// White noise of the same power in all channels has a noise floor in closed form: sqrt(2 / (m (m - 1) pixels)) times
// the variance of a group, times 1.96. The error of a perfect image seems larger than that against one reference in
// forty: 25 of 1000, within 3 standard errors of 5.
TEST(ResolvedError, IsWhatAPerfectImageSeemsToHaveInOneOfForty) {
    Random random(11);
    std::normal_distribution<double> normal;
    const Image one = constant(32, 32, 1);
    const double m = reference_groups, exact = 1.96 * std::sqrt(2 / (m * (m - 1) * 32 * 32)) * 0.01;
    double mean = 0;
    int above = 0;
    for (int i = 0; i < 1000; ++i) {
        std::vector<Image> groups(reference_groups, one);
        for (Image& group : groups)
            for (std::size_t p = 0; p < group.pixels(); ++p)
                group.set(p, Color::Constant(1 + 0.1f * static_cast<float>(normal(random))));
        const ReferenceLayer reference = layer_of_groups(groups);
        const double noise_floor = noise_floor_of(reference, {one, 0});
        mean += noise_floor / 1000;
        above += image_error(one, reference, {one, 0}).rel_mse_corrected > noise_floor;
    }
    EXPECT_NEAR(mean, exact, 0.02 * exact);
    EXPECT_NEAR(above, 25, 15);
    EXPECT_EQ(noise_floor_of({one, {}, {}}, {one, 0}), 0) << "no standard error: taken as exact";
}

TEST(TimeToError, InterpolatesInTheLogarithms) {
    // error = seconds^-1/2: 10 % after 100 s.
    const std::vector<CurvePoint> curve = {{1, 1}, {16, 0.25}, {256, 0.0625}};
    const auto one = time_to_error({curve}, 0.1);
    ASSERT_TRUE(one.has_value());
    EXPECT_NEAR(one->value, 100, 1e-9);
    EXPECT_FALSE(one->interval.has_value());
    const auto two = time_to_error({curve, {{4, 1}, {64, 0.25}, {1024, 0.0625}}}, 0.1);
    EXPECT_NEAR(two->value, 200, 1e-9);
    const double widening = std::log(two->interval->hi / two->value);
    EXPECT_NEAR(widening, student_t_two_sided(0.05, 1) * std::log(2.0), 1e-6);
    EXPECT_NEAR(std::log(two->interval->lo / two->value), -widening, 1e-9);
    EXPECT_FALSE(time_to_error({curve, {{1, 1}, {16, 0.25}}}, 0.1).has_value());
    EXPECT_FALSE(time_to_error({}, 0.1).has_value());
    // The first checkpoint reaches this error; times below it are not extrapolated. NaN does not count as reached.
    EXPECT_NEAR(time_to_error({curve}, 2)->value, 1, 1e-12);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(time_to_error({{{1, nan}, {2, nan}}}, 0.1).has_value());
    EXPECT_NEAR(time_to_error({{{1, nan}, {2, 0.05}}}, 0.1)->value, 2, 1e-12);
}

// A rare bright path raises the error of a run that had only not met it yet.
TEST(TimeToError, CountsWhereTheCurveStaysBelow) {
    const std::vector<CurvePoint> raised = {{1, 1}, {2, 0.05}, {4, 0.8}, {16, 0.2}, {64, 0.05}};
    EXPECT_NEAR(time_to_error({raised}, 0.1)->value, 32, 1e-9) << "between 16 and 64 s, error = 0.8 / seconds^1/2";
    EXPECT_FALSE(time_to_error({{{1, 1}, {2, 0.05}, {4, 0.8}}}, 0.1).has_value());
}

TEST(TimeToError, HasTheWiderIntervalOnTheSideOfTheLongerTail) {
    // Times of 1, 1 and 8 s: with l = log(2), the logarithms 0, 0 and 3 l have the mean l, the variance 3 l^2 and the third
    // central moment 2 l^3.
    const std::vector<CurvePoint> soon = {{1, 0.1}}, late = {{8, 0.1}};
    const auto time = time_to_error({soon, soon, late}, 0.1);
    const double l = std::log(2.0), t = student_t_two_sided(0.05, 2);
    EXPECT_NEAR(std::log(time->value), l, 1e-12);
    EXPECT_NEAR(std::log(time->interval->lo), l - t * l, 1e-6);
    EXPECT_NEAR(std::log(time->interval->hi), l + t * l + l / 27 + 2 * l * t * t / 27, 1e-4)
        << "m3 / (6 s^2 n) + m3 half^2 / (3 s^4), with half = t l";
}

}  // namespace
}  // namespace gib::test::statistics_test
