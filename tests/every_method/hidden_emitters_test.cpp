// Laws of `hide_emitters` for every method: the camera's own rays see no emitter, and lighting does not change.
#include "tests/support/methods_under_test.h"

#include <numbers>

namespace gib::hidden_emitters_test {
namespace {

using namespace test;

const std::string hiding = element("integrator", "path", flag("hide_emitters"));

/// A camera at height z that looks down on [-size, size]^2 in the plane z = 0.
std::string camera_at(double z, double size = 1) {
    return camera(2 * std::atan(size / z) * 180 / std::numbers::pi, to_world(rotate('y', 180), translate(0, 0, z)),
                  box_film(8));
}
/// A lamp of this radiance in the plane at height z, which faces up or down; its surface reflects half of the light.
std::string lamp(double z, bool down, double radiance) {
    return shape("rectangle", to_world(down ? rotate('x', 180) : "", translate(0, 0, z)), diffuse(0.5),
                 area_light(radiance));
}
LoadedScene seen(const std::string& body) { return scene_of(scene_xml(body)); }

class HiddenEmitters : public OfAMethod {
protected:
    double mean(const LoadedScene& scene, std::uint32_t passes = 1024) const {
        return mean_of(rendered(scene, passes, "max_depth=2").total())[1];
    }
};
INSTANTIATE_TEST_SUITE_P(Registry, HiddenEmitters, testing::ValuesIn(methods_under_test()), name_of_method);

// The camera looks through one lamp that shines at it and one that lights the plate below. What it sees is the plate as
// seen from below the lamps, and nothing of what a point light, which the lamps hide from the plate, adds to a lamp. 64
// pixels x 1024 samples: a standard error below 0.5 %, also of light paths.
TEST_P(HiddenEmitters, AreLookedThrough) {
    const std::string scene = shape("rectangle", diffuse(0.5)) + lamp(1, true, 3) + lamp(2, false, 7) +
                              emitter("point", point("position", 0.3, 0.2, 2.5));
    const double below = mean_of(render(seen(camera_at(0.5) + scene), "path max_depth=2", 1024).total())[1];
    EXPECT_NEAR(mean(seen(hiding + camera_at(3) + scene)), below, 0.02 * below);
    EXPECT_GT(mean(seen(camera_at(3) + scene), 64), 6.5) << "without hide_emitters";
}

// A mirror shows the lamps as before.
TEST_P(HiddenEmitters, AreSeenInMirrors) {
    const LoadedScene scene =
        seen(hiding + camera_at(3, 0.2) + shape("rectangle", bsdf("conductor")) + lamp(1, true, 3) + lamp(2, false, 7));
    if (!method().resolves(*scene.scene)) GTEST_SKIP() << "the method leaves out mirror images";
    const ComponentImages image = rendered(scene, 64, "max_depth=2");
    EXPECT_NEAR(mean_of(image.total())[1], 3.0, 1e-3);
    EXPECT_NEAR(mean_of(*image[Component::emission])[1], 3.0, 1e-3);
}

// Around the ball the environment is hidden; the ball and its light are the same.
TEST_P(HiddenEmitters, LeaveTheEnvironmentsBackgroundBlack) {
    const std::string body =
        camera(40, to_world(look_at("0, 0, 5", "0, 0, 0")), box_film(8)) + shape("sphere") + emitter("constant");
    const Image hidden = rendered(seen(hiding + body), 256).total(), shown = rendered(seen(body), 256).total();
    for (const std::size_t corner : {0u, 7u, 56u, 63u}) {
        EXPECT_TRUE(is_black(hidden.at(corner)));
        EXPECT_NEAR(shown.at(corner)[1], 1.f, 0.5f);
    }
    const double middle = hidden.at(27)[1] + hidden.at(28)[1] + hidden.at(35)[1] + hidden.at(36)[1];
    EXPECT_NEAR(middle / 4, 0.5, 0.05);
}

// A hole in a mask is no scattering: behind it the lamps and the environment are hidden, too.
TEST_P(HiddenEmitters, StayHiddenBehindMasks) {
    const std::string scene =
        camera_at(3) +
        shape("rectangle", to_world(translate(0, 0, 2.5)), bsdf("mask", number("opacity", 0.25), diffuse(0))) +
        lamp(2, false, 7) + emitter("constant");
    EXPECT_EQ(mean_of(rendered(seen(hiding + scene), 64, "max_depth=1").total())[1], 0.0);
    EXPECT_NEAR(mean_of(rendered(seen(scene), 256, "max_depth=1").total())[1], 0.75 * 7, 0.1);
}

}  // namespace
}  // namespace gib::hidden_emitters_test
