// Pencils of light: images against the closed form, and the components that plans name as incomplete.

#include "methods/parts/transport/delta_paths.h"
#include "tests/support/scene_fixtures.h"

#include <gmock/gmock.h>

#include <numbers>

namespace gib::test::delta_paths_test {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr double reflectance = 0.6;
const std::string laser = emitter("collimated", to_world(look_at("0.21, 0.13, 2", "0.21, 0.13, 0")), rgb("power", 1));
const std::string fog =
    shape("cube", to_world(scale(0.5), translate(0, 0, 1)), bsdf("null"), "<medium name='interior' type='homogeneous'>",
          number("sigma_t", 1), number("albedo", 0.8), "</medium>");
const std::string mirror = shape("rectangle", to_world(scale(0.1), translate(-2, 0, 1)), bsdf("conductor"));

/// The square [-1, 1]^2 of a floor, seen from above.
LoadedScene floor_under(const std::string& lights_and_more) {
    return scene_of(scene_xml(element("sensor", "orthographic", to_world(look_at("0, 0, 5", "0, 0, 0")), box_film(4)) +
                              shape("rectangle", to_world(scale(3)), diffuse(reflectance)) + lights_and_more));
}

Plan plan_of(const LoadedScene& scene, const std::string& label) {
    return ConfiguredMethod(MethodLabel::parse(label)).create({scene.max_edges})->plan(*scene.scene);
}

// The floor sends reflectance / pi of the power to the camera, as radiance times the area of 4 in view.
TEST(Pencils, AreFoundByTheMethodsThatDoNotNameThemAsLeftOut) {
    const auto scene = floor_under(laser);
    const double expected = reflectance * std::numbers::inv_pi / 4;
    for (const std::string method : {"bidirectional", "light_tracer", "metropolis", "vcm"}) {
        EXPECT_THAT(plan_of(scene, method).unresolved, IsEmpty()) << method;
        const double found = mean_of(*render(scene, method, 64)[Component::direct])[1];
        EXPECT_NEAR(found, expected, 1e-3 * expected) << method;
    }
    for (const std::string method :
         {"path", "guided_path", "photon_mapper", "progressive_photon_mapper", "radiosity"}) {
        EXPECT_THAT(plan_of(scene, method).unresolved, Contains(Component::direct)) << method;
        EXPECT_EQ(mean_of(*render(scene, method, 4)[Component::direct])[1], 0) << method;
    }
}

TEST(Pencils, PlansNameTheComponentsThatPathsFromTheCameraLookFor) {
    const auto unresolved = [](const std::string& more, const std::string& label) {
        return plan_of(floor_under(more), label).unresolved;
    };
    constexpr auto direct = Component::direct, indirect = Component::indirect, volume = Component::volume,
                   caustic = Component::caustic;
    for (const std::string label : {"path", "guided_path"}) {
        EXPECT_THAT(unresolved(laser, label), UnorderedElementsAre(direct, indirect)) << label;
        EXPECT_THAT(unresolved(laser + fog, label), UnorderedElementsAre(direct, indirect, volume)) << label;
        EXPECT_THAT(unresolved(laser + mirror, label), UnorderedElementsAre(direct, indirect, caustic)) << label;
    }
    for (const std::string method : {"photon_mapper", "progressive_photon_mapper"}) {
        EXPECT_THAT(unresolved(laser, method), UnorderedElementsAre(direct)) << method;
        EXPECT_THAT(unresolved(laser + fog, method), UnorderedElementsAre(direct, volume)) << method;
        EXPECT_THAT(unresolved(laser + fog, method + " volume=beams"), UnorderedElementsAre(direct)) << method;
    }
    EXPECT_THAT(unresolved(laser, "photon_mapper gather=16"), UnorderedElementsAre(direct, indirect));
    EXPECT_THAT(unresolved(laser, "radiosity"), UnorderedElementsAre(direct, indirect));
    for (const std::string method : {"bidirectional", "metropolis", "vcm"})
        EXPECT_THAT(unresolved(laser + mirror, method), Contains(direct)) << method << ": seen in the mirror";
}

TEST(Pencils, AreNarrowSpotsAndProjectors) {
    const auto is_left_out = [](const std::string& light) {
        return !plan_of(floor_under(light), "path").unresolved.empty();
    };
    const std::string above = to_world(look_at("0, 0, 2", "0, 0, 0"));
    EXPECT_TRUE(is_left_out(emitter("spot", above, number("cutoff_angle", 0.02))));
    EXPECT_FALSE(is_left_out(emitter("spot", above, number("cutoff_angle", 1))));
    EXPECT_TRUE(is_left_out(emitter("projector", above, rgb("irradiance", 1), number("fov", 0.02))));
    EXPECT_FALSE(is_left_out(emitter("projector", above, rgb("irradiance", 1), number("fov", 1))));
}

TEST(Plans, OfCameraPathsMissTheCausticsOfPointLights) {
    const auto scene = floor_under(shape("sphere", center(0, 0, 0.5), radius(0.4), glass()) + point_light(0, 0, 2, 9));
    for (const std::string method : {"path", "guided_path"})
        EXPECT_TRUE(plan_of(scene, method).missing.has(Effect::caustics)) << method;
    EXPECT_FALSE(plan_of(scene, "vcm").missing.has(Effect::caustics));
}

}  // namespace
}  // namespace gib::test::delta_paths_test
