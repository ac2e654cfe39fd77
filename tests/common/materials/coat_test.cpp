// Coated materials, rough diffuse surfaces and Ward's model against what is known of them in closed form.

#include "common/materials/fresnel.h"
#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"

namespace gib::test::coat_test {
namespace {

/// The bsdf of a rectangle.
Bsdf bsdf_of(const std::string& xml) { return *load(shape("rectangle", xml)).scene->material_of_shape(0).constant(); }

Vec3 at(double degrees, double azimuth = 0) {
    const double t = degrees * std::numbers::pi / 180, p = azimuth * std::numbers::pi / 180;
    return Vec3d(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)).cast<float>();
}

const std::string indices = number("int_ior", 1.5) + number("ext_ior", 1),
                  mirror = bsdf("conductor", text("material", "none"));

// Straight down: F = 0.04, and light that enters and leaves is left (1 - F)^2 exp(-2 sigma d).
TEST(Coating, AMirrorUnderACoatHasTwoReflections) {
    const Bsdf bsdf =
        bsdf_of(test::bsdf("coating", indices, rgb("sigma_a", "0 0.3 1"), number("thickness", 0.5), mirror));
    const Vec3 wo = at(0);
    Colord sum = Colord::Zero();
    for (const float u : {0.f, 0.9999f}) {
        const auto s = bsdf.sample_local(wo, Vec2(u, 0), Vec2(0.5f, 0.5f), Transport::radiance);
        ASSERT_TRUE(s && s->delta);
        EXPECT_LT((s->wi - wo).norm(), 1e-5f);
        sum += (s->f * std::abs(s->wi.z())).cast<double>();
    }
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(sum[k],
                    0.04 + sqr(0.96) * std::exp(-2 * 0.5 * std::array{0.0, 0.3, 1.0}[static_cast<std::size_t>(k)]),
                    1e-5);
}

TEST(Coating, ItsAbsorptionMayVaryOverTheSurface) {
    const auto material_of = [](const std::string& absorption) {
        return load(shape("rectangle", bsdf("coating", indices, number("thickness", 2), absorption, bsdf("diffuse"))))
            .scene;
    };
    const auto f = [](const Bsdf& b) { return b.f_local(at(20), at(50, 70)).sum(); };
    const std::string squares =
        named("texture", "sigma_a", "checkerboard", rgb("color0", "0.1 0.2 3"), rgb("color1", 0));
    const auto varying = material_of(squares);
    EXPECT_EQ(varying->material_of_shape(0).constant(), nullptr);
    for (const auto& [u, value] : {std::pair(0.25f, "0.1 0.2 3"), {0.75f, "0 0 0"}}) {
        const MaterialPoint point{.uv = Vec2(u, 0.25f),
                                  .ng = Vec3::UnitZ(),
                                  .dp_du = Vec3::UnitX(),
                                  .dp_dv = Vec3::UnitY(),
                                  .shading = Frame(Vec3::UnitZ())};
        const auto constant = material_of(rgb("sigma_a", value));
        EXPECT_TRUE((f(varying->material_of_shape(0).at(point)) == f(*constant->material_of_shape(0).constant())).all())
            << value;
    }
}

// A diffuse base under a coat is that of a plastic without the light that the plastic reflects back inside: without
// specular reflection, plastic's f is rho T T / (pi eta^2 (1 - rho R)).
TEST(Coating, ADiffuseBaseIsThatOfAPlasticWithoutInternalReflection) {
    const double rho = 0.4, R = static_cast<double>(diffuse_fresnel_reflectance(1 / 1.5f));
    const Bsdf coated = bsdf_of(bsdf("coating", indices, bsdf("diffuse", rgb("reflectance", rho)))),
               plastic = bsdf_of(bsdf("plastic", indices, rgb("diffuse_reflectance", rho), flag("nonlinear")));
    for (const auto& [o, i] : {std::pair(10.0, 50.0), {0.0, 0.0}, {80.0, 30.0}})
        EXPECT_NEAR(static_cast<double>(coated.f_local(at(o), at(i, 70)).sum()[0]),
                    static_cast<double>(plastic.f_local(at(o), at(i, 70)).sum()[0]) * (1 - rho * R), 1e-5);
}

TEST(Coating, ARoughOneIsThatOfARoughPlastic) {
    const std::string facets = indices + text("distribution", "ggx") + number("alpha", 0.3);
    const Bsdf coated = bsdf_of(bsdf("roughcoating", facets, bsdf("diffuse", rgb("reflectance", 0)))),
               plastic = bsdf_of(bsdf("roughplastic", facets, rgb("diffuse_reflectance", 0)));
    for (const auto& [o, i] : {std::pair(10.0, 50.0), {0.0, 0.0}, {80.0, 30.0}})
        EXPECT_FLOAT_EQ(coated.f_local(at(o), at(i, 70)).sum()[0], plastic.f_local(at(o), at(i, 70)).sum()[0]);
}

TEST(Coating, CoversBothSidesOfATwosided) {
    const std::string base = bsdf("diffuse", rgb("reflectance", 0.4));
    const Bsdf both = bsdf_of(bsdf("coating", indices, bsdf("twosided", base))),
               front = bsdf_of(bsdf("coating", indices, base));
    const Vec3 o = at(20), i = at(60, 100), o_below(o.x(), o.y(), -o.z()), i_below(i.x(), i.y(), -i.z());
    EXPECT_FLOAT_EQ(both.f_local(o_below, i_below).sum()[0], front.f_local(o, i).sum()[0]);
    EXPECT_TRUE(is_black(front.f_local(o_below, i_below).sum()));
    EXPECT_EQ(both.coefficients_local(o_below).specular[0], front.coefficients_local(o).specular[0]);
    EXPECT_GT(both.coefficients_local(o_below).specular[0], 0.03f);
}

TEST(Coating, RefusesWhatItCannotCover) {
    const auto error_of = [](const std::string& inside) {
        return input_error_of([&] { bsdf_of(bsdf("coating", inside)); });
    };
    EXPECT_THAT(error_of(bsdf("dielectric")), ::testing::HasSubstr("must not transmit light"));
    EXPECT_THAT(error_of(bsdf("mask", bsdf("diffuse"))), ::testing::HasSubstr("must not transmit light"));
    EXPECT_THAT(error_of(bsdf("coating", bsdf("diffuse"))), ::testing::HasSubstr("must not tilt normals or be coated"));
    EXPECT_THAT(error_of(""), ::testing::HasSubstr("takes one bsdf, found 0"));
}

// Oren and Nayar 1994, equations 30 and 31, at normal incidence: C1 rho / pi and rho^2 / pi 0.17 sigma^2 / (sigma^2 + 0.13).
TEST(RoughDiffuse, HasItsPublishedValues) {
    const double sigma2 = 0.5 * sqr(0.6), rho = 0.7;
    const auto f = [&](const std::string& more, const Vec3& wo, const Vec3& wi) {
        return static_cast<double>(bsdf_of(bsdf("roughdiffuse", rgb("reflectance", rho), number("alpha", 0.6), more))
                                       .f_local(wo, wi)
                                       .sum()[0]);
    };
    const double c1 = 1 - 0.5 * sigma2 / (sigma2 + 0.33), c2 = 0.45 * sigma2 / (sigma2 + 0.09);
    EXPECT_NEAR(f("", at(0), at(0)), rho / std::numbers::pi * (c1 + rho * 0.17 * sigma2 / (sigma2 + 0.13)), 1e-6);
    // The retroreflection of the qualitative model, equation 32, at 60 degrees: sin tan = 3/2.
    EXPECT_NEAR(f(flag("use_fast_approx"), at(60), at(60)), rho / std::numbers::pi * (c1 + 1.5 * c2), 1e-5);
    EXPECT_NEAR(f(flag("use_fast_approx"), at(60), at(60, 180)), rho / std::numbers::pi * c1, 1e-6);
    // Light comes back to where it came from.
    EXPECT_GT(f("", at(60), at(60)), 1.5 * f("", at(60), at(60, 180)));
}

TEST(Ward, FilesOfMitsuba06MayGiveOneRoughness) {
    const auto f = [](const std::string& version, const std::string& roughness) {
        const std::string ward = bsdf("ward", roughness), xml = shape("rectangle", ward);
        return parse_scene("<scene version='" + version + "'>" + sensor_xml + xml + "</scene>", "t.xml")
            .scene->material_of_shape(0)
            .constant()
            ->f_local(at(10), at(30))
            .sum()[0];
    };
    const auto both = [](double u, double v) { return number("alpha_u", u) + number("alpha_v", v); };
    EXPECT_EQ(f("0.5.0", number("alpha", 0.4)), f("3.0.0", both(0.4, 0.4)));
    EXPECT_EQ(f("0.5.0", number("alpha", 0.4) + number("alphaV", 0.2)), f("3.0.0", both(0.4, 0.2)));
}

// At normal incidence in the mirror direction all three are rho_s / (4 pi alpha_u alpha_v).
TEST(Ward, VariantsAgreeStraightDown) {
    for (const std::string variant : {"balanced", "ward", "ward-duer"}) {
        const Bsdf b = bsdf_of(bsdf("ward", text("variant", variant), rgb("diffuse_reflectance", 0),
                                    rgb("specular_reflectance", 0.5), number("alpha_u", 0.2), number("alpha_v", 0.3)));
        EXPECT_NEAR(b.f_local(at(0), at(0)).sum()[0], 0.5f * inv_pi / (4 * 0.2f * 0.3f), 1e-5f) << variant;
    }
    const auto f = [](const std::string& variant) {
        return bsdf_of(bsdf("ward", text("variant", variant), rgb("diffuse_reflectance", 0), number("alpha_u", 0.2),
                            number("alpha_v", 0.2)))
            .f_local(at(60), at(60, 180))
            .sum()[0];
    };
    // In the mirror direction at 60 degrees: 1 / cos^2 for ward-duer and balanced, 1 / cos for ward.
    EXPECT_NEAR(f("ward-duer") / f("ward"), 2, 1e-4);
    EXPECT_NEAR(f("balanced") / f("ward"), 2, 1e-4);
}

}  // namespace
}  // namespace gib::test::coat_test
