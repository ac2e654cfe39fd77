// Media in the path tracer, against furnaces and integrals in closed or numerical form.

#include "tests/support/scene_text.h"
#include "tests/support/seed_means.h"
#include "tests/support/volume_file.h"

#include <fmt/format.h>
#include <numbers>

namespace gib::medium_test {
namespace {

using test::box_film;
using test::mean_of;
using test::means_over_seeds;
using test::Moments;
using test::render;
using test::scene_of;
using test::scene_xml;
using test::TemporaryFolder;
using test::volume_bytes;

constexpr double pi_d = std::numbers::pi;
constexpr double sigmas = 5;  ///< allowed errors, in standard errors of means over seeds

const std::string constant_sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
const std::string no_surface = "<bsdf type='null'/>";

std::string camera(int size, double fov, const std::string& more = "") {
    return fmt::format(
        "<sensor type='perspective'><float name='fov' value='{}'/><transform name='to_world'><translate "
        "z='-4'/></transform>{}{}</sensor>",
        fov, more, box_film(size));
}
std::string interior(const std::string& type, const std::string& body) {
    return "<medium name='interior' type='" + type + "'>" + body + "</medium>";
}
std::string homogeneous(double sigma, double albedo, double g = 0) {
    return interior(
        "homogeneous",
        fmt::format("<float name='sigma_t' value='{}'/><float name='albedo' value='{}'/><phase type='hg'><float "
                    "name='g' value='{}'/></phase>",
                    sigma, albedo, g));
}
std::string ball(const std::string& content) { return "<shape type='sphere'>" + content + "</shape>"; }

std::string grid(const std::string& name, const std::string& file) {
    return "<volume name='" + name + "' type='gridvolume'><string name='filename' value='" + file +
           "'/><transform name='to_world'><translate value='-0.5'/><scale value='2'/></transform></volume>";
}

void expect_mean(const std::array<Moments, 3>& found, const Colord& expected, const std::string& what) {
    for (int c = 0; c < 3; ++c) {
        const Moments& m = found[static_cast<std::size_t>(c)];
        EXPECT_NEAR(m.mean(), expected[c], sigmas * m.standard_error() + 1e-6) << what << ", channel " << c;
        EXPECT_LT(m.standard_error(), 0.01 * expected[c]) << what << ": the test would not see an error";
    }
}

// Light scattered once in the cube [-1, 1]^3 of extinction s and albedo a, seen along -z through its middle, under a distant
// light of irradiance E. Across the view it has come through 1 of the medium: a E p exp(-s) (1 - exp(-2 s)). Along the view,
// light and path share the way: a E p 2 s exp(-2 s). The width of the film changes the first by less than 1e-3.
TEST(RayleighMedium, ScattersTwiceAsMuchAheadAsAcross) {
    constexpr double s = 0.5, a = 0.8, E = 40;
    const std::string view =
        "<integrator type='path'><integer name='max_depth' value='2'/></integrator><sensor "
        "type='orthographic'><transform "
        "name='to_world'><scale x='0.05' y='0.05'/><lookat origin='0, 0, 5' target='0, 0, 0' up='0, 1, "
        "0'/></transform>" +
        box_film(8) + "</sensor>";
    const std::string cube =
        "<shape type='cube'>" + no_surface +
        interior("homogeneous", fmt::format("<float name='sigma_t' value='{}'/><float name='albedo' "
                                            "value='{}'/><phase type='rayleigh'/>",
                                            s, a)) +
        "</shape>";
    const auto lit_along = [&](const std::string& direction) {
        return means_over_seeds(
            scene_of(scene_xml(view + cube +
                               fmt::format("<emitter type='directional'><vector name='direction' value='{}'/><rgb "
                                           "name='irradiance' value='{}'/></emitter>",
                                           direction, E))),
            64, 16);
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
    const std::string glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    const std::string rough =
        "<bsdf type='roughdielectric'><float name='alpha' value='0.001'/><float name='int_ior' value='1.2'/><float "
        "name='ext_ior' value='1'/></bsdf>";
    const std::vector<std::pair<std::string, std::string>> bodies = {
        {"thin", ball(no_surface + homogeneous(0.3, 1))},
        {"dense", ball(no_surface + homogeneous(8, 1))},
        {"forwards", ball(no_surface + homogeneous(4, 1, 0.9))},
        {"backwards", ball(no_surface + homogeneous(4, 1, -0.7))},
        {"coloured", ball(no_surface + interior("homogeneous", "<rgb name='sigma_s' value='0.2, 1, 5'/>"))},
        {"grid",
         ball(no_surface + interior("heterogeneous", grid("sigma_t", cloud) + "<float name='albedo' value='1'/>"))},
        {"in glass", ball(glass + homogeneous(2, 1))},
        {"in rough glass", ball(rough + homogeneous(2, 1))},
    };
    for (const auto& [name, body] : bodies)
        expect_mean(means_over_seeds(scene_of(scene_xml(camera(16, 35) + constant_sky + body)), 160, 8), Colord::Ones(),
                    name);
}

/// A camera looks through a slab of thickness 2 at a lamp at z = 4 behind it.
std::string slab_before_lamp(const std::string& medium) {
    return camera(4, 0.1) + "<shape type='cube'><transform name='to_world'><scale x='3' y='3'/></transform>" +
           no_surface + medium +
           "</shape><shape type='rectangle'><transform name='to_world'><scale value='4'/><rotate y='1' "
           "angle='180'/><translate "
           "z='4'/></transform><emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>";
}

// Lambert and Beer's law. Without scattering nothing is sampled, so every pixel is exact.
TEST(MediumAbsorption, FollowsTheExponentialLaw) {
    for (const Color& sigma : {Color(0.1f, 0.5f, 2.f), Color(0.f, 4.f, 0.f)}) {
        const auto scene = scene_of(scene_xml(slab_before_lamp(interior(
            "homogeneous", fmt::format("<rgb name='sigma_a' value='{}, {}, {}'/>", sigma[0], sigma[1], sigma[2])))));
        const auto image = render(scene, "path", 1);
        for (std::size_t i = 0; i < 16; ++i)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(image.total().at(i)[c], std::exp(-2 * sigma[c]), 3e-4f * std::exp(-2 * sigma[c]));
        EXPECT_EQ(mean_of(*image[Component::volume]).sum(), 0);
    }
}

// No light comes from infinity through a medium without a boundary, in the channels that it absorbs.
TEST(MediumAbsorption, HidesLightsAtInfinityIfItHasNoBoundary) {
    const std::string fog = "<medium type='homogeneous' id='fog'><rgb name='sigma_a' value='0.5, 0, 0.5'/></medium>";
    const std::string wall_and_floor =
        "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='180'/></transform></shape>"
        "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><translate y='-1' z='-1'/>"
        "</transform></shape>";
    const std::string sun = "<emitter type='directional'><vector name='direction' x='0.3' y='-0.5' z='1'/></emitter>";
    for (const std::string& light : {constant_sky, sun})
        for (const char* method : {"path", "light_tracer", "bidirectional", "vcm", "photon_mapper photons=1e4",
                                   "progressive_photon_mapper"}) {
            const auto image =
                render(scene_of(scene_xml(fog + camera(8, 40, "<ref id='fog'/>") + wall_and_floor + light)), method, 4);
            const Colord found = mean_of(image.total());
            EXPECT_EQ(found[0], 0) << method;
            EXPECT_GT(found[1], 0.05) << method;
            EXPECT_EQ(found[2], 0) << method;
        }
}

// Paths of one edge show the lamp only, without light that the slab scatters.
TEST(MediumAbsorption, OfAScatteringMediumTakesWhatItScatters) {
    const auto scene =
        scene_of(scene_xml(slab_before_lamp(homogeneous(0.7, 0.6)) + "<integrator type='path'><integer "
                                                                     "name='max_depth' value='1'/></integrator>"));
    expect_mean(means_over_seeds(scene, 256, 16), Colord::Constant(std::exp(-1.4)), "emission through the slab");
}

TEST(MediumAbsorption, FillsTheExteriorAndTheCamerasSpace) {
    const std::string air = "<medium type='homogeneous' id='air'><rgb name='sigma_a' value='0.1, 0.2, 0.3'/></medium>";
    const auto scene = scene_of(
        scene_xml(air + camera(4, 1, "<ref id='air'/>") +
                  "<shape type='rectangle'><transform name='to_world'><scale value='4'/><rotate y='1' "
                  "angle='180'/></transform><ref "
                  "name='exterior' id='air'/><emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>"));
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
        const auto scene = scene_of(scene_xml(
            camera(2, 0.05) + "<integrator type='volpath'><integer name='max_depth' value='2'/></integrator>" +
            "<emitter type='point'><point name='position' value='0.4, 0, 0.1'/></emitter>" +
            "<shape type='cube'><transform name='to_world'><scale x='50' y='50'/></transform>" + no_surface +
            homogeneous(sigma, albedo, g) + "</shape>"));
        expect_mean(means_over_seeds(scene, 4096, 16, Component::volume),
                    Colord::Constant(single_scattering(sigma, albedo, g, 0.4, 0.1)), fmt::format("g = {}", g));
    }
}

// The density is given once as a number and once as a grid. All orders of scattering count, with light from one side.
TEST(MediumScattering, OnAGridIsThatOfTheSameMediumWithout) {
    const TemporaryFolder folder;
    const std::string one = folder.write("d.vol", volume_bytes({2, 2, 2}, 1, std::vector<float>(8, 1.f)));
    const std::string lamp =
        "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='90'/><translate "
        "x='-3'/></transform><emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>";
    const std::string phase = "<phase type='hg'><float name='g' value='0.4'/></phase>";
    const std::string box = "<shape type='cube'>" + no_surface;
    const auto constant = scene_of(scene_xml(camera(16, 40) + lamp + box + homogeneous(1.5, 0.9, 0.4) + "</shape>"));
    const auto on_grid = scene_of(scene_xml(
        camera(16, 40) + lamp + box +
        interior("heterogeneous",
                 grid("sigma_t", one) + "<float name='scale' value='1.5'/><float name='albedo' value='0.9'/>" + phase) +
        "</shape>"));
    const auto a = means_over_seeds(constant, 64, 12), b = means_over_seeds(on_grid, 64, 12);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(a[c].mean(), b[c].mean(), sigmas * std::hypot(a[c].standard_error(), b[c].standard_error()));
        EXPECT_LT(b[c].standard_error(), 0.01 * b[c].mean());
    }
}

// A medium dims the light on its way to a surface, both for light sampling and for bsdf samples.
TEST(MediumAbsorption, ActsOnDirectLight) {
    const std::string floor =
        "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='180'/><translate z='3'/></transform>" +
        test::diffuse(0.5) + "</shape>";
    const std::string sun =
        "<emitter type='directional'><vector name='direction' value='0, 0, 1'/><rgb name='irradiance' "
        "value='2'/></emitter>";
    const auto scene = scene_of(scene_xml(camera(4, 1) + sun + floor + "<shape type='cube'>" + no_surface +
                                          interior("homogeneous", "<float name='sigma_a' value='0.5'/>") + "</shape>"));
    // The light passes the slab of thickness 2 on its way down and on its way back up.
    EXPECT_NEAR(mean_of(render(scene, "path", 1).total())[0], 0.5 * 2 / pi_d * std::exp(-2.0), 1e-4);
}

}  // namespace
}  // namespace gib::medium_test
