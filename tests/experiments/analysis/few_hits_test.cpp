// References that rest on few hits: intervals of errors against them allow for the light that they may have missed.
#include "experiments/metrics/few_hits.h"

#include "experiments/analysis/row_fields.h"
#include "experiments/analysis/unsampled_light.h"
#include "tests/support/table_fixtures.h"

#include <gtest/gtest.h>
#include <random>

namespace gib::test::few_hits_test {
namespace {

constexpr int size = 32, seeds = 5;
constexpr std::size_t rare = 60;     ///< pixels in which rare bright paths carry half of the light
constexpr float rare_light = 0.15f;  ///< their mean [W/(sr m^2)]; all else is 0.15, too
constexpr double epsilon = 1e-3;

/// A component of its own, as caustics are; `hits`: of its rare paths, the mean number in a pixel of the whole reference. Heights
/// are exponential.
ReferenceLayer caustic_of_hits(double hits, std::mt19937& random) {
    std::poisson_distribution<int> number(hits / reference_groups);
    std::exponential_distribution<float> height(1);
    std::vector<Image> groups(reference_groups, Image(size, size));
    for (Image& group : groups)
        for (std::size_t pixel = 0; pixel < rare; ++pixel)
            for (int n = number(random); n > 0; --n) {
                const float hit = rare_light * static_cast<float>(reference_groups / hits) * height(random);
                group.set(pixel, group.at(pixel) + hit);
            }
    return layer_of_groups(std::move(groups));
}

/// Images of the caustic that are too bright by a tenth, with noise of a tenth.
std::vector<Image> biased_images(std::mt19937& random) {
    std::normal_distribution<float> factor(1.1f, 0.1f);
    std::vector<Image> images(seeds, Image(size, size));
    for (Image& x : images)
        for (std::size_t pixel = 0; pixel < rare; ++pixel)
            x.set(pixel, Color::Constant(rare_light * factor(random)));
    return images;
}

/// Mean square of their relative error: the images' bias and noise are a tenth each.
const double true_error2 =
    2 * 0.01 * sqr(double{rare_light}) / (sqr(2 * double{rare_light}) + epsilon) * rare / (size * size);

TableRow judged(const std::vector<Image>& images, const ReferenceLayer& reference, bool allows) {
    Image total(size, size);
    for (std::size_t pixel = 0; pixel < total.pixels(); ++pixel)
        total.set(pixel, Color::Constant(pixel < rare ? 2 * rare_light : rare_light));
    const Denominators denominators(total, epsilon);
    TableRow row = row_of("progressive_photon_mapper");
    row.statistics = replicate_statistics(images, reference, denominators);
    if (allows) allow_for_missed_light(row, images, light_missed_by(reference, images), reference, denominators);
    return row;
}

/// The number of references out of 100 whose interval holds the true error, and the mean of their upper ends over it.
std::pair<int, double> coverage(double hits, bool allows) {
    std::mt19937 random(11);
    int held = 0;
    double ends = 0;
    for (int reference = 0; reference < 100; ++reference) {
        const ReferenceLayer layer = caustic_of_hits(hits, random);
        const Estimate error2 = *corrected_rel_mse(judged(biased_images(random), layer, allows));
        held += error2.interval->lo <= true_error2 && true_error2 <= error2.interval->hi ? 1 : 0;
        ends += error2.interval->hi / true_error2 / 100;
    }
    return {held, ends};
}

TEST(FewHits, IntervalsHoldTheErrorWhereTheReferenceHasMissedLight) {
    EXPECT_LT(coverage(0.03, false).first, 85) << "the scatter of the groups does not know what they have missed";
    EXPECT_GE(coverage(0.03, true).first, 90);
    EXPECT_GE(coverage(0.2, true).first, 90);
    EXPECT_GE(coverage(1, true).first, 90);
}

TEST(FewHits, WidenNothingWhereHitsAreMany) { EXPECT_EQ(coverage(100, true), coverage(100, false)); }

TEST(FewHits, AreNoted) {
    std::mt19937 random(3);
    const auto notes = [&](double hits) {
        Reference reference;
        reference.components[static_cast<std::size_t>(index_of(Component::caustic))] = caustic_of_hits(hits, random);
        return notes_of_few_hits(reference).size();
    };
    EXPECT_EQ(notes(1), 1) << "some 40 of 1024 pixels have met one or two hits";
    EXPECT_EQ(notes(100), 0);
}

TEST(FewHits, LightThatImagesDoNotShowForSureIsNotMissed) {
    std::mt19937 random(5);
    const ReferenceLayer reference = caustic_of_hits(0.2, random);
    EXPECT_FALSE(is_black(light_missed_by(reference, biased_images(random))));
    const std::vector<Image> one = {biased_images(random).front()};
    EXPECT_TRUE(is_black(light_missed_by(reference, one)));
    std::vector<Image> noisy = biased_images(random);
    for (std::size_t i = 1; i < noisy.size(); ++i)
        noisy[i] = Image(size, size);
    EXPECT_TRUE(is_black(light_missed_by(reference, noisy))) << "one seed's hit is noise";
}

}  // namespace
}  // namespace gib::test::few_hits_test
