// Methods that are compared with one noisy reference: its noise names no winner.
#include "experiments/analysis/ranking.h"

#include "tests/support/constant_image.h"

#include <gtest/gtest.h>
#include <cmath>
#include <random>

namespace gib::test::shared_reference_test {
namespace {

constexpr int edge = 16;

Image noisy(float mean, double deviation, std::mt19937& random) {
    Image image = constant_image(mean, edge, edge);
    std::normal_distribution<double> noise(0, deviation);
    for (float& v : image.rgb)
        v += static_cast<float>(noise(random));
    return image;
}

/// A reference of mean 1 whose pixels and channels have the standard error `error`.
ReferenceLayer reference_of(double error, std::mt19937& random) {
    std::vector<Image> groups;
    for (int g = 0; g < reference_groups; ++g)
        groups.push_back(noisy(1.f, error * std::sqrt(double{reference_groups}), random));
    return layer_of_groups(std::move(groups));
}

Contender contender(const std::vector<Image>& images, const ReferenceLayer& reference) {
    const Denominators denominators(reference, 1e-6);
    const ReplicateStatistics statistics = replicate_statistics(images, reference, denominators);
    Contender c;
    c.mean = statistics.rel_mse_corrected;
    c.pulls = statistics.pulls;
    for (const Image& image : images)
        c.logs.push_back(std::log(image_error(image, reference, denominators).rel_mse_corrected));
    return c;
}

/// How often one of two methods, whose images are `a` and `b` times the truth, is named without a tie.
int named(float a, float b, double seed_noise, int seeds, double reference_error, int trials) {
    std::mt19937 random(7);
    int count = 0;
    for (int t = 0; t < trials; ++t) {
        const ReferenceLayer reference = reference_of(reference_error, random);
        std::vector<Contender> contenders;
        for (const float mean : {a, b}) {
            std::vector<Image> images;
            for (int s = 0; s < seeds; ++s)
                images.push_back(noisy(mean, seed_noise, random));
            contenders.push_back(contender(images, reference));
        }
        set_scatter(contenders);
        count +=
            differ_significantly(contenders[0], contenders[1]) || differ_significantly(contenders[1], contenders[0])
                ? 1
                : 0;
    }
    return count;
}

// At 98 %, 2 of 100 are named; more than 8 have a probability of 0.02 %. Without the term of the reference most are named.
TEST(SharedReference, ItsNoiseNamesNoWinnerOfEqualErrors) {
    for (const double seed_noise : {1e-3, 0.03, 0.3})
        for (const double reference_error : {0.02, 0.3})
            EXPECT_LE(named(1.1f, 0.9f, seed_noise, 3, reference_error, 100), 8)
                << seed_noise << " " << reference_error;
}

TEST(SharedReference, AFactorOfOneFifthIsNamedByAReferenceOfHalfTheError) {
    EXPECT_GE(named(1.12f, 0.9f, 0.02, 5, 0.05, 50), 48);
}

TEST(SharedReference, MethodsThatErrInTheSameWayShareItsNoise) { EXPECT_GE(named(1.12f, 1.1f, 1e-4, 5, 0.05, 50), 48); }

}  // namespace
}  // namespace gib::test::shared_reference_test
