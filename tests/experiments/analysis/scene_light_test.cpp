// Which components hold light, and what is judged of an image whose reference does not resolve all of them.

#include "experiments/analysis/scene_light.h"

#include "experiments/results/judgement.h"

#include "tests/support/constant_image.h"

#include <gtest/gtest.h>

namespace gib::test::scene_light_test {
namespace {

Image constant(float value) { return constant_image(value, 2, 2); }

/// A reference with `direct` light and a black `emission`, which does not resolve `caustic` and `volume`, of which it shows
/// nothing.
Reference reference_of(float direct) {
    Reference reference;
    reference.total = {.mean = constant(direct), .standard_error = std::nullopt, .groups = {}};
    for (const auto& [c, value] : {std::pair(Component::direct, direct), std::pair(Component::emission, 0.f),
                                   std::pair(Component::caustic, 0.f), std::pair(Component::volume, 0.f)})
        reference.components[static_cast<std::size_t>(index_of(c))] =
            ReferenceLayer{.mean = constant(value), .standard_error = std::nullopt, .groups = {}};
    reference.unresolved = {Component::caustic, Component::volume};
    return reference;
}

ComponentImages image_of(float caustic, float volume) {
    ComponentImages image{.width = 2, .height = 2, .parts = {}};
    image[Component::caustic] = constant(caustic);
    image[Component::volume] = constant(volume);
    return image;
}

TEST(SceneLight, IsUnknownUntilSomeImageHasAllPathsOfAComponent) {
    SceneLight light(reference_of(1));
    EXPECT_EQ(light.holding_light("emission;direct;caustic;volume"), "direct;caustic;volume")
        << "the reference resolves that emission is black, and cannot tell of the unresolved ones";
    light.add({image_of(0, 0)}, "caustic");
    EXPECT_EQ(light.holding_light("caustic;volume"), "caustic") << "this method has all paths of `volume`: it is black";
    light.add({image_of(0, 0)}, "");
    EXPECT_EQ(light.holding_light("caustic;volume"), "");
}

TEST(SceneLight, IsSeenInAnyImage) {
    SceneLight light(reference_of(1));
    light.add({image_of(0, 0)}, "");
    light.add({image_of(0, 0), image_of(0, 0.5f)}, "caustic;volume");
    EXPECT_EQ(light.holding_light("caustic;volume"), "volume");
}

// An image whose judged part is black on both sides would have no error at all.
TEST(Judgement, HasNoTotalWhereNothingIsJudged) {
    const ComponentImages image = image_of(1, 1);
    const Reference whole = reference_of(1), nothing = reference_of(0);
    const Judgement judged(whole), empty(nothing);
    EXPECT_FALSE(judged.is_empty());
    EXPECT_EQ(judged.errors(image, 0.01).count(total_name), 1u);
    EXPECT_TRUE(empty.is_empty());
    EXPECT_EQ(empty.errors(image, 0.01).count(total_name), 0u);
    Reference black = reference_of(0);
    black.unresolved.clear();
    EXPECT_FALSE(Judgement(black).is_empty()) << "a scene without light is judged";
}

}  // namespace
}  // namespace gib::test::scene_light_test
