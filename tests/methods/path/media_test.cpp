// Media in the path tracer, against furnaces and integrals in closed or numerical form; the cube of a constvolume, and an
// albedo that varies.

#include "tests/support/scene_text.h"
#include "tests/support/seed_means.h"
#include "tests/support/volume_file.h"

#include <numbers>

namespace gib::media_test {
namespace {

using namespace test;

constexpr double pi_d = std::numbers::pi;
constexpr double sigmas = 5;  ///< allowed errors, in standard errors of means over seeds: false alarm below 1e-4 a test

const std::string sky = constant_light(1);
const std::string no_surface = bsdf("null");

std::string camera_before(int size, double fov, const std::string& more = "") {
    return camera(fov, to_world(translate(0, 0, -4)), more, box_film(size));
}
/// Looks along -z from z = 5 at what lies within `extent` of (x, y).
std::string narrow_camera(double x, double y, double extent, int size) {
    return element(
        "sensor", "orthographic",
        to_world(scale(extent, extent, 1), look_at(fmt::format("{}, {}, 5", x, y), fmt::format("{}, {}, 0", x, y))),
        box_film(size));
}
template <class... Content>
std::string interior(const std::string& type, const Content&... content) {
    return fmt::format("<medium name='interior' type='{}'>", type) + (std::string() + ... + content) + "</medium>";
}
std::string homogeneous(double sigma, double albedo, double g = 0) {
    return interior("homogeneous", number("sigma_t", sigma), number("albedo", albedo),
                    element("phase", "hg", number("g", g)));
}
std::string ball(const std::string& content) { return shape("sphere", content); }
std::string cube(const std::string& medium, double size = 1) {
    return shape("cube", to_world(scale(size)), no_surface, medium);
}
/// A volume that fills the cube [-1, 1]^3.
std::string grid(const std::string& name, const std::string& file, const std::string& more = "") {
    return "<volume name='" + name + "' type='gridvolume'>" + text("filename", file) + more +
           to_world("<translate value='-0.5'/>", scale(2)) + "</volume>";
}
std::string constant(const std::string& name, const std::string& value, const std::string& placing = "") {
    return "<volume type='constvolume' name='" + name + "'>" + rgb("value", value) + to_world(placing) + "</volume>";
}
std::string limited_to(int edges) { return element("integrator", "volpath", integer("max_depth", edges)); }
std::string sun(const std::string& direction, double irradiance) {
    return emitter("directional", value_element("vector", "direction", direction), rgb("irradiance", irradiance));
}
std::string lamp_at(const std::string& placing, double radiance) {
    return shape("rectangle", to_world(placing), area_light(radiance));
}
const std::string wide_camera = camera_before(12, 30);
const std::string side_lamp = lamp_at(rotate('y', 90) + translate(-3, 0, 0), 5);

void expect_mean(const std::array<Moments, 3>& found, const Colord& expected, const std::string& what) {
    for (int c = 0; c < 3; ++c) {
        const Moments& m = found[static_cast<std::size_t>(c)];
        EXPECT_NEAR(m.mean(), expected[c], sigmas * m.standard_error() + 1e-6) << what << ", channel " << c;
        EXPECT_LT(m.standard_error(), 0.01 * expected[c]) << what << ": the test would not see an error";
    }
}
void expect_same(const std::string& a, const std::string& b) {
    const auto first = means_over_seeds(scene_of(scene_xml(a)), 64, 12),
               second = means_over_seeds(scene_of(scene_xml(b)), 64, 12);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(first[c].mean(), second[c].mean(),
                    sigmas * std::hypot(first[c].standard_error(), second[c].standard_error()) + 1e-6);
        EXPECT_LT(second[c].standard_error(), 0.01 * second[c].mean());
    }
}
/// One sample decides, as nothing is sampled; every pixel is exact but for rounding.
void expect_image(const LoadedScene& scene, const Color& expected, float accuracy) {
    const Image image = render(scene, "path", 1).total();
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(image.at(i)[c], expected[c], accuracy * expected[c]) << i << ' ' << c;
}

// Light scattered once in the cube [-1, 1]^3 of extinction s and albedo a, seen along -z through its middle, under a distant
// light of irradiance E. Across the view it has come through 1 of the medium: a E p exp(-s) (1 - exp(-2 s)). Along the view,
// light and path share the way: a E p 2 s exp(-2 s). The width of the film changes the first by less than 1e-3.
TEST(RayleighMedium, ScattersTwiceAsMuchAheadAsAcross) {
    constexpr double s = 0.5, a = 0.8, E = 40;
    const std::string medium =
        interior("homogeneous", number("sigma_t", s), number("albedo", a), "<phase type='rayleigh'/>");
    const auto lit_along = [&](const std::string& direction) {
        return means_over_seeds(
            test::Scene(limited_to(2), narrow_camera(0, 0, 0.05, 8), cube(medium), sun(direction, E)).load(), 64, 16);
    };
    const double ahead = 6 / (16 * pi_d), across = 3 / (16 * pi_d);
    expect_mean(lit_along("0, -1, 0"), Colord::Constant(a * E * across * std::exp(-s) * (1 - std::exp(-2 * s))),
                "across");
    expect_mean(lit_along("0, 0, 1"), Colord::Constant(a * E * ahead * 2 * s * std::exp(-2 * s)), "ahead");
    expect_mean(lit_along("0, 0, -1"), Colord::Constant(a * E * ahead * 0.5 * (1 - std::exp(-4 * s))), "back");
}

// A medium that absorbs nothing is invisible under a sky of radiance 1, whatever its density, phase function and
// boundary. The rough boundary is nearly smooth: light that is scattered twice between microfacets is not modelled;
// it is some alpha^2 of all light, 1e-4 of the image with alpha = 0.01.
TEST(MediumFurnace, WhiteMediaVanish) {
    const TemporaryFolder folder;
    const std::string cloud =
        folder.write("d.vol", volume_bytes({2, 3, 2}, 1, {0, 1, 5, 2, 0.5f, 0, 1, 1, 7, 0, 3, 2}));
    const std::string in_glass = bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1)),
                      in_rough_glass =
                          bsdf("roughdielectric", number("alpha", 0.001), number("int_ior", 1.2), number("ext_ior", 1));
    for (const auto& [name, body] : std::vector<std::pair<std::string, std::string>>{
             {"thin", no_surface + homogeneous(0.3, 1)},
             {"dense", no_surface + homogeneous(8, 1)},
             {"forwards", no_surface + homogeneous(4, 1, 0.9)},
             {"backwards", no_surface + homogeneous(4, 1, -0.7)},
             {"coloured", no_surface + interior("homogeneous", rgb("sigma_s", "0.2, 1, 5"))},
             {"grid", no_surface + interior("heterogeneous", grid("sigma_t", cloud), number("albedo", 1))},
             {"in glass", in_glass + homogeneous(2, 1)},
             {"in rough glass", in_rough_glass + homogeneous(2, 1)},
         })
        expect_mean(means_over_seeds(test::Scene(camera_before(16, 35), sky, ball(body)).load(), 160, 8),
                    Colord::Ones(), name);
}

/// A camera looks through a slab of thickness 2 at a lamp at z = 4 behind it.
LoadedScene slab_before_lamp(const std::string& medium, const std::string& more = "") {
    return test::Scene(camera_before(4, 0.1), shape("cube", to_world(scale(3, 3, 1)), no_surface, medium),
                       lamp_at(scale(4) + rotate('y', 180) + translate(0, 0, 4), 1), more)
        .load();
}

// Lambert and Beer's law. Without scattering nothing is sampled, so every pixel is exact.
TEST(MediumAbsorption, FollowsTheExponentialLaw) {
    for (const Color& sigma : {Color(0.1f, 0.5f, 2.f), Color(0.f, 4.f, 0.f)}) {
        const auto scene = slab_before_lamp(
            interior("homogeneous", rgb("sigma_a", fmt::format("{}, {}, {}", sigma[0], sigma[1], sigma[2]))));
        expect_image(scene, (-2 * sigma).exp(), 3e-4f);
        EXPECT_EQ(mean_of(*render(scene, "path", 1)[Component::volume]).sum(), 0);
    }
}

// Paths of one edge show the lamp only, without light that the slab scatters.
TEST(MediumAbsorption, OfAScatteringMediumTakesWhatItScatters) {
    const auto scene = slab_before_lamp(homogeneous(0.7, 0.6), limited_to(1));
    expect_mean(means_over_seeds(scene, 256, 16), Colord::Constant(std::exp(-1.4)), "emission through the slab");
}

TEST(MediumAbsorption, FillsTheExteriorAndTheCamerasSpace) {
    const std::string air = "<medium type='homogeneous' id='air'>" + rgb("sigma_a", "0.1, 0.2, 0.3") + "</medium>";
    const auto scene = test::Scene(air, camera_before(4, 1, reference("air")),
                                   shape("rectangle", to_world(scale(4), rotate('y', 180)),
                                         "<ref name='exterior' id='air'/>", area_light(1)))
                           .load();
    const auto image = render(scene, "path", 1);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(image.total().at(5)[c], std::exp(-0.4f * static_cast<float>(c + 1)), 1e-4f);
}

/// Radiance that is scattered once towards a camera at (0, 0, -4), which looks along z. A homogeneous medium fills
/// the space between z = -1 and 1; a point light of intensity 1 lies in it at (x, 0, z). The radiance is the integral
/// of sigma_s p I / r^2 exp(-sigma_t (t + r)) dt.
double single_scattering(double sigma, double albedo, double g, double x, double z) {
    double sum = 0;
    constexpr int steps = 200000;
    for (int i = 0; i < steps; ++i) {
        const double at = -1 + 2 * (i + 0.5) / steps;
        const double r2 = x * x + (at - z) * (at - z), r = std::sqrt(r2);
        // The cosine between the light's direction, (at - z) / r on the axis, and the direction to the camera, -z.
        const double turned = -(at - z) / r;
        const double phase = (1 - g * g) / (4 * pi_d * std::pow(1 + g * g - 2 * g * turned, 1.5));
        sum += sigma * albedo * phase / r2 * std::exp(-sigma * ((at + 1) + r)) * 2 / steps;
    }
    return sum;
}

TEST(MediumScattering, OnceIsItsIntegral) {
    for (const auto& [sigma, albedo, g] : {std::array{0.5, 0.8, 0.0}, {1.5, 0.5, 0.6}, {0.8, 1.0, -0.5}}) {
        const auto scene =
            test::Scene(camera_before(2, 0.05), limited_to(2), emitter("point", point("position", 0.4, 0, 0.1)),
                        shape("cube", to_world(scale(50, 50, 1)), no_surface, homogeneous(sigma, albedo, g)))
                .load();
        expect_mean(means_over_seeds(scene, 4096, 16, Component::volume),
                    Colord::Constant(single_scattering(sigma, albedo, g, 0.4, 0.1)), fmt::format("g = {}", g));
    }
}

// The density is given once as a number and once as a grid. All orders of scattering count, with light from one side.
TEST(MediumScattering, OnAGridIsThatOfTheSameMediumWithout) {
    const TemporaryFolder folder;
    const std::string one = folder.write("d.vol", volume_bytes({2, 2, 2}, 1, std::vector<float>(8, 1.f)));
    const std::string before = camera_before(16, 40) + side_lamp;
    const std::string on_grid = interior("heterogeneous", grid("sigma_t", one), number("scale", 1.5),
                                         number("albedo", 0.9), element("phase", "hg", number("g", 0.4)));
    expect_same(before + cube(homogeneous(1.5, 0.9, 0.4)), before + cube(on_grid));
}

// A medium dims the light on its way to a surface, both for light sampling and for bsdf samples: on its way down
// through the slab of thickness 2 and on its way back up.
TEST(MediumAbsorption, ActsOnDirectLight) {
    const std::string floor = shape("rectangle", to_world(rotate('y', 180), translate(0, 0, 3)), diffuse(0.5));
    const auto scene = test::Scene(camera_before(4, 1), sun("0, 0, 1", 2), floor,
                                   cube(interior("homogeneous", number("sigma_a", 0.5))))
                           .load();
    EXPECT_NEAR(mean_of(render(scene, "path", 1).total())[0], 0.5 * 2 / pi_d * std::exp(-2.0), 1e-4);
}

// The boundary is [-1, 1]^3. As in Mitsuba 3, a constvolume is the unit cube under its to_world, and a number is a
// constvolume.
TEST(MediumCube, EndsTheMedium) {
    const Color once = Color(-1.f, -2.f, 0.f).exp();
    struct Seen {
        double at;  ///< x of the view
        std::string sigma_t;
        Color transmittance;
    };
    const std::string unit = "<translate value='-0.5'/>";
    for (const auto& [at, sigma_t, transmittance] : {
             Seen{0.5, constant("sigma_t", "1 2 0"), once},
             Seen{-0.5, constant("sigma_t", "1 2 0"), Color::Ones()},
             Seen{0.5, rgb("sigma_t", "1 2 0"), once},
             Seen{0, constant("sigma_t", "1 2 0", "<translate value='-0.5, -0.5, -0.5'/>"), once},
             Seen{0, constant("sigma_t", "1 2 0", unit + "<scale z='0.5'/>"), once.sqrt()},
         }) {
        SCOPED_TRACE(sigma_t);
        const std::string medium = interior("heterogeneous", number("albedo", 0), sigma_t);
        expect_image(test::Scene(narrow_camera(at, at == 0 ? 0 : 0.5, 0.1, 4), sky, cube(medium)).load(), transmittance,
                     1e-5f);
    }
}

// The cube of the volume is the boundary of the other medium. Light from one side shows where it is scattered.
TEST(MediumCube, ScattersLikeABoundaryThere) {
    const std::string albedo = number("albedo", 0.9), before = wide_camera + side_lamp;
    expect_same(
        before + cube(interior("homogeneous", albedo, rgb("sigma_t", "1 3 6")), 0.5),
        before + cube(interior("heterogeneous", albedo, constant("sigma_t", "1 3 6", "<translate value='-0.5'/>"))));
}

TEST(MediumAlbedo, OfAConstantVolumeIsTheConstant) {
    const auto image = [&](const std::string& albedo) {
        return render(
                   test::Scene(wide_camera, sky, cube(interior("homogeneous", number("sigma_t", 0.5), albedo))).load(),
                   "path", 4)
            .total();
    };
    EXPECT_EQ(image(rgb("albedo", "0.2, 0.5, 0.8")).rgb, image(constant("albedo", "0.2 0.5 0.8")).rgb);
}

// The albedo is 0.9 on the lamp's side and 0.1 on the other. A grid of one extinction is the same medium.
TEST(MediumAlbedo, OfAHomogeneousMediumMayVary) {
    const TemporaryFolder folder;
    const auto volume = [&](const std::string& name, const std::vector<float>& values) {
        return grid(name, folder.write(name + ".vol", volume_bytes({2, 1, 1}, 1, values)),
                    text("filter_type", "nearest"));
    };
    const std::string albedo = volume("albedo", {0.9f, 0.1f}), twice = number("scale", 2),
                      before = wide_camera + side_lamp, varying = before + cube(interior("homogeneous", twice, albedo));
    expect_same(varying, before + cube(interior("heterogeneous", twice, albedo, volume("sigma_t", {1, 1}))));
    const auto green = [&](const std::string& scene) {
        return means_over_seeds(scene_of(scene_xml(scene)), 64, 4)[0].mean();
    };
    EXPECT_GT(green(varying), 1.2 * green(before + cube(interior("homogeneous", twice, number("albedo", 0.5)))));
}

}  // namespace
}  // namespace gib::media_test
