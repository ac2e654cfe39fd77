// The starts of light walks, half of which are aimed at specular surfaces.

#include "methods/parts/vertices/light_emission.h"

#include "common/scene/scene.h"
#include "tests/support/lit_rooms.h"

#include <gtest/gtest.h>

namespace gib::light_emission_test {
namespace {

using namespace test::lit_rooms;
using test::room;

constexpr std::uint32_t count = 40000;

const std::string small_lamp =
    "<shape type='rectangle'><transform name='to_world'><scale value='0.05'/><rotate x='1' angle='90'/>"
    "<translate x='0.6' y='1'/></transform><emitter type='area'><rgb name='radiance' value='5, 4, "
    "3'/></emitter></shape>";

/// A ball of glass that most light misses.
LoadedScene room_with_glass(const std::string& light) {
    return room({.light = light, .glossy_wall = "", .ball = glass_ball});
}

// The mean power of starts is the lights' own, whether they are aimed or not. Five standard errors: the seven comparisons
// fail by chance with a probability of 4e-6. All starts of a sky have the same power, up to the rounding of floats. The aimed starts with another density, or without the dropping of those that meet no target, fail it.
TEST(LightEmission, CarriesThePowerOfTheLights) {
    for (const std::string& light : {small_lamp, shining_ball, point, spot, sun, sky, small_lamp + point + sun}) {
        const LoadedScene loaded = room_with_glass(light);
        const LightEmission aimed(*loaded.scene, true);
        double sum = 0, squares = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto start = aimed.sample(Sampler(PointSet::independent, 1, i, 0));
            const double power = start ? start->sample.power.sum() : 0;
            sum += power;
            squares += power * power;
        }
        const double mean = sum / count, error = std::sqrt(std::max(squares / count - mean * mean, 0.) / count);
        EXPECT_NEAR(mean, loaded.scene->emitted_power().sum(), 5 * error + 1e-6 * mean) << light;
    }
}

// Power times density is what the light emits there, so it has the same value over the cosine for all starts of a light
// that shines evenly. Both are floats, and the cosine of a grazing start has few digits left: 1e-4.
TEST(LightEmission, DensityIsThatOfTheStarts) {
    for (const std::string& light : {small_lamp, shining_ball, point, sun, sky}) {
        const LoadedScene loaded = room_with_glass(light);
        const auto emitted = [&](const LightEmission& emission, std::uint32_t i) {
            const auto start = emission.sample(Sampler(PointSet::independent, 2, i, 0));
            return start ? start->sample.power.sum() * start->density / double{start->cos_light} : 0;
        };
        const double expected = emitted(LightEmission(*loaded.scene, false), 0);
        const LightEmission aimed(*loaded.scene, true);
        for (std::uint32_t i = 0; i < 1000; ++i) {
            const double value = emitted(aimed, i);
            if (value != 0) {
                EXPECT_NEAR(value, expected, 1e-4 * expected) << light;
            }
        }
    }
}

TEST(LightEmission, SendsMoreStartsToSpecularSurfaces) {
    const LoadedScene loaded = room_with_glass(small_lamp);
    const auto share = [&](bool aims) {
        const LightEmission emission(*loaded.scene, aims);
        double hits = 0;
        for (std::uint32_t i = 0; i < count; ++i)
            if (const auto start = emission.sample(Sampler(PointSet::independent, 3, i, 0))) {
                const auto hit = loaded.scene->intersect(start->sample.ray);
                hits += hit && hit->bsdf->traits_at(1.f).delta;
            }
        return hits / count;
    };
    EXPECT_GT(share(true), 3 * share(false));
    // Without a specular surface there is nothing to aim at.
    const LoadedScene plain = room({.light = small_lamp, .glossy_wall = "", .ball = "<bsdf type='diffuse'/>"});
    const Sampler sampler(PointSet::independent, 4, 0, 0);
    EXPECT_EQ(LightEmission(*plain.scene, true).sample(sampler)->density,
              LightEmission(*plain.scene, false).sample(sampler)->density);
}

}  // namespace
}  // namespace gib::light_emission_test
