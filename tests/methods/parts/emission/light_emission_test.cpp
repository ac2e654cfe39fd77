// Starts of light paths, aimed or not: they carry the power of the lights, and know their density.
#include "methods/parts/emission/light_emission.h"

#include "common/scene/scene.h"
#include "methods/parts/emission/projection_map.h"
#include "tests/support/lit_rooms.h"
#include "tests/support/moments.h"

#include <gtest/gtest.h>

namespace gib::test::light_emission_test {
namespace {

using namespace lit_rooms;

constexpr std::uint32_t count = 40000;

const std::string small_lamp = lamp_of(0.05);

/// A ball of glass that most light misses.
LoadedScene room_with_glass(const std::string& light) {
    return room({.light = light, .glossy_wall = "", .ball = glass_ball});
}

LightEmission at_specular(const gib::Scene& scene) {
    return LightEmission(scene, LightEmission::towards_specular(scene));
}

/// Starts that two maps aim, at a ball and at a larger one around it.
LightEmission aimed_at_balls(const gib::Scene& scene) {
    LightEmission::Maps maps;
    for (const float radius : {0.2f, 0.6f}) {
        const ProjectionTargets::Ball ball{Vec3::Zero(), radius, ProjectionTargets::no_shape, false};
        maps.push_back(std::make_shared<ProjectionMap>(scene, ProjectionTargets({ball}), 1 << 12));
    }
    return LightEmission(scene, std::move(maps));
}

// The mean power of starts is the lights' own, whether they are aimed or not. Five standard errors: the fourteen
// comparisons fail by chance with a probability of 8e-6. All starts of a sky have the same power, up to the rounding of floats. The aimed starts with another density, or without the dropping of those that meet no target, fail it.
TEST(LightEmission, CarriesThePowerOfTheLights) {
    for (const std::string& light :
         {small_lamp, shining_ball, lit_rooms::point, spot, sun, sky, small_lamp + lit_rooms::point + sun}) {
        const LoadedScene loaded = room_with_glass(light);
        for (const LightEmission& aimed : {at_specular(*loaded.scene), aimed_at_balls(*loaded.scene)}) {
            Moments power;
            for (std::uint32_t i = 0; i < count; ++i) {
                const auto start = aimed.sample(Sampler(PointSet::independent, 1, i, 0));
                power.add(start ? start->sample.power.sum() : 0);
            }
            EXPECT_NEAR(power.mean(), loaded.scene->emitted_power().sum(),
                        5 * power.standard_error() + 1e-6 * power.mean())
                << light;
        }
    }
}

// Power times density is what the light emits there, so it has the same value over the cosine for all starts of a light
// that shines evenly. Both are floats, and the cosine of a grazing start has few digits left: 1e-4.
TEST(LightEmission, DensityIsThatOfTheStarts) {
    for (const std::string& light : {small_lamp, shining_ball, lit_rooms::point, sun, sky}) {
        const LoadedScene loaded = room_with_glass(light);
        const auto emitted = [&](const LightEmission& emission, std::uint32_t i) {
            const auto start = emission.sample(Sampler(PointSet::independent, 2, i, 0));
            return start ? start->sample.power.sum() * start->density / double{start->cos_light} : 0;
        };
        const double expected = emitted(LightEmission(*loaded.scene), 0);
        for (const LightEmission& aimed : {at_specular(*loaded.scene), aimed_at_balls(*loaded.scene)})
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
        const LightEmission emission = aims ? at_specular(*loaded.scene) : LightEmission(*loaded.scene);
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
    const LoadedScene plain = room({.light = small_lamp, .glossy_wall = "", .ball = diffuse_ball});
    const Sampler sampler(PointSet::independent, 4, 0, 0);
    EXPECT_EQ(at_specular(*plain.scene).sample(sampler)->density, LightEmission(*plain.scene).sample(sampler)->density);
}

}  // namespace
}  // namespace gib::test::light_emission_test
