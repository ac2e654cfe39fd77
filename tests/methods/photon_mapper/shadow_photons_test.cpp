// Shadow photons: where they lie, and direct light sampled with them against plain direct light.
#include "methods/parts/shadow_photons/shadow_photons.h"

#include "methods/parts/shadow_photons/light_visibility.h"
#include "methods/photon_mapper/photon_mapper.h"
#include "tests/support/seed_means.h"

#include <fmt/format.h>
#include <iostream>
#include <map>
#include <numbers>

namespace gib::test::shadow_photons_test {
namespace {

/// A square at z = 2 whose width is twice `half`.
std::string blocker(double half, const std::string& material) {
    return shape("rectangle", to_world(scale(half), translate(0, 0, 2)), material);
}

constexpr int lights_a_side = 4;

/// Lights at z = 4 whose colours and strengths all differ: squares, 0.3 wide, that shine down, or point lights in the middles of
/// these, a tenth as strong.
std::string many_lights(bool squares) {
    std::string xml;
    for (int i = 0; i < lights_a_side; ++i)
        for (int j = 0; j < lights_a_side; ++j) {
            const double x = 1.5 * i - 2.2, y = 1.4 * j - 2.1;
            const auto color = [&](double scale) {
                return fmt::format("{},{},{}", scale * (20 + 15 * i), scale * (20 + 15 * j), scale * 20);
            };
            xml += squares ? shape("rectangle", to_world(scale(0.15), rotate('x', 180), translate(x, y, 4)),
                                   bsdf("diffuse"), area_light(color(1)))
                           : point_light(x, y, 4, color(0.1));
        }
    return xml;
}
const std::string lamps = many_lights(true);

/// A square in the plane z = 0, as wide as the scene. The camera looks at it from just below the blocker at z = 2.
LoadedScene floor_scene(const std::string& body) {
    return Scene(element("integrator", "path", integer("max_depth", 2)),
                 camera(80, to_world(look_at("0,0,1.9", "0,0,0")), box_film(16)),
                 shape("rectangle", to_world(scale(4)), one_sided("0.8")), body)
        .load();
}

std::string label(const char* photons, const char* more = "") {
    return fmt::format("photon_mapper photons=0 shadow_photons={} {}", photons, more);
}

struct DirectLight {
    Image direct;
    RunCounts counts;
};

DirectLight direct_of(const LoadedScene& scene, const std::string& text, std::uint32_t passes, std::uint64_t seed = 1) {
    const Rendered rendered = render_and_count(scene, text, passes, seed);
    return {*rendered.image[Component::direct], rendered.counts};
}

/// The mean of `direct` over the image in each channel, as moments over seeds.
std::array<Moments, 3> means_of(const LoadedScene& scene, const std::string& text, std::uint32_t passes) {
    return means_over_seeds(scene, passes, 16, Component::direct, text);
}

/// Expects the means to differ by at most 5 standard errors of the difference (16 seeds each: by chance once in 5e4
/// comparisons; there are about 20). The errors must be small enough to show 2 %.
void expect_equal_means(const std::array<Moments, 3>& found, const std::array<Moments, 3>& expected) {
    for (std::size_t c = 0; c < 3; ++c) {
        const double error = std::hypot(found[c].standard_error(), expected[c].standard_error());
        EXPECT_NEAR(found[c].mean(), expected[c].mean(), 5 * error) << c;
        EXPECT_LT(5 * error, 0.02 * expected[c].mean()) << c;
    }
}

/// Solid angle of a square of half width a, seen from the distance h above its middle.
double square_solid_angle(double a, double h) { return 4 * std::atan(a * a / (h * std::sqrt(2 * a * a + h * h))); }

// Under a point light the floor receives I times its solid angle. Shadow photons keep all of this power, though the
// blocker hides a part. They are emitted by a net of quasi-random numbers, so their error is far below 1 / sqrt(n).
TEST(ShadowPhotons, LieOnEverySurfaceAsIfNothingStoodInTheWay) {
    const auto scene = floor_scene(blocker(0.5, diffuse(0.5)) + point_light(0, 0, 4, 3));
    const ShadowPhotonResult result = trace_shadow_photons(*scene.scene, 1 << 17, 1);
    std::map<float, double> power, arriving;  // by height above the floor
    const float floor = scene.scene->bounds().lower.z();
    for (const ShadowPhoton& photon : result.photons) {
        const float z = std::round(photon.p.z() - floor);
        EXPECT_EQ(SurfaceSide::side_of_key(photon.surface), 4u);
        power[z] += result.unit * static_cast<double>(photon.power);
        arriving[z] += result.unit * static_cast<double>(photon.power * photon.visibility);
    }
    const double on_floor = 3 * square_solid_angle(4, 4), on_blocker = 3 * square_solid_angle(0.5, 2);
    EXPECT_NEAR(power[0], on_floor, 2e-3 * on_floor);
    EXPECT_NEAR(arriving[0], on_floor - on_blocker, 2e-3 * on_floor);
    EXPECT_NEAR(power[2], on_blocker, 5e-3 * on_blocker);
    EXPECT_EQ(arriving[2], power[2]);
    EXPECT_EQ(result.emitted, 1u << 17);
    EXPECT_GE(result.rays, result.emitted + result.photons.size());
}

// The light emits 8e-43 W in 2^14 photons; as a float in W, the power of each would be 0. In an empty box each path
// meets one surface, so the photons together have pi times radiance times area. The radiance, the size (twice in an
// area), the area and each power are rounded.
TEST(ShadowPhotons, FaintLightLosesNone) {
    const auto scene =
        Scene(element("sensor", "perspective"),
              shape("cube", flag("flip_normals"), to_world(scale(1e-12)), diffuse(0.5), area_light(1e-20)))
            .load();
    const ShadowPhotonResult result = trace_shadow_photons(*scene.scene, 1 << 14, 1);
    double sum = 0;
    for (const ShadowPhoton& photon : result.photons)
        sum += result.unit * static_cast<double>(photon.power);
    EXPECT_EQ(result.photons.size(), 1u << 14);
    EXPECT_NEAR(sum / (std::numbers::pi * 1e-20 * 24e-24), 1, 5 * 0x1p-24);
}

/// A hit on the floor, on the side that the lights shine at.
SurfaceHit floor_hit(const gib::Scene& scene, float x, float y) {
    return scene.intersect({Vec3(x, y, scene.bounds().lower.z() - 1.f), Vec3::UnitZ()}).value();
}

// The share of numbers u that lead to a light is the probability that the estimator divides by. Every light has a
// positive one.
TEST(ShadowPhotons, LightsAreChosenWithTheirProbability) {
    const auto loaded = floor_scene(blocker(0.6, diffuse(0.5)) + lamps);
    const gib::Scene& scene = *loaded.scene;
    const LightVisibility map(scene, trace_shadow_photons(scene, 20000, 1).photons);
    constexpr int steps = 1 << 14;
    for (const float x : {-2.f, -0.3f, 0.f, 1.1f}) {
        const SurfaceHit hit = floor_hit(scene, x, 0.4f);
        const Vec3 wo = Vec3::UnitZ();
        std::vector<int> chosen(scene.lights().size());
        for (int i = 0; i < steps; ++i) {
            const auto choice = map.choose(hit, wo, (static_cast<float>(i) + 0.5f) / steps);
            if (!choice) continue;
            EXPECT_FLOAT_EQ(choice->probability, map.probability(hit, wo, choice->light));
            ++chosen[choice->light];
        }
        for (std::uint32_t light = 0; light < chosen.size(); ++light) {
            const double probability = static_cast<double>(map.probability(hit, wo, light));
            EXPECT_NEAR(chosen[light], steps * probability, 2.5) << light;
            EXPECT_GT(probability, 0) << light;
        }
    }
}

// With few photons, many regions are wrong about many lights; the estimate must not depend on this.
TEST(ShadowPhotons, GuidingIsUnbiasedHoweverFewTheyAre) {
    const auto scene = floor_scene(blocker(0.9, diffuse(0.5)) + lamps);
    const auto expected = means_of(scene, "path", 256);
    for (const char* photons : {"60", "600", "60000"}) {
        SCOPED_TRACE(photons);
        expect_equal_means(means_of(scene, label(photons), 128), expected);
    }
}

// A mask lets half of the light through its holes, so its photons can say neither lit nor dark.
TEST(ShadowPhotons, HolesThatLetAPartThroughAreLeftToRays) {
    const std::string mask = bsdf("mask", number("opacity", 0.5), bsdf("diffuse"));
    const auto holes = floor_scene(blocker(40, mask) + lamps);
    const auto open = floor_scene(blocker(40, bsdf("null")) + lamps);
    const auto whole = means_of(floor_scene(lamps), "path", 128);
    auto half = means_of(holes, label("1e5"), 128);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(half[c].mean() / whole[c].mean(), 0.5, 0.01);
    expect_equal_means(means_of(open, label("1e5"), 128), whole);
}

// Light through glass is a caustic, so every photon behind glass is a shadow photon.
TEST(ShadowPhotons, GlassAndMirrorsCastShadows) {
    const auto scene = shipped_scene("lamp-in-glass.xml", {{}, std::pair{16, 16}});
    EXPECT_EQ(mean_of(direct_of(scene, label("1e4"), 4).direct).maxCoeff(), 0);
}

// The lights are two lamps (one with a dark half), a point, a spot, sunlight and sky. A
// sphere stands on the floor, under a blocker.
TEST(ShadowPhotons, EveryKindOfLightIsRight) {
    const std::string half_dark =
        "<texture name='radiance' type='checkerboard'>" + rgb("color0", 0.0) + rgb("color1", "20,4,4") + "</texture>";
    const auto scene = floor_scene(
        blocker(0.7, diffuse(0.5)) + shape("sphere", center(0.9, 0.2, 0.4), radius(0.4), diffuse(0.6)) +
        shape("rectangle", to_world(scale(0.5), rotate('x', 180), translate(-1, 0.5, 3.5)), bsdf("diffuse"),
              emitter("area", half_dark)) +
        shape("sphere", center(1.5, 1, 3), radius(0.2), area_light("4,20,4")) + point_light(1, -1, 3, "4,4,9") +
        emitter("spot", to_world(look_at("-1,-2,3", "0,0,0", "0,0,1")), rgb("intensity", "20,10,3"),
                number("cutoff_angle", 25)) +
        emitter("directional", vector("direction", 0.3, 0.4, -1), rgb("irradiance", "1,1,0.5")) +
        constant_light("0.2,0.3,0.5"));
    const auto expected = means_of(scene, "path", 512);
    expect_equal_means(means_of(scene, label("2e5"), 256), expected);
}

TEST(ShadowPhotons, ImagesAreTheSameForAnyNumberOfThreads) {
    const auto scene = shipped_scene("many-lights.xml", {{}, std::pair{24, 18}});
    // The photons are so many that regions are built in parallel.
    const Image one = *render(scene, label("1e5"), 1, 1, 1)[Component::direct];
    for (const int threads : {2, 5})
        EXPECT_EQ(one.rgb, (*render(scene, label("1e5"), 1, 1, threads)[Component::direct]).rgb) << threads;
}

}  // namespace
}  // namespace gib::test::shadow_photons_test
