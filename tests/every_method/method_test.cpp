// Laws for every method; the registry is walked, no method is named.
#include "tests/support/methods_under_test.h"
#include "tests/support/polygon_light.h"

namespace gib::method_test {
namespace {

using namespace test;

class EveryMethod : public OfAMethod {
protected:
    bool is_unbiased() const { return method().description->unbiased; }
};
INSTANTIATE_TEST_SUITE_P(Registry, EveryMethod, testing::ValuesIn(methods_under_test()), name_of_method);

std::string fixed(double x) { return std::to_string(x); }

/// The mean of each block of 16 x 16 pixels.
std::vector<double> block_means(const Image& image) {
    const int blocks = image.width / 16;
    std::vector<double> means;
    for (int b = 0; b < blocks * blocks; ++b) {
        double sum = 0;
        for (int i = 0; i < 256; ++i) {
            const int x = b % blocks * 16 + i % 16, y = b / blocks * 16 + i / 16;
            sum += static_cast<double>(image.at(static_cast<std::size_t>(y * image.width + x)).mean());
        }
        means.push_back(sum / 256);
    }
    return means;
}

// In a closed box of albedo rho whose walls emit 1 - rho, the radiance is 1 at every point and in every direction.
// An unbiased method takes samples until the blocks scatter by 0.2 % around 1, at most 512 a pixel, which is where path tracing gets
// to. A block that is off by 1.6 % is then noticed with 99 % power: 1 % + 2.33 x 0.25 %. Blocks that are off keep the scatter
// high, so that stopping early hides none.
void expect_furnace(const std::string& scene_file, double rho, const MethodUnderTest& method) {
    const auto scene = shipped_scene(scene_file, {{{"rho", fixed(rho)}, {"emission", fixed(1 - rho)}}, {}});
    const bool unbiased = method.description->unbiased;
    const auto enough = [&](const ComponentImages& images) {
        double squares = 0;
        const std::vector<double> means = block_means(images.total());
        for (const double mean : means)
            squares += sqr(mean - 1);
        return unbiased && squares < sqr(0.002) * static_cast<double>(means.size());
    };
    const Image image = render_and_count(scene, method.label, unbiased ? 512 : 64, 1, 0, enough).image.total();
    EXPECT_NEAR(mean_of(image).mean(), 1.0, 0.005) << scene_file << ' ' << rho;
    if (!unbiased) return;
    for (const double mean : block_means(image))
        EXPECT_NEAR(mean, 1.0, 0.01) << scene_file << ' ' << rho;
}

TEST_P(EveryMethod, FurnaceHasTheAnalyticRadiance) {
    for (double rho : {0.5, 0.9}) {
        expect_furnace("furnace.xml", rho, method());
        expect_furnace("furnace-sphere.xml", rho, method());
    }
}

/// An orthographic camera that looks down from height z and sees a square of side 2 `extent` around (x, y).
std::string view_down(double x, double y, double z, double extent, int size) {
    return element("sensor", "orthographic",
                   to_world(scale(extent), look_at(fmt::format("{}, {}, {}", x, y, z), fmt::format("{}, {}, 0", x, y))),
                   box_film(size));
}
/// A square in z = 0 from -size to size.
std::string square(double size) { return shape("rectangle", to_world(scale(size)), diffuse(0.5)); }
const std::string black = one_sided("0");

TEST_P(EveryMethod, DirectLightFromAPolygonFollowsLambertsFormula) {
    if (!method().samples_pixels()) GTEST_SKIP() << "too noisy";
    // A 2 x 1 light at height 2 above a floor of reflectance 0.5, radiance 3, facing down.
    const std::vector<Vec3d> light = {Vec3d(-1, -0.5, 2), Vec3d(1, -0.5, 2), Vec3d(1, 0.5, 2), Vec3d(-1, 0.5, 2)};
    for (const Vec2d& at : {Vec2d(0, 0), Vec2d(1, 0.5), Vec2d(-2, 0.3), Vec2d(0.5, -3), Vec2d(4, 4)}) {
        const auto scene =
            test::Scene(view_down(at.x(), at.y(), 1, 0.001, 16), square(10),
                        shape("rectangle", to_world(scale(1, 0.5, 1), rotate('x', 180), translate(0, 0, 2)), black,
                              area_light(3)))
                .load();
        const double expected =
            3 * 0.5 / std::numbers::pi * lambert_irradiance(Vec3d(at.x(), at.y(), 0), Vec3d::UnitZ(), light);
        // 256 pixels x 2048 samples; a sample's relative deviation is at most about 0.5 here: standard error 0.07 %.
        const auto image = rendered(scene, 2048);
        ASSERT_TRUE(image[Component::direct]);
        EXPECT_NEAR(mean_of(*image[Component::direct])[1] / expected, 1.0, 0.002) << at.transpose();
    }
}

/// The radiance, at the origin, of a floor of reflectance 0.5 in z = 0 that is `size` wide; `light` describes a light
/// at the origin's zenith.
double floor_radiance(const MethodUnderTest& method, const std::string& light, double size, std::uint32_t passes) {
    const auto scene = test::Scene(view_down(0, 0, 1e-3 * size, 1e-3 * size, 8), square(size), light).load();
    return mean_of(*render(scene, method.label + " max_depth=2", passes)[Component::direct])[1];
}

// A lamp whose own rounding errors are far below those of the ray that reaches it must not shadow itself. A second,
// distant plate lowers the floor, so that the lamp lies in the middle of the recentred scene.
TEST_P(EveryMethod, SmallLampsInTheMiddleOfALargeSceneShine) {
    if (!method().samples_pixels()) GTEST_SKIP() << "too noisy";
    const std::string ceiling = shape("rectangle", to_world(scale(10), translate(0, 0, 20)), black),
                      glow = black + area_light(1e6);
    for (double r : {1e-4, 1e-2, 0.1}) {
        const double L = 1e6 * 0.5;  // radiance of the lamp times the floor's reflectance
        const std::string down = to_world(scale(r), rotate('x', 180), translate(0, 0, 10));
        // Form factors straight below at height 10: sphere (r/h)^2, disk r^2 / (r^2 + h^2), small square 4 r^2 / (pi h^2).
        for (const auto& [lamp, form_factor] : std::vector<std::pair<std::string, double>>{
                 {shape("sphere", center(0, 0, 10), radius(r), glow), r * r / 100},
                 {shape("disk", down, glow), r * r / (r * r + 100)},
                 {shape("rectangle", down, glow), 4 * r * r / (std::numbers::pi * 100)}})
            EXPECT_NEAR(floor_radiance(method(), ceiling + lamp, 10, 64) / (L * form_factor), 1.0, 0.002) << lamp;
    }
}

// A bright lamp that faces away takes most of the light samples, but not all of them.
TEST_P(EveryMethod, ADimLightBesideABrightOneIsNotForgotten) {
    if (!method().samples_pixels()) GTEST_SKIP() << "too noisy";
    const std::string lights =
        point_light(0, 0, 2, 1) + shape("rectangle", to_world(scale(0.1), translate(0, 0, 3)), black, area_light(1e9));
    // E = I / h^2, radiance 0.5 E / pi; one sample in 20 finds the point: relative error of 64 x 4096 samples 0.9 %.
    EXPECT_NEAR(floor_radiance(method(), lights, 1, 4096) / (0.5 / std::numbers::pi / 4), 1.0, 0.027);
}

// A plate just above a wide floor hides the lamp. Rays from the floor must not start beyond the plate, whatever the
// size of the floor's triangles.
TEST_P(EveryMethod, NoLightLeaksUnderAPlateOnAVastFloor) {
    const std::string plate = shape("rectangle", to_world(translate(0, 0, 0.05)), diffuse(0.5));
    for (const double size : {1e1, 1e4, 1e6}) {
        const auto scene =
            test::Scene(view_down(0, 0, 0.04, 0.01, 8), square(size), plate, point_light(0, 0, 2, 1)).load();
        EXPECT_EQ(mean_of(*rendered(scene, 4, "max_depth=2")[Component::direct]).sum(), 0.0) << size;
    }
}

TEST_P(EveryMethod, ImageIsBitIdenticalForOneTwoAndFiveThreads) {
    for (const char* file : {"cornell-box.xml", "cornell-glass.xml"}) {
        const auto scene = shipped_scene(file, {{}, std::pair{48, 48}});
        const auto one = render(scene, method().label, 3, 1, 1);
        for (int threads : {2, 5}) {
            const auto many = render(scene, method().label, 3, 1, threads);
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
    const auto scene = shipped_scene("cornell-box.xml", {{}, std::pair{16, 16}});
    EXPECT_NE(render(scene, method().label, 1, 1).total().rgb, render(scene, method().label, 1, 2).total().rgb);
}

TEST_P(EveryMethod, ShowsEveryComponentThatItSimulatesAndNoOther) {
    const auto scene = shipped_scene("cornell-box.xml", {{}, std::pair{16, 16}});
    const auto image = render(scene, method().label, 1);
    for (Component c : all_components) {
        const auto& known = method().description->components;
        EXPECT_EQ(image[c].has_value(), std::find(known.begin(), known.end(), c) != known.end()) << name_of(c);
    }
    if (image[Component::caustic]) {
        EXPECT_EQ(mean_of(*image[Component::caustic]).sum(), 0.0);
    }
}

// Depth counts edges: 1 shows lights, 2 adds direct light, 3 the first indirect light. Depth 0 means unlimited in a
// label, but black in XML.
TEST_P(EveryMethod, DepthLimitsCutWholeComponents) {
    const auto scene = shipped_scene("cornell-box.xml", {{}, std::pair{24, 24}});
    const auto mean = [&](int depth, Component c) {
        return mean_of(*render(scene, method().label + " max_depth=" + std::to_string(depth), 16)[c]).mean();
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
    const auto scene =
        test::Scene(element("sensor", "perspective", box_film(8)), shape("sphere", center(0, 0, 3))).load();
    EXPECT_EQ(mean_of(rendered(scene, 2).total()).sum(), 0.0);
}

// A lossless slab of glass in a furnace is invisible: radiance stays 1 through
// refraction, total reflection and the way out.
TEST_P(EveryMethod, LosslessGlassInTheFurnaceIsInvisible) {
    if (!method().samples_pixels()) GTEST_SKIP() << "too noisy";
    if (!method().simulates(Effect::refraction)) GTEST_SKIP();
    const std::string clear = bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1));
    const auto scene =
        test::Scene(camera(60, box_film(32)),
                    shape("sphere", radius(4), flag("flip_normals"), one_sided("0.5"), area_light(0.5)),
                    shape("cube", to_world(scale(0.8, 0.6, 0.2), rotate('y', 25), translate(0, 0, 2)), clear),
                    shape("sphere", center(-1.4, 0, 2), radius(0.4), clear))
            .load();
    EXPECT_NEAR(mean_of(rendered(scene, is_unbiased() ? 512 : 64).total()).mean(), 1.0, 0.005);
}

// A disc of radius R that emits 1 lies out of focus, at the distance z on the axis of a lens of radius A focused
// at f. Rays of the film's middle reach the disc from the lens points within R / |1 - z / f|, so its image has
// the radiance (R / (A |1 - z / f|))^2 there.
TEST_P(EveryMethod, LensesBlurWhatIsOutOfFocusInClosedForm) {
    if (!method().samples_pixels()) GTEST_SKIP() << "too noisy";
    const double r = 0.1, z = 3, aperture = 0.5;
    for (const double focus : {2.0, 6.0}) {
        const auto scene =
            test::Scene(element("sensor", "thinlens", number("fov", 0.001), number("aperture_radius", aperture),
                                number("focus_distance", focus), box_film(16)),
                        shape("disk", to_world(scale(r), rotate('y', 180), translate(0, 0, z)), black,
                              "<emitter type='area'/>"))
                .load();
        const double p = std::pow(r / (aperture * std::abs(1 - z / focus)), 2);
        const auto image = rendered(scene, 256);
        ASSERT_TRUE(image[Component::emission]);
        // Hits are binomial: 256 pixels of 256 samples, four standard deviations.
        EXPECT_NEAR(mean_of(*image[Component::emission])[1], p, 4 * std::sqrt(p * (1 - p) / (256 * 256))) << focus;
    }
}

}  // namespace
}  // namespace gib::method_test
