// Tests of emitters against closed forms: power, irradiance, emission, and the densities
// by which methods weight samples.

#include "common/lights/light_choice.h"
#include "common/scene/effects.h"
#include "common/scene/scene.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/scene_builder.h"

namespace gib::test::light_test {
namespace {

constexpr double pi_d = std::numbers::pi;
constexpr double degree = pi_d / 180;

/// A black ball of radius 1 around the origin, the surface in the lights' scenes.
const std::string ball = shape("sphere", one_sided("0"));

std::string spot_xml(double cutoff, double beam, const std::string& more) {
    return emitter("spot", number("cutoff_angle", cutoff), number("beam_width", beam), more);
}

const std::string checkers = named("texture", "texture", "checkerboard", rgb("color0", "1 0 0.5"),
                                   rgb("color1", "0 1 0.1"), to_uv(scale(3, 2, 1)));

/// Irradiance [W/m^2] in one channel at p with normal n, from samples of all lights without a test of visibility.
Moments irradiance(const gib::Scene& scene, const Vec3& p, const Vec3& n, int channel, int samples) {
    return moments_over_samples(samples, [&](const Sampler& sampler) {
        const auto light = scene.sample_light(p, sampler.get_1d(0), sampler.get_2d(1));
        if (!light) return 0.0;
        EXPECT_NEAR(light->wi.norm(), 1.f, 1e-6f);
        return double{light->Le[channel] * std::max(light->wi.dot(n), 0.f) / light->pdf_w};
    });
}

/// The power [W] of a spot by the midpoint rule over its cone.
Colord spot_power(const SpotLight& spot, double cutoff) {
    constexpr int rings = 2000, sectors = 360;
    Colord sum = Colord::Zero();
    for (int i = 0; i < rings; ++i) {
        const double theta = cutoff * (i + 0.5) / rings;
        for (int j = 0; j < sectors; ++j) {
            const double phi = 2 * pi_d * (j + 0.5) / sectors;
            const Vec3 w =
                Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)).cast<float>();
            sum += std::sin(theta) * spot.intensity(w).cast<double>();
        }
    }
    return sum * (cutoff / rings) * (2 * pi_d / sectors);
}

// The spheres are so small that their centre and the points on them round to the same floats or to neighbours.
TEST(AreaLight, SpheresOfSomeUlpsShineFromTheSideThatIsSeen) {
    const Vec3 center(4.3f, -1.7f, 5.f);
    for (const float radius : {1e-9f, 1e-8f, 1e-7f, 3e-7f, 1e-6f}) {
        const std::vector<Shape> shapes = {Sphere{center, radius}};
        const AreaLight light(0, shapes[0], Texture(Color(Color::Ones())));
        for (const float phi : {0.f, 1.f, 2.f, 3.f, 4.f, 5.f}) {
            const Vec3 p = center + Vec3(2.f * std::cos(phi), 3.f * std::sin(phi), -4.f);
            const auto sample = sample_light(light, shapes, p, Vec2(0.f, 0.5f));  // the middle of its disc
            ASSERT_TRUE(sample);
            EXPECT_LT((sample->target - center).normalized().dot(sample->wi), -0.9f) << radius << ' ' << phi;
            const EmissionSample start = sample_emission(light, shapes, Vec2(0.3f, 0.2f * phi), Vec2(0.f, 0.2f * phi));
            EXPECT_NEAR(start.normal.norm(), 1.f, 1e-6f) << radius << ' ' << phi;
            EXPECT_GT((start.ray.o - center).normalized().dot(start.normal), 0.9f) << radius << ' ' << phi;
        }
    }
}

TEST(SpotLight, PowerIsTheIntegralOfItsIntensity) {
    for (const auto& [cutoff, beam] : {std::pair(20.0, 15.0), std::pair(20.0, 0.0), std::pair(20.0, 20.0),
                                       std::pair(180.0, 90.0), std::pair(180.0, 180.0), std::pair(0.01, 0.004)}) {
        const auto scene = load(ball + spot_xml(cutoff, beam, rgb("intensity", "2 1 3")));
        const auto& spot = std::get<SpotLight>(scene.scene->lights()[0]);
        const Colord expected = spot_power(spot, cutoff * degree);
        EXPECT_TRUE(((power_of(spot) / expected - 1).abs() <= 1e-3).all()) << cutoff << ' ' << beam;
    }
    const auto scene = load(ball + spot_xml(40, 30, checkers));
    const auto& spot = std::get<SpotLight>(scene.scene->lights()[0]);
    const Colord expected = spot_power(spot, 40 * degree);
    EXPECT_TRUE(((power_of(spot) / expected - 1).abs() <= 3e-3).all());
}

// The spot shines from (1, 2, 3) along +x and its y is along z, because Mitsuba's lookat has left = up x forward.
TEST(SpotLight, FallsOffLinearlyInAngleFromBeamToCutoff) {
    const auto scene =
        load(ball + spot_xml(40, 10, rgb("intensity", 6) + to_world(scale(2), look_at("1,2,3", "5,2,3", "0,0,1"))));
    const auto at = [&](double angle) {
        const Vec3 p = Vec3(1, 2, 3) + 2 * Vec3d(std::cos(angle * degree), 0.6 * std::sin(angle * degree),
                                                 -0.8 * std::sin(angle * degree))
                                               .cast<float>();
        const auto sample = scene.scene->sample_light(p, 0.f, Vec2(0.5f, 0.5f));
        if (!sample) return 0.0;
        EXPECT_TRUE(sample->delta);
        EXPECT_EQ(sample->pdf_w, 1.f);
        EXPECT_TRUE(sample->target.isApprox(Vec3(1, 2, 3)));
        return static_cast<double>(sample->Le[0]);
    };
    EXPECT_NEAR(at(0), 6.0 / 4, 1e-5);
    EXPECT_NEAR(at(9.99), 6.0 / 4, 1e-5);
    EXPECT_NEAR(at(20), 6.0 / 4 * 20 / 30, 1e-5);
    EXPECT_NEAR(at(39), 6.0 / 4 * 1 / 30, 1e-5);
    EXPECT_EQ(at(40.01), 0);
    EXPECT_EQ(at(180), 0);
}

// The beam is narrower than a cosine in float can resolve near the axis: 1 - cos(0.005 degrees) is 4e-9.
TEST(SpotLight, NarrowBeamsKeepTheirFallOff) {
    const auto scene = load(ball + spot_xml(0.01, 0, to_world(translate(0, 0, -100))));
    for (const double share : {0.1, 0.5, 0.9}) {
        const double angle = (1 - share) * 0.01 * degree;
        const auto sample =
            scene.scene->sample_light(Vec3(static_cast<float>(100 * std::tan(angle)), 0, 0), 0.f, Vec2(0.5f, 0.5f));
        ASSERT_TRUE(sample);
        EXPECT_NEAR(sample->Le[0] * 1e4, share, 1e-3);
    }
}

// The texture fills the square around the cut-off circle: u grows along x, v along y.
TEST(SpotLight, ProjectsItsTexture) {
    const auto scene = load(
        ball + spot_xml(45, 45, named("texture", "texture", "checkerboard", rgb("color0", 1), rgb("color1", 0.25))));
    const auto& slide = std::get<SpotLight>(scene.scene->lights()[0]);
    EXPECT_EQ(slide.intensity(Vec3(0.3f, 0.3f, 1).normalized())[0], 1.f);
    EXPECT_EQ(slide.intensity(Vec3(-0.3f, -0.3f, 1).normalized())[0], 1.f);
    EXPECT_EQ(slide.intensity(Vec3(-0.3f, 0.3f, 1).normalized())[0], 0.25f);
    EXPECT_EQ(slide.intensity(Vec3(0.9f, 0.9f, 1).normalized())[0], 0.f);
}

TEST(DirectionalLight, IrradianceIsThatOfParallelLight) {
    for (const std::string& place :
         {vector("direction", 0, 3, -4), to_world(scale(5), look_at("7,7,7", "7,10,3", "1,0,0"))}) {
        const auto scene = load(ball + emitter("directional", rgb("irradiance", "2 4 6"), place));
        const auto sample = scene.scene->sample_light(Vec3(0, 0, 1), 0.f, Vec2(0.5f, 0.5f));
        ASSERT_TRUE(sample);
        EXPECT_TRUE(sample->wi.isApprox(Vec3(0, -0.6f, 0.8f)));
        EXPECT_TRUE(sample->delta);
        EXPECT_NEAR(irradiance(*scene.scene, Vec3(0, 0, 1), Vec3::UnitZ(), 1, 16).mean(), 4 * 0.8, 1e-5);
        // From any point, the shadow ray ends outside of the scene's bounds.
        for (const Vec3& p : {Vec3(0, 0, 1), Vec3(0, 30, -40)})
            EXPECT_GT(scene.scene->sample_light(p, 0.f, Vec2())->target.norm(), 1.8f);
        // The light's power is the flux through the sphere around the ball's box, of radius sqrt(3).
        EXPECT_NEAR(scene.scene->emitted_power()[0], 2 * 3 * pi_d, 1e-3);
    }
}

TEST(Environment, IrradianceOfAConstantOneIsPiL) {
    const auto scene = load(ball + constant_light("1 2 3"));
    const Moments E = irradiance(*scene.scene, Vec3(0, 0, 1), Vec3(0.6f, 0, 0.8f), 2, 200'000);
    EXPECT_NEAR(E.mean(), 3 * pi_d, 4 * E.standard_error());
    EXPECT_NEAR(scene.scene->environment_pdf_w(Vec3(0, 0, 0), Vec3::UnitX()), 1 / (4 * pi_d), 1e-7);
    EXPECT_EQ(scene.scene->environment_radiance(Vec3::UnitX())[1], 2.f);
    EXPECT_NEAR(scene.scene->emitted_power()[0], 4 * pi_d * 3 * pi_d, 1e-2);
}

TEST(Environment, IrradianceOfAMapIsItsIntegral) {
    const TemporaryFolder folder;
    const Image image =
        image_of(16, 9, [](int x, int y) { return Color((x == 3 && y == 2 ? 500.f : 1.f) * noise(x, y)); });
    const auto scene =
        load(ball + envmap_xml(folder, image, number("scale", 2) + to_world("<rotate x='1' y='2' angle='33'/>")));
    const Vec3 n = Vec3(1, 2, -2) / 3.f;
    // A rotation keeps solid angle, so quadrature in world space needs no correction for it.
    const double expected = sphere_integral(90, 180, 4, [&](const Vec3& w) {
        return static_cast<double>(scene.scene->environment_radiance(w)[0] * std::max(w.dot(n), 0.f));
    });
    const Moments E = irradiance(*scene.scene, n, n, 0, 100'000);
    EXPECT_NEAR(E.mean(), expected, 4 * E.standard_error() + 1e-3 * expected);
    EXPECT_LT(E.standard_error(), 0.01 * expected);
}

TEST(Environment, ToWorldTurnsTheMap) {
    const TemporaryFolder folder;
    const Image image = image_of(8, 5, noise);
    const auto radiance = [&](const std::string& transform, const Vec3& w) {
        return load(ball + envmap_xml(folder, image, to_world(transform))).scene->environment_radiance(w);
    };
    const auto texel = [](double column, double row) {
        return envmap_direction(pi_d * row / 4, 2 * pi_d * (column + 0.5) / 8);
    };
    const Vec3 w = texel(2, 1);
    EXPECT_TRUE(radiance(scale(1), w).isApprox(noise(2, 1), 1e-4f));
    // A right-handed turn about y by 90 degrees takes z to x: (x, y, z) comes from (-z, y, x).
    EXPECT_TRUE(radiance(rotate('y', 90), Vec3(w.z(), w.y(), -w.x())).isApprox(noise(2, 1), 1e-4f));
    EXPECT_TRUE(radiance(rotate('x', 90), Vec3(w.x(), -w.z(), w.y())).isApprox(noise(2, 1), 1e-4f));
    EXPECT_TRUE(radiance(scale(-1, 1, 1), Vec3(-w.x(), w.y(), w.z())).isApprox(noise(2, 1), 1e-4f));
    EXPECT_TRUE(radiance(translate(9, 0, 0), w).isApprox(noise(2, 1), 1e-4f));
}

TEST(Environment, AFarSceneMovesLightsButTurnsNone) {
    const auto scene = load(shape("sphere", center(1e8, -2e8, 0.25)) +
                            emitter("spot", to_world(look_at("1e8,-2e8,5.25", "1e8,-2e8,0"))) +
                            emitter("directional", vector("direction", 1, 0, 0)) + emitter("constant"));
    EXPECT_TRUE(std::get<SpotLight>(scene.scene->lights()[0]).position().isApprox(Vec3(0, 0, 5)));
    EXPECT_EQ(std::get<DirectionalLight>(scene.scene->lights()[1]).direction, Vec3(1, 0, 0));
    EXPECT_LT(std::get<ConstantEnvironment>(scene.scene->lights()[2]).scene.center.norm(), 1e-6f);
}

/// A black lamp of 4 x 2 in z = 4 that shines downwards.
std::string lamp(const std::string& radiance) {
    return shape("rectangle", to_world(scale(2, 1, 1), rotate('x', 180), translate(0, 0, 4)), one_sided("0"),
                 emitter("area", radiance));
}
const std::string squares =
    named("texture", "radiance", "checkerboard", rgb("color0", "8 0 1"), rgb("color1", "0 2 1"), to_uv(scale(2, 1, 1)));

TEST(AreaLight, TexturesFollowTheUvOfTheShape) {
    const auto scene = load(lamp(squares));
    const auto Le = [&](float x, float y) {
        const auto hit = scene.scene->intersect({Vec3(x, y, -9), Vec3(0, 0, 1)});
        EXPECT_TRUE(hit && hit->emitter);
        EXPECT_TRUE(is_black(hit->Le(Vec3(0, 0, 1)))) << "the back emits nothing";
        return hit->Le(Vec3(0, 0, -1));
    };
    // u grows along x; the turn about x makes v grow towards -y. The squares are a quarter
    // by a half of the lamp's 4 x 2.
    EXPECT_TRUE(Le(-1.5f, 0.5f).isApprox(Color(8, 0, 1)));
    EXPECT_TRUE(Le(-0.5f, 0.5f).isApprox(Color(0, 2, 1)));
    EXPECT_TRUE(Le(-1.5f, -0.5f).isApprox(Color(0, 2, 1)));
    EXPECT_TRUE(Le(1.5f, -0.5f).isApprox(Color(8, 0, 1)));
    // Each colour covers half of the area: the power is pi A (L0 + L1) / 2.
    EXPECT_TRUE(((scene.scene->emitted_power() - pi_d * 8 * Colord(4, 1, 1)).abs() <= 2e-3 * pi_d * 8).all());
}

// A sample of an area light must agree with the hit of a ray towards it.
TEST(AreaLight, SamplesAgreeWithRaysThatHitThem) {
    const std::string shining = one_sided("0") + emitter("area", squares);
    for (const std::string& lit : {lamp(squares), shape("sphere", shining), shape("disk", shining),
                                   shape("cube", shining), shape("sphere", flag("flip_normals"), shining)}) {
        const auto scene = load(lit);
        int found = 0;
        for (std::uint32_t i = 0; i < 500; ++i) {
            const Sampler sampler(PointSet::sobol, 9, 0, i);
            const Vec3 p = 3.f * square_to_sphere(sampler.get_2d(1)) * sampler.get_1d(2);
            const auto light = scene.scene->sample_light(p, 0.f, sampler.get_2d(0));
            if (!light) continue;
            const auto hit = scene.scene->intersect({p, light->wi});
            ASSERT_TRUE(hit) << lit;
            // Another part of the same light may be in front, and rays near the rim of a sphere miss by rounding.
            if (std::abs((hit->p - p).norm() - light->distance) > 1e-3f) continue;
            ++found;
            EXPECT_NEAR(scene.scene->light_pdf_w(p, *hit) / light->pdf_w, 1.f, 0.02f) << lit;
            const Color Le = hit->Le(-light->wi);
            found -= !Le.isApprox(light->Le, 1e-3f);  // next to an edge of a square
        }
        EXPECT_GT(found, 50) << lit;
    }
}

/// Lights of every kind, each alone in a scene with the ball.
std::vector<std::pair<std::string, std::string>> every_light(const TemporaryFolder& folder) {
    const Image image =
        image_of(9, 6, [](int x, int y) { return Color((x == 3 && y == 2 ? 30.f : 1.f) * noise(x, y)); });
    return {{"point", emitter("point", point("position", 0, 0, 3))},
            {"spot", spot_xml(70, 20, rgb("intensity", "1 2 3"))},
            {"slide", spot_xml(50, 20, checkers)},
            {"projector", emitter("projector", number("fov", 50), rgb("irradiance", "1 2 3"),
                                  to_world(look_at("0,0,3", "0.5,0,0")))},
            {"directional", emitter("directional", rgb("irradiance", "1 2 3"))},
            {"constant", constant_light("1 2 3")},
            {"envmap", envmap_xml(folder, image)},
            {"sunsky", emitter("sunsky", vector("sun_direction", 1, 2, 2), number("sun_aperture", 4))},
            {"area", lamp(rgb("radiance", "1 2 3"))},
            {"textured area", lamp(squares)}};
}

TEST(EveryLight, MeanOfEmissionIsThePower) {
    const TemporaryFolder folder;
    for (const auto& [name, xml] : every_light(folder)) {
        const auto scene = load(ball + xml);
        const Colord power = scene.scene->emitted_power();
        for (int c = 0; c < 3; ++c) {
            const Moments mean = moments_over_samples(100'000, [&](const Sampler& sampler) {
                const auto start =
                    scene.scene->sample_emission(sampler.get_1d(0), sampler.get_2d(1), sampler.get_2d(2));
                EXPECT_NEAR(start.ray.d.norm(), 1.f, 1e-5f);
                return start.power[c];
            });
            // The power of a textured light is a sum over 65536 points, with an error of 2e-3.
            EXPECT_NEAR(mean.mean(), power[c], 4 * mean.standard_error() + 2e-3 * power[c]) << name;
        }
    }
}

// The power of emitted rays that hit the ball equals the irradiance of the ball's surface, sampled from the lights
// and integrated over the ball. The two estimates are independent.
TEST(EveryLight, EmittedRaysCarryTheIrradianceOfSampledLight) {
    const TemporaryFolder folder;
    const std::string above = to_world(look_at("0,0,3", "0.5,0,0"));
    auto lights = every_light(folder);
    lights[1].second = spot_xml(30, 10, above);
    lights[2].second = spot_xml(30, 10, above + checkers);
    for (const auto& [name, xml] : lights) {
        const auto scene = load(ball + xml);
        const auto& s = *scene.scene;
        // Loading moves the scene by the centre of its box, which a lamp above the ball shifts.
        const auto& sphere = std::get<Sphere>(s.shapes()[0]);
        const auto hits_ball = [&](const Ray& ray) { return intersect(sphere, ray).has_value(); };
        const Moments followed = moments_over_samples(200'000, [&](const Sampler& sampler) {
            const auto start = s.sample_emission(sampler.get_1d(0), sampler.get_2d(1), sampler.get_2d(2));
            return hits_ball(start.ray) ? start.power[1] : 0.0;
        });
        const Moments received = moments_over_samples(200'000, [&](const Sampler& sampler) {
            const Vec3 n = square_to_sphere(sampler.get_2d(3));
            const auto light = s.sample_light(sphere.center + n, sampler.get_1d(0), sampler.get_2d(1));
            if (!light) return 0.0;
            return 4 * pi_d * double{light->Le[1] * std::max(light->wi.dot(n), 0.f) / light->pdf_w};
        });
        EXPECT_GT(received.mean(), 0) << name;
        EXPECT_NEAR(followed.mean(), received.mean(),
                    4 * std::hypot(followed.standard_error(), received.standard_error()))
            << name;
        EXPECT_LT(received.standard_error() + followed.standard_error(), 0.03 * received.mean()) << name;
    }
}

// A start's power is the light's emission there by the density of the start, which emission_pdf() says. Lights of a
// texture over a surface are left out: where the start lies in it is not kept.
TEST(EveryLight, EmissionIsItsValueByItsDensity) {
    const TemporaryFolder folder;
    for (const auto& [name, xml] : every_light(folder)) {
        const auto scene = load(ball + xml);
        const auto& s = *scene.scene;
        for (std::uint32_t i = 0; i < 200; ++i) {
            const Sampler sampler(PointSet::sobol, 2, 0, i);
            const auto start = s.sample_emission(sampler.get_1d(0), sampler.get_2d(1), sampler.get_2d(2));
            const Light& light = s.lights()[start.light];
            const Vec3& w = start.ray.d;
            float cos_light = 1.f;
            Color value = Color::Zero();
            if (const auto* area = std::get_if<AreaLight>(&light)) {
                if (area->texture) continue;
                cos_light = start.normal.dot(w);
                value = area->radiance * cos_light;
            } else if (const auto* at = std::get_if<PointLight>(&light)) {
                value = at->intensity;
            } else if (const auto* spot = std::get_if<SpotLight>(&light)) {
                value = spot->intensity(w);
            } else if (const auto* projector = std::get_if<ProjectorLight>(&light)) {
                value = projector->intensity(w);
            } else if (const auto* sun = std::get_if<DirectionalLight>(&light)) {
                value = sun->irradiance;
            } else {
                value = environment_radiance(light, -w);
            }
            const Colord by_density = start.power * s.emission_pdf(start.light, w, cos_light);
            // The direction is rounded to float, which shifts it in a texture or near the edge of a beam.
            EXPECT_TRUE(((by_density - value.cast<double>()).abs() <= 1e-3 * double{value.maxCoeff()}).all()) << name;
        }
    }
}

TEST(EveryLight, DensitiesIncludeTheChoiceOfTheLight) {
    const TemporaryFolder folder;
    std::string all = ball;
    // A scene takes one environment, and one lamp in a place, so one of each is left out.
    for (const auto& [name, xml] : every_light(folder))
        if (name != "constant" && name != "area" && name != "sunsky") all += xml;
    const auto scene = load(all);
    const auto& s = *scene.scene;
    ASSERT_TRUE(s.environment());
    const Vec3 p(0, 0, -5);
    int environment = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const Sampler sampler(PointSet::sobol, 2, 0, i);
        const auto light = s.sample_light(p, sampler.get_1d(0), sampler.get_2d(1));
        if (!light || light->delta) continue;
        if (light->distance == infinity) {
            ++environment;
            EXPECT_NEAR(s.environment_pdf_w(p, light->wi) / light->pdf_w, 1.f, 1e-3f);
            EXPECT_TRUE(s.environment_radiance(light->wi).isApprox(light->Le, 1e-3f));
        }
    }
    EXPECT_GT(environment, 100);
}

TEST(EveryLight, StartsOfPathsAreChosenByPowerButForATenth) {
    const auto scene = load(ball + point_light(0, 0, 0, 1) + point_light(0, 0, 0, 0) + point_light(0, 0, 0, 3));
    const DiscreteDistribution choice = light_choice(scene.scene->lights());
    EXPECT_NEAR(choice.probability(0), 0.9 * 0.25 + 0.05, 1e-6);
    EXPECT_EQ(choice.probability(1), 0.f);
    EXPECT_NEAR(choice.probability(2), 0.9 * 0.75 + 0.05, 1e-6);
}

TEST(BlackLights, AreNoLights) {
    const TemporaryFolder folder, another;
    const auto black_squares = [](const std::string& name) {
        return named("texture", name, "checkerboard", rgb("color0", 0), rgb("color1", 0));
    };
    for (const std::string& xml : {envmap_xml(folder, image_of(4, 3, [](int, int) { return Color(Color::Zero()); })),
                                   envmap_xml(another, image_of(4, 3, noise), number("scale", 0)), constant_light(0),
                                   emitter("directional", rgb("irradiance", 0)), spot_xml(20, 10, rgb("intensity", 0)),
                                   spot_xml(20, 10, black_squares("texture")), lamp(black_squares("radiance"))}) {
        const auto scene = load(ball + xml);
        EXPECT_FALSE(scene.scene->has_light()) << xml;
        EXPECT_FALSE(scene.scene->environment()) << xml;
        EXPECT_FALSE(scene.scene->sample_light(Vec3(0, 0, 2), 0.3f, Vec2(0.3f, 0.3f))) << xml;
    }
}

TEST(Effects, EnvironmentsAndTexturedLightsAreFound) {
    const auto effects = [](const std::string& light) { return effects_of(*load(shape("sphere") + light).scene); };
    EXPECT_TRUE(effects_of(*load(lamp(squares)).scene).has(Effect::textures));
    EXPECT_TRUE(effects(spot_xml(20, 10, checkers)).has(Effect::textures));
    EXPECT_FALSE(effects(emitter("spot")).has(Effect::textures));
    for (const std::string type : {"constant", "directional", "spot"}) {
        EXPECT_EQ(effects(emitter(type)).has(Effect::environment_light), type == "constant") << type;
        EXPECT_TRUE(effects(emitter(type)).has(Effect::direct_light)) << type;
    }
}

}  // namespace
}  // namespace gib::test::light_test
