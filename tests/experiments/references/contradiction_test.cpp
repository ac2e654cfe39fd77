// Images that prove a reference wrong, and images that prove nothing.
#include "experiments/references/agreement.h"

#include "tests/support/constant_image.h"
#include "tests/support/matchers.h"

#include <random>

namespace gib::test::contradiction_test {
namespace {

constexpr int edge = 32;
const std::vector<Component> both = {Component::direct, Component::caustic};

Image noisy(std::mt19937_64& random, double mean) {
    std::normal_distribution<double> normal(mean, 0.1 * mean);
    return mapped(Image(edge, edge), [&](float) { return static_cast<float>(normal(random)); });
}

Reference reference_of(std::mt19937_64& random, double direct, double caustic) {
    Reference reference;
    for (const auto& [c, mean] : {std::pair(Component::direct, direct), std::pair(Component::caustic, caustic)}) {
        std::vector<Image> groups;
        for (int g = 0; g < reference_groups; ++g)
            groups.push_back(noisy(random, mean));
        reference.components[static_cast<std::size_t>(index_of(c))] = layer_of_groups(std::move(groups));
    }
    return reference;
}

std::vector<ComponentImages> images_of(std::mt19937_64& random, int seeds, double direct, double caustic) {
    std::vector<ComponentImages> images(static_cast<std::size_t>(seeds));
    for (ComponentImages& image : images) {
        image.width = image.height = edge;
        image[Component::direct] = noisy(random, direct);
        image[Component::caustic] = noisy(random, caustic);
    }
    return images;
}

TEST(Contradiction, IsMoreLightInOneRegion) {
    std::mt19937_64 random(1);
    const Reference reference = reference_of(random, 1, 1);
    auto images = images_of(random, 3, 1, 1);
    EXPECT_TRUE(contradictions(reference, images, both).empty());
    for (ComponentImages& image : images)
        for (std::size_t p = 8 * edge + 16; p < 8 * edge + 24; ++p)
            for (std::size_t row = 0; row < 8; ++row)
                image[Component::caustic]->rgb[3 * (p + row * edge) + 1] += 0.2f;
    const auto found = contradictions(reference, images, both);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].component, Component::caustic);
    EXPECT_FALSE(found[0].is_black);
    EXPECT_EQ((std::array{found[0].where.x, found[0].where.y}), (std::array{16, 8}));
    EXPECT_THAT(found[0].text(),
                HasSubstr("light of caustic, which the reference lacks (pixels x 16 to 23, y 8 to 15"));
    EXPECT_TRUE(contradictions(reference, images, {Component::direct}).empty()) << "of a biased method";
    EXPECT_TRUE(contradictions(reference, {images[0]}, both).empty()) << "one image has no noise";
}

// Methods that have not met rare paths yet are too dark without noise.
TEST(Contradiction, IsNotLessLight) {
    std::mt19937_64 random(2);
    EXPECT_TRUE(contradictions(reference_of(random, 1, 1), images_of(random, 5, 0.9, 0), both).empty());
}

TEST(Contradiction, IsAnyLightWhereTheReferenceIsBlack) {
    std::mt19937_64 random(3);
    Reference reference = reference_of(random, 1, 0);
    const auto found = contradictions(reference, images_of(random, 1, 1, 1e-6), {});
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(found[0].is_black);
    reference.unresolved = {Component::caustic};
    EXPECT_TRUE(contradictions(reference, images_of(random, 1, 1, 1e-6), {}).empty());
}

// At a level of 1e-4, 400 experiments with 2 components have 0.08 false alarms on average.
TEST(Contradiction, IsSeldomAFalseAlarm) {
    std::mt19937_64 random(4);
    int found = 0;
    for (int i = 0; i < 400; ++i)
        found += contradictions(reference_of(random, 1, 0.1), images_of(random, 3, 1, 0.1), both).empty() ? 0 : 1;
    EXPECT_LE(found, 1);
}

}  // namespace
}  // namespace gib::test::contradiction_test
