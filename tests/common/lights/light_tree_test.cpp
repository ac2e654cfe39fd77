// Tests of the choice of one of many lights for a point: bounds against closed forms, the probabilities that it states,
// and the variance of direct light.

#include "common/lights/light_tree.h"

#include "common/sampling/warp.h"
#include "common/scene/scene.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/scene_fixtures.h"

namespace gib::test::light_tree_test {
namespace {

constexpr double pi_d = std::numbers::pi;

const std::string floor_xml = shape("rectangle", to_world(scale(20)));

/// A disk of this radius that faces down.
std::string lamp_xml(double x, double y, double z, double size, double radiance) {
    return shape("disk", to_world(scale(size), rotate('x', 180), translate(x, y, z)), area_light(radiance));
}

std::string spot_xml(double cutoff, double intensity, const std::string& place) {
    return emitter("spot", number("cutoff_angle", cutoff), number("beam_width", 0.75 * cutoff),
                   rgb("intensity", intensity), to_world(place));
}
const std::string aside = look_at("1,0,4", "1,0,0");

const std::string sky_xml = constant_light(0.1);
const std::string sun_xml = emitter("directional", vector("direction", 0.3, 0, -1), rgb("irradiance", 0.5));

/// Lights of every kind over a floor, some of which face away from parts of it.
std::string mixed_lights() {
    std::string xml = floor_xml + spot_xml(40, 8, aside) + sky_xml + sun_xml;
    for (int i = 0; i < 9; ++i) {
        const double x = i - 4, h = 0.5 + 0.3 * i;
        xml += lamp_xml(2 * x, x * x - 3, h, 0.05 * (i + 1), 1 + i) + point_light(x * x - 3, 3 * x, h, 0.1 * (i + 1));
    }
    return xml + shape("sphere", center(-3, 3, 1), radius(0.4), area_light(2));
}

Vec3 random_point(const Sampler& u) { return {8 * u.get_1d(0) - 4, 8 * u.get_1d(1) - 4, 3 * u.get_1d(2)}; }

TEST(EmissionCone, SolidAngleIsThatOfItsLight) {
    const Vec3d z(0, 0, 1);
    EXPECT_NEAR(EmissionCone(z, pi_d, 0).solid_angle(), 4 * pi_d, 1e-12) << "a point";
    EXPECT_NEAR(EmissionCone(z, 0, 0.5 * pi_d).solid_angle(), pi_d, 1e-12) << "a flat surface";
    EXPECT_NEAR(EmissionCone(z, pi_d, 0.5 * pi_d).solid_angle(), 4 * pi_d, 1e-12) << "a sphere";
    EXPECT_NEAR(EmissionCone(z, pi_d / 3, 0).solid_angle(), pi_d, 1e-12) << "a spot";
    // The profile by the midpoint rule: a cone of normals, a spot, a narrow spot without a beam, and one whose fall ends
    // behind.
    for (const auto& [spread, fall] :
         {std::pair(0.4, 0.5 * pi_d), std::pair(0.4, 0.3), std::pair(0.0, 2e-5), std::pair(2.5, 1.1)}) {
        const double end = std::min(spread + fall, pi_d);
        double sum = 0;
        for (int i = 0; i < 10'000; ++i) {
            const double theta = end * (i + 0.5) / 10'000, beyond = std::max(theta - spread, 0.0);
            const double share = 1 - sqr(std::sin(0.5 * beyond) / std::sin(0.5 * fall));
            sum += 2 * pi_d * std::sin(theta) * share * end / 10'000;
        }
        EXPECT_NEAR(EmissionCone(z, spread, fall).solid_angle() / sum, 1, 1e-6) << spread << " " << fall;
    }
}

TEST(EmissionCone, UnionHoldsBothAndIsNoLargerThanItMustBe) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const Sampler u(PointSet::independent, 3, i, 0);
        const Vec3d a = square_to_sphere(u.get_2d(0)).cast<double>().normalized();
        // Every fourth pair is nearly opposite.
        const Vec3d b = i % 4 == 0 ? Vec3d(-a) : Vec3d(square_to_sphere(u.get_2d(1)).cast<double>().normalized());
        const EmissionCone first(a, 2.0 * double{u.get_1d(4)}, 0.3), second(b, 0.5 * double{u.get_1d(5)}, 1.2);
        const EmissionCone both = united(first, second);
        const double between = std::acos(std::clamp(a.dot(b), -1.0, 1.0));
        const double ideal = std::max({first.spread, second.spread, 0.5 * (first.spread + between + second.spread)});
        EXPECT_NEAR(both.spread, std::min(ideal, pi_d), 1e-6);
        EXPECT_EQ(both.fall, 1.2);
        if (both.spread >= pi_d) continue;
        for (const EmissionCone& part : {first, second})
            EXPECT_LT(std::acos(std::clamp(part.axis.dot(both.axis), -1.0, 1.0)) + part.spread, both.spread + 1e-6);
    }
}

// Bounds that grew more than they must, level by level, would make a tree of many lights blind.
TEST(LightBounds, UnionIsTheSmallestBallThatHoldsBoth) {
    for (std::uint64_t i = 0; i < 500; ++i) {
        const Sampler u(PointSet::independent, 13, i, 0);
        const LightBounds a{random_point(u).cast<double>(), double{2 * u.get_1d(4)}, {}, 1};
        const LightBounds b{Vec3d(1, 0, 1), double{u.get_1d(5)}, {}, 2};
        const LightBounds both = united(a, b);
        const double smallest = 0.5 * ((a.center - b.center).norm() + a.radius + b.radius);
        EXPECT_NEAR(both.radius, std::max({smallest, a.radius, b.radius}), 1e-9);
        EXPECT_EQ(both.intensity, 3);
        for (const LightBounds& part : {a, b})
            EXPECT_LE((part.center - both.center).norm() + part.radius, both.radius + 1e-9);
    }
}

// Far from a light, its importance is its irradiance there.
TEST(LightBounds, ImportanceFarAwayIsTheIrradiance) {
    struct Case {
        std::string xml;
        double irradiance;  // 10 below the light
    };
    const double r = 0.1;
    for (const auto& [xml, irradiance] :
         {Case{point_light(0, 0, 10, 3), 0.03}, Case{lamp_xml(0, 0, 10, r, 5), 5 * pi_d * r * r / 100},
          Case{emitter("spot", number("cutoff_angle", 30), number("beam_width", 30), rgb("intensity", 2),
                       to_world(look_at("0,0,10", "0,0,0"))),
               0.02},
          Case{shape("sphere", center(0, 0, 10), radius(0.1), area_light(5)), 5 * pi_d * r * r / 100}}) {
        const auto loaded = load(floor_xml + xml);
        const auto& scene = *loaded.scene;
        const Vec3 below = bounds_of(scene.lights()[0], scene.shapes()).center.cast<float>() - Vec3(0, 0, 10);
        EXPECT_NEAR(bounds_of(scene.lights()[0], scene.shapes()).importance(below) / irradiance, 1, 0.01) << xml;
    }
}

TEST(LightBounds, ALampBehindTheSurfaceHasNoImportance) {
    const LightBounds lamp{Vec3d(0, 0, -1), 0.5, EmissionCone(Vec3d(0, 0, 1), pi_d, 0), 1};
    EXPECT_EQ(lamp.importance(LitPoint(Vec3(0, 0, 0), Vec3(0, 0, 1))), 0);
    EXPECT_GT(lamp.importance(LitPoint(Vec3(0, 0, 0), Vec3(0, 0, -1))), 0);
    EXPECT_GT(lamp.importance(LitPoint(Vec3(0, 0, 0))), 0) << "in a medium";
    EXPECT_GT(lamp.importance(LitPoint(Vec3(0, 0, -0.6f), Vec3(0, 0, 1))), 0) << "part of the lamp is in front";
}

TEST(LightBounds, NoLightShinesWhereItsImportanceIsZero) {
    const auto loaded = load(mixed_lights());
    const auto& scene = *loaded.scene;
    int dark = 0, lit = 0;
    for (std::uint64_t i = 0; i < 5000; ++i) {
        const Sampler u(PointSet::independent, 5, i, 0);
        const Vec3 p = random_point(u), n = i % 2 == 0 ? Vec3(Vec3::Zero()) : square_to_sphere(u.get_2d(3));
        for (const Light& light : scene.lights()) {
            if (!is_point(light) && !std::holds_alternative<AreaLight>(light)) continue;
            const auto sample = sample_light(light, scene.shapes(), p, u.get_2d(4));
            const bool shines = sample && sample->Le.maxCoeff() > 0.f && (n.isZero() || sample->wi.dot(n) > 0.f);
            const bool important = bounds_of(light, scene.shapes()).importance(LitPoint(p, n)) > 0;
            EXPECT_TRUE(important || !shines);
            ++(important ? lit : dark);
        }
    }
    EXPECT_GT(dark, 5000);
    EXPECT_GT(lit, 5000);
}

// The numbers u that lead to a light are a share of [0, 1) that equals the probability by which samples are divided.
TEST(LightTree, LightsAreChosenWithTheirProbability) {
    for (const std::string& xml :
         {mixed_lights(), floor_xml + sky_xml, floor_xml + sky_xml + sun_xml, floor_xml + lamp_xml(0, 0, 2, 1, 1),
          floor_xml + lamp_xml(0, 0, 2, 1, 1) + lamp_xml(3, 0, 2, 1, 1)}) {
        const auto loaded = load(xml);
        const auto& scene = *loaded.scene;
        const LightTree& tree = scene.light_tree();
        for (std::uint64_t i = 0; i < 20; ++i) {
            const Sampler u(PointSet::independent, 7, i, 0);
            const LitPoint p(random_point(u), i % 2 == 0 ? Vec3(Vec3::Zero()) : square_to_sphere(u.get_2d(3)));
            constexpr int steps = 1 << 14;
            std::vector<int> chosen(scene.lights().size());
            for (int k = 0; k < steps; ++k) {
                const auto choice = tree.choose(p, (static_cast<float>(k) + 0.5f) / steps);
                if (!choice) continue;
                ++chosen[choice->light];
                EXPECT_FLOAT_EQ(choice->probability, tree.probability(p, choice->light));
            }
            double sum = 0;
            for (std::uint32_t light = 0; light < chosen.size(); ++light) {
                const double probability = double{tree.probability(p, light)};
                EXPECT_GT(probability, 0);
                sum += probability;
                // The share consists of two intervals, whose four ends fall between the steps.
                EXPECT_NEAR(chosen[light], steps * probability, 2.5) << light;
            }
            EXPECT_LT(sum, 1 + 1e-5);
        }
    }
}

// A lamp of power 0 is no light, and one that is alone is always chosen.
TEST(LightTree, ALightThatIsAloneIsAlwaysChosen) {
    const auto loaded = load(floor_xml + lamp_xml(0, 0, 2, 1, 1));
    const auto choice = loaded.scene->light_tree().choose(Vec3(0, 0, 9), 0.999f);  // behind it
    ASSERT_TRUE(choice);
    EXPECT_EQ(choice->probability, 1.f);
}

/// The second moments of one sample of direct light on a horizontal surface at p, when lights are chosen by the tree
/// and when they are chosen evenly, and the square of its mean.
struct SecondMoments {
    double tree = 0, even = 0, squared_mean = 0;
};
SecondMoments moments_at(const gib::Scene& scene, const Vec3& p, const Vec3& n, int samples) {
    SecondMoments moments;
    double mean = 0;
    const auto count = static_cast<double>(scene.lights().size());
    for (std::uint32_t l = 0; l < scene.lights().size(); ++l) {
        double square = 0;
        mean += moments_over_samples(samples, [&](const Sampler& u) {
                    const auto sample = sample_light(scene.lights()[l], scene.shapes(), p, u.get_2d(1));
                    if (!sample || sample->wi.dot(n) <= 0.f || is_black(sample->Le)) return 0.0;
                    const Vec3 to = sample->target - p;
                    if (scene.occluded(Ray{p, to.normalized(), 0.f, 0.999f * to.norm()})) return 0.0;
                    const double x = double{sample->Le.mean() * sample->wi.dot(n) / sample->pdf_w};
                    square += x * x / samples;
                    return x;
                }).mean();
        if (square == 0) continue;
        moments.tree += square / double{scene.light_tree().probability(LitPoint(p, n), l)};
        moments.even += square * count;
    }
    moments.squared_mean = mean * mean;
    return moments;
}

TEST(LightTree, ASpotUnderADimSkyIsSampledBetterThanByAnEvenChoice) {
    const auto loaded = load(shape("rectangle", to_world(scale(100))) + sky_xml + spot_xml(20, 80, aside));
    const auto& scene = *loaded.scene;
    // The spot ends 1.46 from x = 1. Where it is dim, the sky must not be chosen too rarely.
    for (float x = -3.f; x <= 5.f; x += 0.0625f) {
        const SecondMoments m = moments_at(scene, Vec3(x, 0.1f, 1e-3f), Vec3::UnitZ(), 512);
        EXPECT_LT(m.tree - m.squared_mean, 1.05 * (m.even - m.squared_mean)) << x;
        if (x == 1.f) {
            EXPECT_LT(m.tree / m.squared_mean - 1, 0.5);
        }
    }
}

TEST(LightTree, InAHallOfHiddenLampsItIsNoWorseThanAnEvenChoice) {
    const auto loaded = shipped_scene("many-lights.xml");
    const auto& scene = *loaded.scene;
    for (std::uint64_t i = 0; i < 40; ++i) {
        const Sampler u(PointSet::sobol, 11, i, 0);
        const Ray down{Vec3(10 * u.get_1d(0) - 5, 0.f, 10 * u.get_1d(1) - 5), Vec3(0, -1, 0)};
        const auto hit = scene.intersect(down);
        ASSERT_TRUE(hit);
        const SecondMoments m = moments_at(scene, hit->p + 1e-4f * Vec3::UnitY(), Vec3::UnitY(), 64);
        EXPECT_LT(m.tree, m.even) << hit->p.transpose();
    }
}

}  // namespace
}  // namespace gib::test::light_tree_test
