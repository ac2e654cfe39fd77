// Equal footing: images that are too bright or too dark are found, images that are only noisy or blurred are not.

#include "experiments/metrics/equal_footing.h"

#include "common/core/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gib::equal_footing_test {
namespace {

Image noisy(std::mt19937_64& random, double mean, double deviation) {
    std::normal_distribution<double> normal(mean, deviation);
    Image image(32, 32);
    for (float& v : image.rgb)
        v = static_cast<float>(normal(random));
    return image;
}

struct Scene {
    std::mt19937_64 random;
    ReferenceLayer reference;

    explicit Scene(std::uint64_t seed, double mean = 0.5, double deviation = 0.05) : random(seed) {
        std::vector<Image> groups;
        for (int g = 0; g < reference_groups; ++g)
            groups.push_back(noisy(random, mean, deviation));
        reference = layer_of_groups(std::move(groups));
    }
    /// Checks `seeds` images, whose mean has the relative standard error deviation / (mean sqrt(3072 seeds)).
    std::optional<Footing> check(double mean, double deviation, int seeds) {
        std::vector<Image> images;
        for (int i = 0; i < seeds; ++i)
            images.push_back(noisy(random, mean, deviation));
        return equal_footing(images, reference, reference.mean);
    }
};

TEST(EqualFooting, FindsOnePercentTooMuchLight) {
    for (const double factor : {1.01, 0.99, 1.2}) {
        Scene scene(1);
        const auto footing = scene.check(0.5 * factor, 0.1, 5);
        ASSERT_TRUE(footing && footing->excess.interval);
        EXPECT_EQ(footing->verdict, FootingVerdict::differs) << factor;
        EXPECT_NEAR(footing->excess.value, factor - 1, 0.006);
    }
}

// A method that is 1 % too bright passes as agreeing in less than 0.5 % of the experiments, however noisy: 10 of
// 2000, to which 4 standard errors are added. A right method is accused in less than 1 %: 20, and 4 standard errors.
TEST(EqualFooting, ErrsAsSeldomAsItSays) {
    for (const double deviation : {0.1, 0.5, 2.0}) {
        Scene scene(2);
        int passed = 0, accused = 0;
        constexpr int experiments = 2000;
        for (int i = 0; i < experiments; ++i) {
            passed += scene.check(0.505, deviation, 3)->verdict == FootingVerdict::agrees;
            accused += scene.check(0.5, deviation, 3)->verdict == FootingVerdict::differs;
        }
        EXPECT_LE(passed, 10 + 4 * 3.2) << deviation;
        EXPECT_LE(accused, 20 + 4 * 4.5) << deviation;
    }
}

TEST(EqualFooting, SaysWhenItCannotTell) {
    Scene scene(3);
    EXPECT_EQ(scene.check(0.5, 0.05, 4)->verdict, FootingVerdict::agrees);
    EXPECT_EQ(scene.check(0.5, 5, 4)->verdict, FootingVerdict::unresolved);
    const auto one = scene.check(0.5, 0.05, 1);
    EXPECT_EQ(one->verdict, FootingVerdict::unresolved) << "one seed has no error";
    EXPECT_FALSE(one->excess.interval.has_value());
    EXPECT_EQ(scene.check(NAN, 0.05, 3)->verdict, FootingVerdict::differs) << "not finite is not hidden";
}

TEST(EqualFooting, MeasuresFaintComponentsAgainstTheWhole) {
    Scene faint(4, 1e-4, 1e-6), whole(4, 1.0);
    std::vector<Image> images(3, Image(32, 32));
    for (Image& image : images)
        image = noisy(faint.random, 2e-4, 1e-6);
    // The component has twice its light, which is only a hundredth of a percent of the whole.
    EXPECT_NEAR(equal_footing(images, faint.reference, whole.reference.mean)->excess.value, 0.01, 1e-4);
    const Image black(32, 32);
    EXPECT_FALSE(equal_footing({black, black}, {black, {}, {}}, black).has_value());
}

}  // namespace
}  // namespace gib::equal_footing_test
