// Volumes of media: the cube of a constvolume, and an albedo that varies.

#include "tests/support/scene_text.h"
#include "tests/support/seed_means.h"
#include "tests/support/volume_file.h"

#include <fmt/format.h>

namespace gib::medium_volume_test {
namespace {

using test::box_film;
using test::means_over_seeds;
using test::render;
using test::scene_of;
using test::scene_xml;

constexpr double sigmas = 5;  ///< allowed errors, in standard errors of means over seeds: false alarm below 1e-4 a test

const std::string sky = "<emitter type='constant'/>";

/// Looks along -z from z = 5 at what lies within 0.1 of (x, y).
std::string narrow_camera(double x, double y) {
    return fmt::format(
        "<sensor type='orthographic'><transform name='to_world'><scale x='0.1' y='0.1'/><lookat origin='{0}, {1}, 5' "
        "target='{0}, {1}, 0' up='0, 1, 0'/></transform>{2}</sensor>",
        x, y, box_film(4));
}
std::string cube(const std::string& type, const std::string& medium, double scale = 1) {
    return fmt::format(
        "<shape type='cube'><transform name='to_world'><scale value='{}'/></transform><bsdf type='null'/><medium "
        "type='{}' name='interior'>{}</medium></shape>",
        scale, type, medium);
}
std::string constant(const std::string& name, const std::string& value, const std::string& to_world = "") {
    return "<volume type='constvolume' name='" + name + "'><rgb name='value' value='" + value +
           "'/><transform name='to_world'>" + to_world + "</transform></volume>";
}

void expect_transmittance(const std::string& body, const Color& expected) {
    const auto image = render(scene_of(scene_xml(body)), "path", 1).total();
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(image.at(i)[c], expected[c], 1e-5f) << body;
}

// The boundary is [-1, 1]^3. As in Mitsuba 3, a constvolume is the unit cube under its to_world, and a number is a
// constvolume.
TEST(MediumCube, EndsTheMedium) {
    const std::string black = "<float name='albedo' value='0'/>";
    const Color once = Color(-1.f, -2.f, 0.f).exp();
    expect_transmittance(narrow_camera(0.5, 0.5) + sky + cube("heterogeneous", black + constant("sigma_t", "1 2 0")),
                         once);
    expect_transmittance(narrow_camera(-0.5, 0.5) + sky + cube("heterogeneous", black + constant("sigma_t", "1 2 0")),
                         Color::Ones());
    expect_transmittance(
        narrow_camera(0.5, 0.5) + sky + cube("heterogeneous", black + "<rgb name='sigma_t' value='1 2 0'/>"), once);
    expect_transmittance(
        narrow_camera(0, 0) + sky +
            cube("heterogeneous", black + constant("sigma_t", "1 2 0", "<translate value='-0.5, -0.5, -0.5'/>")),
        once);
    expect_transmittance(
        narrow_camera(0, 0) + sky +
            cube("heterogeneous", black + constant("sigma_t", "1 2 0", "<translate value='-0.5'/><scale z='0.5'/>")),
        once.sqrt());
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

const std::string wide_camera =
    "<sensor type='perspective'><float name='fov' value='30'/><transform name='to_world'><translate "
    "z='-4'/></transform>" +
    box_film(12) + "</sensor>";
const std::string lamp =
    "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='90'/><translate "
    "x='-3'/></transform><emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>";

// The cube of the volume is the boundary of the other medium. Light from one side shows where it is scattered.
TEST(MediumCube, ScattersLikeABoundaryThere) {
    const std::string albedo = "<float name='albedo' value='0.9'/>";
    expect_same(
        wide_camera + lamp + cube("homogeneous", albedo + "<rgb name='sigma_t' value='1 3 6'/>", 0.5),
        wide_camera + lamp + cube("heterogeneous", albedo + constant("sigma_t", "1 3 6", "<translate value='-0.5'/>")));
}

TEST(MediumAlbedo, OfAConstantVolumeIsTheConstant) {
    const std::string sigma = "<float name='sigma_t' value='0.5'/>";
    const auto image = [&](const std::string& albedo) {
        return render(scene_of(scene_xml(wide_camera + sky + cube("homogeneous", sigma + albedo))), "path", 4).total();
    };
    const auto a = image("<rgb name='albedo' value='0.2, 0.5, 0.8'/>"), b = image(constant("albedo", "0.2 0.5 0.8"));
    EXPECT_EQ(a.rgb, b.rgb);
}

// The albedo is 0.9 on the lamp's side and 0.1 on the other. A grid of one extinction is the same medium.
TEST(MediumAlbedo, OfAHomogeneousMediumMayVary) {
    const test::TemporaryFolder folder;
    const auto grid = [&](const std::string& name, const std::vector<float>& values) {
        const std::string file = folder.write(name + ".vol", test::volume_bytes({2, 1, 1}, 1, values));
        return "<volume name='" + name + "' type='gridvolume'><string name='filename' value='" + file +
               "'/><string name='filter_type' value='nearest'/><transform name='to_world'><translate "
               "value='-0.5'/><scale value='2'/></transform></volume>";
    };
    const std::string albedo = grid("albedo", {0.9f, 0.1f}), scale = "<float name='scale' value='2'/>";
    const std::string varying = wide_camera + lamp + cube("homogeneous", scale + albedo);
    expect_same(varying, wide_camera + lamp + cube("heterogeneous", scale + albedo + grid("sigma_t", {1, 1})));
    const auto one_albedo = means_over_seeds(
        scene_of(scene_xml(wide_camera + lamp + cube("homogeneous", scale + "<float name='albedo' value='0.5'/>"))), 64,
        4);
    EXPECT_GT(means_over_seeds(scene_of(scene_xml(varying)), 64, 4)[0].mean(), 1.2 * one_albedo[0].mean());
}

}  // namespace
}  // namespace gib::medium_volume_test
