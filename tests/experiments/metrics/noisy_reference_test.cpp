// Judgements by a noisy reference: equal balance, where images that are too bright or too dark are found and images that
// are only noisy or blurred are not; the epsilon of relative errors, by which no relative number depends on the unit of
// light; and the bias that a reference knows, in its file and in what is judged by it.

#include "experiments/metrics/energy_balance.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/metrics/robust_error.h"
#include "experiments/metrics/statistics.h"
#include "experiments/metrics/z_statistic.h"

#include "common/core/math.h"
#include "common/images/image_file.h"
#include "experiments/references/reference_methods.h"
#include "tests/support/constant_image.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gib::test::noisy_reference_test {
namespace {

using Normal = std::normal_distribution<double>;

/// Images of 32 x 32 pixels of radiance `mean` with independent noise.
std::vector<Image> noisy_images(std::mt19937_64& random, int count, double mean, double deviation) {
    std::vector<Image> images(static_cast<std::size_t>(count), Image(32, 32));
    for (Image& image : images) {
        Normal normal(mean, deviation);
        for (float& v : image.rgb)
            v = static_cast<float>(normal(random));
    }
    return images;
}

struct Footed {
    std::mt19937_64 random;
    ReferenceLayer reference;

    explicit Footed(std::uint64_t seed, double mean = 0.5, double deviation = 0.05)
        : random(seed), reference(layer_of_groups(noisy_images(random, reference_groups, mean, deviation))) {}
    /// Checks `seeds` images, whose mean has the relative standard error deviation / (mean sqrt(3072 seeds)).
    std::optional<EnergyBalance> check(double mean, double deviation, int seeds) {
        return energy_balance(noisy_images(random, seeds, mean, deviation), reference, reference.mean);
    }
};

TEST(EnergyBalance, FindsOnePercentTooMuchLight) {
    for (const double factor : {1.01, 0.99, 1.2}) {
        Footed scene(1);
        const auto balance = scene.check(0.5 * factor, 0.1, 5);
        ASSERT_TRUE(balance && balance->excess.interval);
        EXPECT_EQ(balance->verdict, BalanceVerdict::differs) << factor;
        EXPECT_NEAR(balance->excess.value, factor - 1, 0.006);
    }
}

// A method that is 1 % too bright passes as agreeing in less than 0.5 % of the experiments, however noisy: 10 of
// 2000, to which 4 standard errors are added. A right method is accused in less than 1 %: 20, and 4 standard errors.
TEST(EnergyBalance, ErrsAsSeldomAsItSays) {
    for (const double deviation : {0.1, 0.5, 2.0}) {
        Footed scene(2);
        int passed = 0, accused = 0;
        constexpr int experiments = 2000;
        for (int i = 0; i < experiments; ++i) {
            passed += scene.check(0.505, deviation, 3)->verdict == BalanceVerdict::agrees;
            accused += scene.check(0.5, deviation, 3)->verdict == BalanceVerdict::differs;
        }
        EXPECT_LE(passed, 10 + 4 * 3.2) << deviation;
        EXPECT_LE(accused, 20 + 4 * 4.5) << deviation;
    }
}

TEST(EnergyBalance, SaysWhenItCannotTell) {
    Footed scene(3);
    EXPECT_EQ(scene.check(0.5, 0.05, 4)->verdict, BalanceVerdict::agrees);
    EXPECT_EQ(scene.check(0.5, 5, 4)->verdict, BalanceVerdict::inconclusive);
    const auto one = scene.check(0.5, 0.05, 1);
    EXPECT_EQ(one->verdict, BalanceVerdict::inconclusive) << "one seed has no error";
    EXPECT_FALSE(one->excess.interval.has_value());
    EXPECT_EQ(scene.check(NAN, 0.05, 3)->verdict, BalanceVerdict::differs) << "not finite is not hidden";
}

// No image has less than no light, so that no interval begins below that.
TEST(EnergyBalance, FindsNoLessThanNoLight) {
    Footed scene(5, 0.5, 5);
    const Image black(32, 32);
    const auto none = energy_balance({black, black, black}, scene.reference, scene.reference.mean);
    EXPECT_EQ(none->excess.interval->lo, -1);
    EXPECT_EQ(none->verdict, BalanceVerdict::differs);
    const auto little = scene.check(0.1, 2, 2);
    ASSERT_GT(little->energy.value, 0);
    EXPECT_GE(little->excess.interval->lo, -1 - 1e-12);
}

TEST(EnergyBalance, MeasuresFaintComponentsAgainstTheWhole) {
    Footed faint(4, 1e-4, 1e-6), whole(4, 1.0);
    const std::vector<Image> images = noisy_images(faint.random, 3, 2e-4, 1e-6);
    // The component has twice its light, which is only a hundredth of a percent of the whole.
    EXPECT_NEAR(energy_balance(images, faint.reference, whole.reference.mean)->excess.value, 0.01, 1e-4);
    const Image black(32, 32);
    EXPECT_FALSE(energy_balance({black, black}, {black, {}, {}}, black).has_value());
}

/// Images of radiance `mean` with noise of a fifth of it, darker from left to right, times `unit`.
std::vector<Image> shaded_images(int count, double mean, double unit, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    Normal normal;
    std::vector<Image> images(static_cast<std::size_t>(count), Image(16, 16));
    for (Image& image : images)
        for (std::size_t i = 0; i < image.rgb.size(); ++i) {
            const double shade = 1.0 / (1.0 + static_cast<double>(i / 3 % 16));
            image.rgb[i] = static_cast<float>(unit * mean * shade * (1 + 0.2 * normal(random)));
        }
    return images;
}

/// A reference of radiance 1 and an estimated bias of 5 %, in this unit of light.
ReferenceLayer reference_in(double unit) {
    ReferenceLayer r = layer_of_groups(shaded_images(reference_groups, 1, unit, 1));
    r.bias.push_back(layer_of_groups(shaded_images(reference_groups, 0.05, unit, 2)));
    return r;
}

/// Every relative number about replicates that are 10 % too bright, in this unit of light.
std::vector<double> relative_numbers(double unit, const std::optional<double>& given = std::nullopt) {
    const ReferenceLayer r = reference_in(unit);
    const std::vector<Image> x = shaded_images(5, 1.1, unit, 3);
    const double epsilon = epsilon_of(given, r.mean);
    const ImageError single = image_error(x[0], r, {r, epsilon});
    const ReplicateStatistics all = replicate_statistics(x, r, {r, epsilon});
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
            noise_floor_of(r, {r, epsilon}),
            relative_standard_error(r, {r, epsilon}),
            relative_bias(r, {r, epsilon})};
}

TEST(RelativeEpsilon, IsTheSquareOfATenthOfTheMeanLuminance) {
    Image r(2, 1);
    r.set(0, Color(3, 0, 0));
    r.set(1, Color(0, 1, 2));
    const double m = (0.212671 * 3 + 0.715160 + 0.072169 * 2) / 2;
    EXPECT_NEAR(epsilon_of(std::nullopt, r), 0.01 * m * m, 1e-8);
    r = constant_image(1.f, 2, 1);
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

constexpr double group_noise = 0.1;  ///< standard deviation of a group's pixel

/// A layer of radiance 1 + `shift`, whose groups estimate the bias as `bias` with noise.
ReferenceLayer layer(double shift, double bias, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    ReferenceLayer result = layer_of_groups(noisy_images(random, reference_groups, 1 + shift, group_noise));
    result.bias.push_back(layer_of_groups(noisy_images(random, reference_groups, bias, group_noise)));
    return result;
}

// The square of the estimate's own noise does not count as bias.
TEST(ReferenceBias, IsPartOfTheReferencesError) {
    const double standard_error = group_noise / std::sqrt(reference_groups);
    EXPECT_NEAR(relative_standard_error(layer(0, 0, 1), {layer(0, 0, 1), 0}), standard_error, 0.05 * standard_error);
    EXPECT_NEAR(relative_standard_error(layer(0, 0.05, 1), {layer(0, 0.05, 1), 0}), std::hypot(standard_error, 0.05),
                0.002);
}

TEST(ReferenceBias, IsStoredInTheFile) {
    const TemporaryFolder folder;
    const std::string path = folder / "r.exr";
    Reference reference;
    reference.total = layer(0, 0.05, 1);
    reference.components[0] = layer(0, 0.02, 2);
    write_reference(path, reference);
    const Reference read = read_reference(path);
    for (const auto& [stored, made] :
         {std::pair(&read.total, &reference.total), std::pair(&*read.components[0], &*reference.components[0])}) {
        ASSERT_EQ(stored->bias.size(), 1u);
        EXPECT_EQ(stored->bias[0].mean.rgb, made->bias[0].mean.rgb);
        EXPECT_EQ(stored->bias[0].groups.size(), reference_groups);
    }
}

// An image without an error of its own, against a reference that is too bright by its bias.
TEST(ReferenceBias, WidensEveryInterval) {
    ReferenceLayer r = layer(0.05, 0.05, 1), x = layer(0, 0, 2);
    x.bias.clear();
    const auto verdict = [&] { return verdict_of({{"total", z_test(x, r, r.mean)}}, {}); };
    const auto balance = [&] { return energy_balance(x.groups, r, r.mean)->verdict; };
    const auto bias2 = [&] { return replicate_statistics(x.groups, r, {r, 0.01}).bias2->interval->lo; };
    EXPECT_FALSE(verdict().differs);
    EXPECT_NE(balance(), BalanceVerdict::differs);
    EXPECT_LE(bias2(), 0);
    EXPECT_NEAR(image_error(x.mean, r, {r, 0.01}).mse_corrected, 0, 2e-3);
    const double floor = noise_floor_of(r, {r, 0.01});
    r.bias.clear();
    EXPECT_TRUE(verdict().differs);
    EXPECT_EQ(balance(), BalanceVerdict::differs);
    EXPECT_GT(bias2(), 0);
    EXPECT_NEAR(floor - noise_floor_of(r, {r, 0.01}), 0.05 * 0.05 / (1.05 * 1.05 + 0.01), 3e-4);
}

}  // namespace
}  // namespace gib::test::noisy_reference_test
