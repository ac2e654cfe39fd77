// Tests of lamps that are mesh files: the light does not depend on how the file parts the lamp's surface.

#include "common/scene/scene.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>
#include <numbers>

namespace gib::test::mesh_lamp_test {
namespace {

/// The irradiance [W/m^2] at a point of the floor, by a midpoint rule over the light's samples.
double irradiance(const Scene& scene, const Vec3& p) {
    constexpr int steps = 32;
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const Vec2 u((static_cast<float>(i) + 0.5f) / steps, (static_cast<float>(j) + 0.5f) / steps);
            const auto sample = scene.sample_light(p, 0.5f, u);
            if (!sample) continue;
            sum += double{sample->Le[0] * sample->wi.z() / sample->pdf_w};
        }
    return sum / (steps * steps);
}

/// The mean irradiance [W/m^2] of the square [-0.5, 0.5]^2 in z = 0, by a midpoint rule.
double mean_irradiance(const LoadedScene& loaded) {
    constexpr int steps = 16;
    const Vec3 lowered(0, 0, -0.5f);  // the scene's centre is at z = 0.5
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            sum += irradiance(*loaded.scene, lowered + Vec3((static_cast<float>(i) + 0.5f) / steps - 0.5f,
                                                            (static_cast<float>(j) + 0.5f) / steps - 0.5f, 0));
    return sum / (steps * steps);
}

TEST(LampMesh, TheLightOfASquareDoesNotDependOnItsFaces) {
    const std::string corners = "v -0.5 -0.5 1\nv 0.5 -0.5 1\nv 0.5 0.5 1\nv -0.5 0.5 1\n";
    const std::pair<const char*, std::string> lamps[] = {
        {"two triangles", corners + "f 1 3 2\nf 1 4 3\n"},
        {"a fan about the centre", corners + "v 0 0 1\nf 5 2 1\nf 5 1 4\nf 5 4 3\nf 5 3 2\n"},
        {"needles", corners + "f 1 3 2\nf 1 4 3\nf 1 1 2\nf 1 1 2\n"},
        {"a notch apart", corners + "v 0 0.4 1\nf 3 2 5 1 4\nf 1 5 2\n"},
        {"a byte order mark", "\xEF\xBB\xBF" + corners + "v -0.4 0.5 1\nf 1 4 3 2\n"}};
    const TemporaryFolder folder;
    for (const auto& [name, text] : lamps) {
        folder.write("lamp.obj", text);
        const auto loaded =
            load_scene(folder.write("s.xml", scene_with(shape("rectangle", to_world(scale(3))) +
                                                        shape("obj", filename("lamp.obj"), area_light(1)))));
        EXPECT_NEAR(loaded.scene->emitted_power()[0], std::numbers::pi, 1e-5) << name;
        // The form factor of two parallel unit squares at distance 1 (Howell, configuration C-11) is 0.199825.
        EXPECT_NEAR(mean_irradiance(loaded) / std::numbers::pi, 0.199825, 5e-4) << name;
    }
}

}  // namespace
}  // namespace gib::test::mesh_lamp_test
