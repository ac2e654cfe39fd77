// The bias that a reference knows, in its file and in what is judged by it.

#include "common/images/image_file.h"
#include "experiments/metrics/equal_footing.h"
#include "experiments/metrics/statistics.h"
#include "experiments/metrics/z_statistic.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

#include <random>

namespace gib::reference_bias_test {
namespace {

constexpr int size = 32;
constexpr double noise = 0.1;  ///< standard deviation of a group's pixel

/// A layer of radiance 1 + `shift`, whose groups estimate the bias as `bias` with noise.
ReferenceLayer layer(double shift, double bias, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto groups = [&](double mean) {
        std::vector<Image> images(reference_groups, Image(size, size));
        for (Image& image : images)
            for (float& v : image.rgb)
                v = static_cast<float>(mean + noise * normal(random));
        return images;
    };
    ReferenceLayer result = layer_of_groups(groups(1 + shift));
    result.bias.push_back(layer_of_groups(groups(bias)));
    return result;
}

// The square of the estimate's own noise does not count as bias.
TEST(ReferenceBias, IsPartOfTheReferencesError) {
    const double standard_error = noise / std::sqrt(reference_groups);
    EXPECT_NEAR(relative_standard_error(layer(0, 0, 1), 0), standard_error, 0.05 * standard_error);
    EXPECT_NEAR(relative_standard_error(layer(0, 0.05, 1), 0), std::hypot(standard_error, 0.05), 0.002);
}

TEST(ReferenceBias, IsStoredInTheFile) {
    const test::TemporaryFolder folder;
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
    const auto footing = [&] { return equal_footing(x.groups, r, r.mean)->verdict; };
    const auto bias2 = [&] { return replicate_statistics(x.groups, r, r.mean, 0.01).bias2->interval->lo; };
    EXPECT_FALSE(verdict().differs);
    EXPECT_NE(footing(), FootingVerdict::differs);
    EXPECT_LE(bias2(), 0);
    EXPECT_NEAR(image_error(x.mean, r, r.mean, 0.01).mse_corrected, 0, 2e-3);
    const double floor = noise_floor_of(r, r.mean, 0.01);
    r.bias.clear();
    EXPECT_TRUE(verdict().differs);
    EXPECT_EQ(footing(), FootingVerdict::differs);
    EXPECT_GT(bias2(), 0);
    EXPECT_NEAR(floor - noise_floor_of(r, r.mean, 0.01), 0.05 * 0.05 / (1.05 * 1.05 + 0.01), 3e-4);
}

}  // namespace
}  // namespace gib::reference_bias_test
