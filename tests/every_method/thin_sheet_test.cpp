// Thin sheets, through which light goes straight on without a vertex, for every method; the registry is walked.
#include "tests/support/same_means.h"
#include "tests/support/seed_means.h"

#include <fmt/format.h>
#include <numbers>

namespace gib::thin_sheet_test {
namespace {

using test::box_film;
using test::mean_of;
using test::render;
using test::scene_of;
using test::scene_xml;

/// R' = 2 r / (1 + r) at normal incidence, with r = ((eta - 1) / (eta + 1))^2.
double reflectance(double eta) {
    const double r = (eta - 1) / (eta + 1) * (eta - 1) / (eta + 1);
    return 2 * r / (1 + r);
}

std::string pane(double z, double eta, const std::string& more = "") {
    return fmt::format(
        "<shape type='rectangle'><transform name='to_world'><scale value='9'/><translate z='{}'/></transform><bsdf "
        "type='thindielectric'><float name='int_ior' value='{}'/><float name='ext_ior' value='1'/>{}</bsdf></shape>",
        z, eta, more);
}

/// Looks along -z from z = 5, all rays alike.
const std::string camera =
    "<sensor type='orthographic'><transform name='to_world'><scale value='0.5'/><rotate y='1' "
    "angle='180'/><translate z='5'/></transform>" +
    box_film(4) + "</sensor>";

class ThinSheets : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, ThinSheets, testing::ValuesIn(names_of_comparable_methods()),
                         [](const auto& name) { return name.param; });

// A path over a sheet that reflects has two edges, but one straight on has one, however many sheets are in its way. Under a
// sky of radiance 1, n sheets let T^n straight on, and the k-th sends R through k - 1 others twice.
TEST_P(ThinSheets, CostNoDepth) {
    if (!test::samples_pixels(find_method(GetParam()))) GTEST_SKIP() << "too noisy";
    const double R = reflectance(1.33), T = 1 - R;
    std::string panes;
    for (int i = 0; i < 10; ++i)
        panes += pane(0.1 * i, 1.33);
    const auto scene = scene_of(scene_xml(camera + panes + "<emitter type='constant'/>"));
    const double straight = std::pow(T, 10), once = R * (1 - std::pow(T, 20)) / (1 - T * T);
    EXPECT_NEAR(mean_of(render(scene, GetParam() + " max_depth=1", 256).total())[0], straight, 0.03);
    if (!find_method(GetParam()).simulates.has(Effect::specular_reflection)) return;
    EXPECT_NEAR(mean_of(render(scene, GetParam() + " max_depth=2", 256).total())[0], straight + once, 0.03);
}

// A sun shines straight down through two sheets, one of them red, onto a floor. Light sampling sees through both. Nothing
// is left to chance, so the tolerance is rounding alone.
TEST_P(ThinSheets, LetDirectLightThrough) {
    if (!test::samples_pixels(find_method(GetParam()))) GTEST_SKIP() << "too noisy";
    const auto scene = scene_of(scene_xml(
        "<sensor type='perspective'><float name='fov' value='20'/><transform name='to_world'><rotate y='1' "
        "angle='180'/><translate z='1'/></transform>" +
        box_film(4) +
        "</sensor><emitter type='directional'><vector name='direction' value='0, 0, -1'/><rgb name='irradiance' "
        "value='2'/></emitter><shape type='rectangle'><bsdf type='diffuse'><rgb name='reflectance' "
        "value='0.5'/></bsdf></shape>" +
        pane(2, 1.5) + pane(3, 1.7, "<rgb name='specular_transmittance' value='0.9, 0.3, 0'/>")));
    const auto image = render(scene, GetParam(), 1);
    const double straight = 0.5 * 2 / std::numbers::pi * (1 - reflectance(1.5)) * (1 - reflectance(1.7));
    const Colord direct = mean_of(*image[Component::direct]);
    const Colord tint(0.9, 0.3, 0);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(direct[c], straight * tint[c], 1e-5);
}

// A room with a lamp behind a slanted, coloured sheet, and with a mixture of such a sheet and a diffuse surface.
TEST(ThinSheet, AllMethodsAgree) {
    const std::string bsdfs =
        "<bsdf type='thindielectric' id='tinted'><float name='int_ior' value='2'/><float name='ext_ior' "
        "value='1'/><rgb "
        "name='specular_transmittance' value='0.9, 0.5, 0.2'/></bsdf><bsdf type='blendbsdf' id='mixed'><float "
        "name='weight' value='0.5'/><ref id='tinted'/><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf>";
    const auto sheet = [](const std::string& id, double z, double angle) {
        return fmt::format(
            "<shape type='rectangle'><transform name='to_world'><scale value='0.7'/><rotate x='1' "
            "angle='{}'/><translate "
            "z='{}'/></transform><ref id='{}'/></shape>",
            angle, z, id);
    };
    const std::string room =
        "<shape type='cube'><boolean name='flip_normals' value='true'/><transform name='to_world'><scale "
        "value='2'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='0.6'/></bsdf></shape>";
    const std::string lamp =
        "<shape type='rectangle'><transform name='to_world'><scale value='0.5'/><rotate x='1' angle='180'/><translate "
        "z='1.8'/></transform><emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>";
    const auto scene = scene_of(scene_xml(
        bsdfs +
        "<sensor type='perspective'><float name='fov' value='60'/><transform name='to_world'><lookat origin='0, -1.8, "
        "-0.5' target='0, 0, 0' up='0, 0, 1'/></transform>" +
        box_film(8) + "</sensor>" + room + lamp + sheet("tinted", 1, 20) + sheet("mixed", -1, 0)));
    test::expect_same_means(scene, {"path", "bidirectional", "vcm"}, 128);
    // The photon mapper blurs light over its look-ups.
    const auto expected = test::means_over_seeds(scene, 256, 12);
    const auto found = test::means_over_seeds(scene, 32, 12, {}, "photon_mapper photons=1e5");
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(
            found[c].mean(), expected[c].mean(),
            0.02 * expected[c].mean() + 5 * std::hypot(found[c].standard_error(), expected[c].standard_error()));
}

}  // namespace
}  // namespace gib::thin_sheet_test
