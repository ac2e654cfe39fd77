// Point lights close to a surface: the share of their light that lands on spots too small for paths from the camera, against the
// closed form, and the warning of path tracing.

#include "methods/path/lit_spots.h"
#include "tests/support/scene_fixtures.h"

#include <cmath>

namespace gib::test::lit_spots_test {
namespace {

LoadedScene square_under(const std::string& light, const std::string& material = diffuse(0.5)) {
    return Scene(element("sensor", "orthographic", box_film(4)), shape("rectangle", to_world(scale(10)), material),
                 light)
        .load();
}

// A ray at the angle t from the normal lights the area h^2 / cos^3 t a steradian. It is below a where
// cos t > (h^2 / a)^(1/3), a share (1 - (h^2 / a)^(1/3)) / 2 of all directions. 4096 points of Sobol's sequence find an area
// of the square within 0.005.
TEST(LitSpots, OfAPointLightHaveTheShareOfTheClosedForm) {
    for (const double h : {1e-4, 1e-3, 0.01, 0.02, 0.1}) {
        const auto scene = square_under(emitter("point", test::point("position", 0.3, 0.2, h)));
        const double cosine = std::cbrt(h * h / (1e-6 * std::pow(double{scene.scene->diagonal()}, 2)));
        const auto spots = lit_spots(*scene.scene);
        EXPECT_NEAR(spots ? spots->share : 0, std::max(0., (1 - cosine) / 2), 0.005) << h;
        if (spots) {
            EXPECT_NEAR(double{spots->distance}, h, 0.1 * h);
        }
        const auto warning = [&](const char* method) { return seldom_found_light(*scene.scene, {method, {}}); };
        EXPECT_EQ(warning("path").find("point light (light 1 of 1)") != std::string::npos, cosine < 0.9) << h;
        EXPECT_EQ(warning("bidirectional"), "");
    }
}

TEST(LitSpots, AlsoOfSmallLampsThatFaceASurface) {
    const auto share = [](double size, double z) {
        const auto spots =
            lit_spots(*square_under(shape("rectangle", to_world(scale(size), rotate('x', 180), translate(0.3, 0.2, z)),
                                          area_light("1, 1, 1")))
                           .scene);
        return spots ? spots->share : 0;
    };
    EXPECT_GT(share(1e-4, 1e-3), 0.5);
    EXPECT_EQ(share(0.1, 1e-3), 0) << "paths from the camera find what a large lamp lights";
    EXPECT_EQ(share(1e-4, 1), 0);
}

TEST(LitSpots, AreOnlyWhereLightIsScattered) {
    const std::string near = test::point("position", 0.3, 0.2, 1e-4);
    EXPECT_FALSE(lit_spots(*square_under(emitter("point", near), bsdf("conductor")).scene));
    const auto spot = [](double z) {
        return emitter("spot", number("cutoff_angle", 30),
                       to_world(look_at("0, 0, 1e-4", fmt::format("0, 0, {}", z), "0, 1, 0")));
    };
    EXPECT_NEAR(lit_spots(*square_under(spot(0)).scene)->share, 1, 1e-6);
    EXPECT_FALSE(lit_spots(*square_under(spot(1)).scene));
}

// The power of other lights counts, too: a second point light of three times the power halves the share twice.
TEST(LitSpots, HaveAShareOfAllPower) {
    const auto point = [](double z, double intensity) {
        return emitter("point", test::point("position", 0, 0, z), rgb("intensity", intensity));
    };
    const double alone = lit_spots(*square_under(point(1e-4, 1)).scene)->share;
    const auto both = lit_spots(*square_under(point(2, 3) + point(1e-4, 1)).scene);
    EXPECT_NEAR(both->share, alone / 4, 0.005);
    EXPECT_EQ(both->light, 1u);
}

}  // namespace
}  // namespace gib::test::lit_spots_test
