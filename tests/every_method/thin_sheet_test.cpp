// Thin sheets, through which light goes straight on without a vertex, for every method; the registry is walked.
#include "tests/support/methods_under_test.h"
#include "tests/support/same_means.h"
#include "tests/support/seed_means.h"

#include <numbers>

namespace gib::thin_sheet_test {
namespace {

using namespace test;

/// R' = 2 r / (1 + r) at normal incidence, with r = ((eta - 1) / (eta + 1))^2.
double reflectance(double eta) {
    const double r = (eta - 1) / (eta + 1) * (eta - 1) / (eta + 1);
    return 2 * r / (1 + r);
}

std::string thin(double eta, const std::string& more = "") {
    return bsdf("thindielectric", number("int_ior", eta), number("ext_ior", 1), more);
}
std::string pane(double z, double eta, const std::string& more = "") {
    return shape("rectangle", to_world(scale(9), translate(0, 0, z)), thin(eta, more));
}

class ThinSheets : public OfAMethod {};
INSTANTIATE_TEST_SUITE_P(Registry, ThinSheets, testing::ValuesIn(methods_that_sample_pixels(Work::small)),
                         name_of_method);

// A path over a sheet that reflects has two edges, but one straight on has one, however many sheets are in its way. Under a
// sky of radiance 1, n sheets let T^n straight on, and the k-th sends R through k - 1 others twice. The camera looks along
// -z from z = 5, all rays alike.
TEST_P(ThinSheets, CostNoDepth) {
    const double R = reflectance(1.33), T = 1 - R;
    std::string panes;
    for (int i = 0; i < 10; ++i)
        panes += pane(0.1 * i, 1.33);
    const auto scene = test::Scene(element("sensor", "orthographic",
                                           to_world(scale(0.5), rotate('y', 180), translate(0, 0, 5)), box_film(4)),
                                   panes, emitter("constant"))
                           .load();
    const double straight = std::pow(T, 10), once = R * (1 - std::pow(T, 20)) / (1 - T * T);
    EXPECT_NEAR(mean_of(rendered(scene, 256, "max_depth=1").total())[0], straight, 0.03);
    if (!method().simulates(Effect::specular_reflection)) return;
    EXPECT_NEAR(mean_of(rendered(scene, 256, "max_depth=2").total())[0], straight + once, 0.03);
}

// A sun shines straight down through two sheets, one of them red, onto a floor. Light sampling sees through both. Nothing
// is left to chance, so the tolerance is rounding alone.
TEST_P(ThinSheets, LetDirectLightThrough) {
    const auto scene = test::Scene(camera(20, to_world(rotate('y', 180), translate(0, 0, 1)), box_film(4)),
                                   emitter("directional", vector("direction", 0, 0, -1), rgb("irradiance", 2)),
                                   shape("rectangle", one_sided("0.5")), pane(2, 1.5),
                                   pane(3, 1.7, rgb("specular_transmittance", "0.9, 0.3, 0")))
                           .load();
    const auto image = rendered(scene, 1);
    const double straight = 0.5 * 2 / std::numbers::pi * (1 - reflectance(1.5)) * (1 - reflectance(1.7));
    const Colord direct = mean_of(*image[Component::direct]);
    const Colord tint(0.9, 0.3, 0);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(direct[c], straight * tint[c], 1e-5);
}

// A room with a lamp behind a slanted, coloured sheet, and with a mixture of such a sheet and a diffuse surface.
TEST(ThinSheet, AllMethodsAgree) {
    const std::string tinted = thin(2, rgb("specular_transmittance", "0.9, 0.5, 0.2"));
    const auto sheet = [](const std::string& material, double z, double angle) {
        return shape("rectangle", to_world(scale(0.7), rotate('x', angle), translate(0, 0, z)), material);
    };
    const auto scene =
        test::Scene(camera(60, to_world(look_at("0, -1.8, -0.5", "0, 0, 0", "0, 0, 1")), box_film(8)),
                    shape("cube", flag("flip_normals"), to_world(scale(2)), one_sided("0.6")),
                    shape("rectangle", to_world(scale(0.5), rotate('x', 180), translate(0, 0, 1.8)), area_light(5)),
                    sheet(tinted, 1, 20),
                    sheet(bsdf("blendbsdf", number("weight", 0.5), tinted, bsdf("twosided", bsdf("diffuse"))), -1, 0))
            .load();
    std::vector<std::string> exact = {"path"}, blurred;
    for (const MethodUnderTest& method : methods_under_test(Work::fine))
        if (method.label != "path" && method.resolves(*scene.scene))
            (method.description->unbiased || method.estimates_bias() ? exact : blurred).push_back(method.label);
    EXPECT_GE(exact.size() + blurred.size(), 4u);
    expect_same_means(scene, exact, 128);
    // The photon mapper blurs light over its look-ups.
    const auto expected = means_over_seeds(scene, 256, 12);
    for (const std::string& label : blurred) {
        const auto found = means_over_seeds(scene, 32, 12, {}, label);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(
                found[c].mean(), expected[c].mean(),
                0.02 * expected[c].mean() + 5 * std::hypot(found[c].standard_error(), expected[c].standard_error()))
                << label;
    }
}

}  // namespace
}  // namespace gib::thin_sheet_test
