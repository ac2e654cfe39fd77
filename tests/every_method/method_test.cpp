// Laws for every method; the registry is walked, no method is named.
#include "tests/support/scene_fixtures.h"

#include <array>

namespace gib::method_test {
namespace {

using test::mean_of;
using test::render;

class EveryMethod : public testing::TestWithParam<std::string> {
protected:
    const MethodDescription& method() const { return find_method(GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(Registry, EveryMethod, testing::ValuesIn(names_of_comparable_methods()),
                         [](const auto& name) { return name.param; });

std::string fixed(double x) { return std::to_string(x); }

// In a closed box of albedo rho whose walls emit 1 - rho, the radiance is 1 at every point and in every direction.
void expect_furnace(const std::string& scene_file, double rho, const MethodDescription& method) {
    const auto scene = test::shipped_scene(scene_file, {{{"rho", fixed(rho)}, {"emission", fixed(1 - rho)}}, {}});
    const std::uint32_t passes = method.unbiased ? 512 : 64;
    const Image image = render(scene, method.name, passes).total();
    EXPECT_NEAR(mean_of(image).mean(), 1.0, 0.005) << scene_file << ' ' << rho;
    if (!method.unbiased) return;
    // 256 pixels of 512 paths each: a block's standard error is below 0.25 %.
    const int blocks = image.width / 16;
    for (int b = 0; b < blocks * blocks; ++b) {
        double sum = 0;
        for (int i = 0; i < 256; ++i) {
            const int x = b % blocks * 16 + i % 16, y = b / blocks * 16 + i / 16;
            sum += static_cast<double>(image.at(static_cast<std::size_t>(y * image.width + x)).mean());
        }
        EXPECT_NEAR(sum / 256, 1.0, 0.01) << scene_file << ' ' << rho << " block " << b;
    }
}

TEST_P(EveryMethod, FurnaceHasTheAnalyticRadiance) {
    for (double rho : {0.5, 0.9}) {
        expect_furnace("furnace.xml", rho, method());
        expect_furnace("furnace-sphere.xml", rho, method());
    }
}

/// Irradiance at `p` with the normal n from a polygon of radiance 1 by Lambert's formula, E = 1/2 sum of angle_i n .
/// gamma_i. Source: Arvo 1994, "The Irradiance Jacobian for Partially Occluded Polyhedral Sources", eq. 3.
double lambert_irradiance(const Vec3d& p, const Vec3d& n, const std::array<Vec3d, 4>& polygon) {
    double E = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3d a = (polygon[i] - p).normalized(), b = (polygon[(i + 1) % 4] - p).normalized();
        E += 0.5 * std::acos(a.dot(b)) * n.dot(a.cross(b).normalized());
    }
    return std::abs(E);
}

TEST_P(EveryMethod, DirectLightFromAPolygonFollowsLambertsFormula) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!method().simulates.has(Effect::direct_light)) GTEST_SKIP();
    // A 2 x 1 light at height 2 above a floor of reflectance 0.5, radiance 3, facing down.
    const std::array<Vec3d, 4> light = {Vec3d(-1, -0.5, 2), Vec3d(1, -0.5, 2), Vec3d(1, 0.5, 2), Vec3d(-1, 0.5, 2)};
    const std::array<Vec2d, 5> positions = {Vec2d(0, 0), Vec2d(1, 0.5), Vec2d(-2, 0.3), Vec2d(0.5, -3), Vec2d(4, 4)};
    for (const Vec2d& at : positions) {
        const std::string x = fixed(at.x()), y = fixed(at.y());
        // An orthographic camera that sees a square of side 2e-3 around the position, from below the light.
        const auto scene = test::scene_of(test::scene_xml(
            "<sensor type='orthographic'><transform name='to_world'><scale value='0.001'/><lookat origin='" + x + "," +
            y + ",1' target='" + x + "," + y + ",0' up='0,1,0'/></transform>" + test::box_film(16) +
            "</sensor><shape type='rectangle'><transform name='to_world'><scale value='10'/></transform>" +
            test::diffuse(0.5) +
            "</shape><shape type='rectangle'><transform name='to_world'><scale x='1' y='0.5' z='1'/>"
            "<rotate x='1' angle='180'/><translate z='2'/></transform><bsdf type='diffuse'><rgb name='reflectance' "
            "value='0'/></bsdf><emitter type='area'><rgb name='radiance' value='3'/></emitter></shape>"));
        const double expected =
            3 * 0.5 / std::numbers::pi * lambert_irradiance(Vec3d(at.x(), at.y(), 0), Vec3d::UnitZ(), light);
        // 256 pixels x 2048 samples; a sample's relative deviation is at most about 0.5 here: standard error 0.07 %.
        const auto image = render(scene, method().name, 2048);
        ASSERT_TRUE(image[Component::direct]);
        EXPECT_NEAR(mean_of(*image[Component::direct])[1] / expected, 1.0, 0.002) << x << ' ' << y;
    }
}

/// The radiance, at the origin, of a floor of reflectance 0.5 in z = 0 that is `size` wide; `light` describes a light
/// at the origin's zenith.
double floor_radiance(const MethodDescription& method, const std::string& light, double size, std::uint32_t passes) {
    const std::string view = std::to_string(1e-3 * size);
    const auto scene = test::scene_of(test::scene_xml(
        "<sensor type='orthographic'><transform name='to_world'><scale value='" + view + "'/><lookat origin='0,0," +
        view + "' target='0,0,0' up='0,1,0'/></transform>" + test::box_film(8) +
        "</sensor><shape type='rectangle'><transform name='to_world'><scale value='" + std::to_string(size) +
        "'/></transform>" + test::diffuse(0.5) + "</shape>" + light));
    return mean_of(*render(scene, method.name + " max_depth=2", passes)[Component::direct])[1];
}

// A lamp whose own rounding errors are far below those of the ray that reaches it must not shadow itself. A second,
// distant plate lowers the floor, so that the lamp lies in the middle of the recentred scene.
TEST_P(EveryMethod, SmallLampsInTheMiddleOfALargeSceneShine) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!method().simulates.has(Effect::direct_light)) GTEST_SKIP();
    const std::string ceiling =
        "<shape type='rectangle'><transform name='to_world'><scale value='10'/><translate z='20'/>"
        "</transform><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf></shape>";
    const std::string black = "<bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>";
    const std::string glow = "<emitter type='area'><rgb name='radiance' value='1e6'/></emitter></shape>";
    const std::string down = "<rotate x='1' angle='180'/><translate z='10'/></transform>";
    for (double r : {1e-4, 1e-2, 0.1}) {
        const std::string size = std::to_string(r);
        const double L = 1e6 * 0.5;  // radiance of the lamp times the floor's reflectance
        // Form factors straight below at height 10: sphere (r/h)^2, disk
        // r^2 / (r^2 + h^2), small square 4 r^2 / (pi h^2).
        EXPECT_NEAR(floor_radiance(method(),
                                   ceiling +
                                       "<shape type='sphere'><point name='center' x='0' y='0' z='10'/>"
                                       "<float name='radius' value='" +
                                       size + "'/>" + black + glow,
                                   10, 64) /
                        (L * r * r / 100),
                    1.0, 0.002)
            << "sphere " << r;
        EXPECT_NEAR(floor_radiance(method(),
                                   ceiling + "<shape type='disk'><transform name='to_world'><scale value='" + size +
                                       "'/>" + down + black + glow,
                                   10, 64) /
                        (L * r * r / (r * r + 100)),
                    1.0, 0.002)
            << "disk " << r;
        EXPECT_NEAR(floor_radiance(method(),
                                   ceiling + "<shape type='rectangle'><transform name='to_world'><scale value='" +
                                       size + "'/>" + down + black + glow,
                                   10, 64) /
                        (L * 4 * r * r / (std::numbers::pi * 100)),
                    1.0, 0.002)
            << "rectangle " << r;
    }
}

// A bright lamp that faces away takes most of the light samples, but not all of them.
TEST_P(EveryMethod, ADimLightBesideABrightOneIsNotForgotten) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!method().simulates.has(Effect::direct_light)) GTEST_SKIP();
    const std::string lights =
        "<emitter type='point'><point name='position' x='0' y='0' z='2'/><rgb name='intensity' value='1'/></emitter>"
        "<shape type='rectangle'><transform name='to_world'><scale value='0.1'/><translate z='3'/></transform>"
        "<bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>"
        "<emitter type='area'><rgb name='radiance' value='1e9'/></emitter></shape>";
    // E = I / h^2, radiance 0.5 E / pi; one sample in 20 finds the point: relative error of 64 x 4096 samples 0.9 %.
    EXPECT_NEAR(floor_radiance(method(), lights, 1, 4096) / (0.5 / std::numbers::pi / 4), 1.0, 0.027);
}

// A plate just above a wide floor hides the lamp. Rays from the floor must not start beyond the plate, whatever the
// size of the floor's triangles.
TEST_P(EveryMethod, NoLightLeaksUnderAPlateOnAVastFloor) {
    if (!method().simulates.has(Effect::direct_light)) GTEST_SKIP();
    const std::string plate_and_lamp =
        "<shape type='rectangle'><transform name='to_world'><translate z='0.05'/></transform>" + test::diffuse(0.5) +
        "</shape><emitter type='point'><point name='position' x='0' y='0' z='2'/><rgb name='intensity' "
        "value='1'/></emitter>";
    for (const char* size : {"10", "10000", "1000000"}) {
        const auto scene = test::scene_of(test::scene_xml(
            "<sensor type='orthographic'><transform name='to_world'><scale value='0.01'/><lookat origin='0,0,0.04' "
            "target='0,0,0' up='0,1,0'/></transform>" +
            test::box_film(8) + "</sensor><shape type='rectangle'><transform name='to_world'><scale value='" + size +
            "'/></transform>" + test::diffuse(0.5) + "</shape>" + plate_and_lamp));
        EXPECT_EQ(mean_of(*render(scene, method().name + " max_depth=2", 4)[Component::direct]).sum(), 0.0) << size;
    }
}

TEST_P(EveryMethod, ImageIsBitIdenticalForOneTwoAndFiveThreads) {
    for (const char* file : {"cornell-box.xml", "cornell-glass.xml"}) {
        const auto scene = test::shipped_scene(file, {{}, std::pair{48, 48}});
        const auto one = render(scene, method().name, 3, 1, 1);
        for (int threads : {2, 5}) {
            const auto many = render(scene, method().name, 3, 1, threads);
            for (Component c : all_components) {
                ASSERT_EQ(one[c].has_value(), many[c].has_value());
                if (one[c]) {
                    EXPECT_EQ(one[c]->rgb, many[c]->rgb) << file << ' ' << name_of(c) << ' ' << threads;
                }
            }
        }
    }
}

TEST_P(EveryMethod, DifferentSeedsGiveDifferentImages) {
    const auto scene = test::shipped_scene("cornell-box.xml", {{}, std::pair{16, 16}});
    EXPECT_NE(render(scene, method().name, 1, 1).total().rgb, render(scene, method().name, 1, 2).total().rgb);
}

TEST_P(EveryMethod, ShowsEveryComponentThatItSimulatesAndNoOther) {
    const auto scene = test::shipped_scene("cornell-box.xml", {{}, std::pair{16, 16}});
    const auto image = render(scene, method().name, 1);
    for (Component c : all_components) {
        const auto& known = method().components;
        EXPECT_EQ(image[c].has_value(), std::find(known.begin(), known.end(), c) != known.end()) << name_of(c);
    }
    if (image[Component::caustic]) {
        EXPECT_EQ(mean_of(*image[Component::caustic]).sum(), 0.0);
    }
}

// Depth counts edges: 1 shows lights, 2 adds direct light, 3 the first indirect light. Depth 0 means unlimited in a
// label, but black in XML.
TEST_P(EveryMethod, DepthLimitsCutWholeComponents) {
    const auto scene = test::shipped_scene("cornell-box.xml", {{}, std::pair{24, 24}});
    const auto mean = [&](int depth, Component c) {
        return mean_of(*render(scene, method().name + " max_depth=" + std::to_string(depth), 16)[c]).mean();
    };
    EXPECT_GT(mean(1, Component::emission), 0.0);
    EXPECT_EQ(mean(1, Component::direct), 0.0);
    EXPECT_GT(mean(2, Component::direct), 0.0);
    EXPECT_EQ(mean(2, Component::indirect), 0.0);
    const double three = mean(3, Component::indirect), four = mean(4, Component::indirect),
                 all = mean(0, Component::indirect);
    EXPECT_GT(three, 0.0);
    EXPECT_GT(four, 1.2 * three);
    EXPECT_GT(all, 1.05 * four);
}

TEST_P(EveryMethod, ASceneWithoutLightIsBlackAndFinite) {
    const auto scene = test::scene_of(
        test::scene_xml("<sensor type='perspective'>" + test::box_film(8) +
                        "</sensor><shape type='sphere'><point name='center' x='0' y='0' z='3'/></shape>"));
    EXPECT_EQ(mean_of(render(scene, method().name, 2).total()).sum(), 0.0);
}

// A lossless slab of glass in a furnace is invisible: radiance stays 1 through
// refraction, total reflection and the way out.
TEST_P(EveryMethod, LosslessGlassInTheFurnaceIsInvisible) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    if (!method().simulates.has(Effect::refraction)) GTEST_SKIP();
    const std::string furnace =
        "<shape type='sphere'><float name='radius' value='4'/><boolean name='flip_normals' value='true'/>"
        "<bsdf type='diffuse'><rgb name='reflectance' value='0.5'/></bsdf>"
        "<emitter type='area'><rgb name='radiance' value='0.5'/></emitter></shape>";
    const std::string slab =
        "<shape type='cube'><transform name='to_world'><scale x='0.8' y='0.6' z='0.2'/><rotate y='1' angle='25'/>"
        "<translate z='2'/></transform><bsdf type='dielectric'><float name='int_ior' value='1.5'/>"
        "<float name='ext_ior' value='1'/></bsdf></shape>";
    const std::string sphere =
        "<shape type='sphere'><point name='center' x='-1.4' y='0' z='2'/><float name='radius' value='0.4'/>"
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf></shape>";
    const auto scene = test::scene_of(test::scene_xml("<sensor type='perspective'><float name='fov' value='60'/>" +
                                                      test::box_film(32) + "</sensor>" + furnace + slab + sphere));
    const Image image = render(scene, method().name, method().unbiased ? 512 : 64).total();
    EXPECT_NEAR(mean_of(image).mean(), 1.0, 0.005);
}

// A disc of radius R that emits 1 lies out of focus, at the distance z on the axis of a lens of radius A focused
// at f. Rays of the film's middle reach the disc from the lens points within R / |1 - z / f|, so its image has
// the radiance (R / (A |1 - z / f|))^2 there.
TEST_P(EveryMethod, LensesBlurWhatIsOutOfFocusInClosedForm) {
    if (!test::samples_pixels(method())) GTEST_SKIP() << "too noisy";
    const double radius = 0.1, z = 3, aperture = 0.5;
    for (const double focus : {2.0, 6.0}) {
        const auto scene = test::scene_of(test::scene_xml(
            "<sensor type='thinlens'><float name='fov' value='0.001'/><float name='aperture_radius' value='" +
            fixed(aperture) + "'/><float name='focus_distance' value='" + fixed(focus) + "'/>" + test::box_film(16) +
            "</sensor><shape type='disk'><transform name='to_world'><scale value='" + fixed(radius) +
            "'/><rotate y='1' angle='180'/><translate z='" + fixed(z) +
            "'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf><emitter type='area'/>"
            "</shape>"));
        const double p = std::pow(radius / (aperture * std::abs(1 - z / focus)), 2);
        const auto image = render(scene, method().name, 256);
        ASSERT_TRUE(image[Component::emission]);
        // Hits are binomial: 256 pixels of 256 samples, four standard deviations.
        EXPECT_NEAR(mean_of(*image[Component::emission])[1], p, 4 * std::sqrt(p * (1 - p) / (256 * 256))) << focus;
    }
}

}  // namespace
}  // namespace gib::method_test
