// Laws of `hide_emitters` for every method: the camera's own rays see no emitter, and lighting does not change.
#include "tests/support/scene_fixtures.h"

namespace gib::hidden_emitters_test {
namespace {

using test::mean_of;
using test::render;

const std::string hiding = "<integrator type='path'><boolean name='hide_emitters' value='true'/></integrator>";

/// A camera at height z that looks down on [-size, size]^2 in the plane z = 0.
std::string camera_at(double z, double size = 1) {
    const double fov = 2 * std::atan(size / z) * 180 / std::numbers::pi;
    return "<sensor type='perspective'><float name='fov' value='" + std::to_string(fov) +
           "'/><transform name='to_world'><rotate y='1' angle='180'/><translate z='" + std::to_string(z) +
           "'/></transform>" + test::box_film(8) + "</sensor>";
}

/// A lamp of this radiance in the plane at height z, which faces up or down; its surface reflects half of the light.
std::string lamp(double z, bool down, double radiance) {
    return "<shape type='rectangle'><transform name='to_world'>" +
           std::string(down ? "<rotate x='1' angle='180'/>" : "") + "<translate z='" + std::to_string(z) +
           "'/></transform>" + test::diffuse(0.5) + "<emitter type='area'><rgb name='radiance' value='" +
           std::to_string(radiance) + "'/></emitter></shape>";
}

std::string plate(const std::string& bsdf) { return "<shape type='rectangle'>" + bsdf + "</shape>"; }

const std::string mirror = "<bsdf type='conductor'/>";

LoadedScene scene_of(const std::string& body) { return test::scene_of(test::scene_xml(body)); }

class HiddenEmitters : public testing::TestWithParam<std::string> {
protected:
    bool resolves(const LoadedScene& scene) const {
        const Plan plan = ConfiguredMethod(MethodLabel{GetParam(), {}}).create({})->plan(*scene.scene);
        return plan.missing.empty() && plan.unresolved.empty();
    }
    Colord mean(const LoadedScene& scene, std::uint32_t passes = 1024) const {
        return mean_of(render(scene, GetParam() + " max_depth=2", passes).total());
    }
};

INSTANTIATE_TEST_SUITE_P(Registry, HiddenEmitters, testing::ValuesIn(names_of_comparable_methods()),
                         [](const auto& name) { return name.param; });

// The camera looks through one lamp that shines at it and one that lights the plate below. What it sees is the plate as
// seen from below the lamps, and nothing of what a point light, which the lamps hide from the plate, adds to a lamp. 64 pixels x 1024 samples: a standard error below 0.5 %, also of light paths.
TEST_P(HiddenEmitters, AreLookedThrough) {
    const std::string above = "<emitter type='point'><point name='position' x='0.3' y='0.2' z='2.5'/></emitter>";
    const std::string scene = plate(test::diffuse(0.5)) + lamp(1, true, 3) + lamp(2, false, 7) + above;
    const double seen = mean(scene_of(hiding + camera_at(3) + scene))[1];
    const double below = mean_of(render(scene_of(camera_at(0.5) + scene), "path max_depth=2", 1024).total())[1];
    EXPECT_NEAR(seen, below, 0.02 * below);
    EXPECT_GT(mean(scene_of(camera_at(3) + scene), 64)[1], 6.5) << "without hide_emitters";
}

// A mirror shows the lamps as before.
TEST_P(HiddenEmitters, AreSeenInMirrors) {
    const LoadedScene scene =
        scene_of(hiding + camera_at(3, 0.2) + plate(mirror) + lamp(1, true, 3) + lamp(2, false, 7));
    if (!resolves(scene)) GTEST_SKIP() << "the method leaves out mirror images";
    const ComponentImages image = render(scene, GetParam() + " max_depth=2", 64);
    EXPECT_NEAR(mean_of(image.total())[1], 3.0, 1e-3);
    EXPECT_NEAR(mean_of(*image[Component::emission])[1], 3.0, 1e-3);
}

// Around the ball the environment is hidden; the ball and its light are the same.
TEST_P(HiddenEmitters, LeaveTheEnvironmentsBackgroundBlack) {
    const std::string body =
        "<sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'><lookat origin='0, 0, 5' "
        "target='0, 0, 0' up='0, 1, 0'/></transform>" +
        test::box_film(8) + "</sensor><shape type='sphere'/><emitter type='constant'/>";
    const LoadedScene scene = scene_of(hiding + body);
    if (!resolves(scene)) GTEST_SKIP() << "the method leaves out environments";
    const Image hidden = render(scene, GetParam(), 256).total(),
                shown = render(scene_of(body), GetParam(), 256).total();
    for (const std::size_t corner : {0u, 7u, 56u, 63u}) {
        EXPECT_TRUE(is_black(hidden.at(corner)));
        EXPECT_NEAR(shown.at(corner)[1], 1.f, 0.5f);
    }
    const double middle = hidden.at(27)[1] + hidden.at(28)[1] + hidden.at(35)[1] + hidden.at(36)[1];
    EXPECT_NEAR(middle / 4, 0.5, 0.05);
}

// A hole in a mask is no scattering: behind it the lamps and the environment are hidden, too.
TEST(HiddenEmittersBehindMasks, StayHidden) {
    const std::string pane =
        "<shape type='rectangle'><transform name='to_world'><translate z='2.5'/></transform><bsdf type='mask'><float "
        "name='opacity' value='0.25'/>" +
        test::diffuse(0) + "</bsdf></shape>";
    const std::string scene = camera_at(3) + pane + lamp(2, false, 7) + "<emitter type='constant'/>";
    EXPECT_EQ(mean_of(render(scene_of(hiding + scene), "path max_depth=1", 64).total())[1], 0.0);
    EXPECT_NEAR(mean_of(render(scene_of(scene), "path max_depth=1", 256).total())[1], 0.75 * 7, 0.1);
}

}  // namespace
}  // namespace gib::hidden_emitters_test
