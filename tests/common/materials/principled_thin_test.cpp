// Tests of the thin principled model against closed forms of its lobes and against the models that it contains.

#include "common/materials/principled_thin.h"

#include "common/materials/fresnel.h"
#include "common/materials/principled.h"
#include "common/materials/rough_scattering.h"
#include "tests/common/materials/scattering_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::principled_thin_test {
namespace {

const Color amber(0.8f, 0.5f, 0.1f);

Color f_of(const PrincipledThin& m, const Vec3& wo, const Vec3& wi) {
    return m.f_local(wo, wi, Transport::radiance).sum();
}

Vec3 through(const Vec3& w) { return {w.x(), w.y(), -w.z()}; }

void expect_color(const Color& found, const Color& expected, float tolerance, const std::string& name) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], expected[c], tolerance * std::max(expected.maxCoeff(), 1e-3f)) << name << ' ' << c;
}

std::vector<PrincipledThin> models() {
    return {
        {.base_color = amber},
        {.base_color = amber, .diff_trans = 2.f},
        {.base_color = Color::Zero(), .diff_trans = 0.7f, .sheen = 1.f, .sheen_tint = 1.f},
        {.base_color = amber, .roughness = 0.2f, .spec_trans = 1.f, .spec_tint = 1.f, .eta = 1.33f},
        {.base_color = amber, .roughness = 0.f, .spec_trans = 0.4f, .diff_trans = 1.f, .eta = 1.f},
        {.base_color = Color(1.f, 0.f, 0.f), .roughness = 1.f, .anisotropic = 1.f, .spec_trans = 1.f},
        {.base_color = amber,
         .roughness = 0.8f,
         .anisotropic = 1.f,
         .spec_trans = 0.6f,
         .diff_trans = 0.5f,
         .spec_tint = 0.3f,
         .sheen = 0.4f,
         .flatness = 0.5f,
         .eta = 0.7f},
    };
}

// Without a specular share the sheet is Principled's diffuse light, of which the share t = diff_trans / 2 is Lambertian
// light on the other side instead.
TEST(PrincipledThin, DiffuseLightIsReflectedOrTransmitted) {
    const Principled opaque{
        .base_color = amber, .roughness = 0.7f, .sheen = 0.6f, .sheen_tint = 0.3f, .flatness = 0.4f, .eta = 1.f};
    PrincipledThin m{
        .base_color = amber, .roughness = 0.7f, .sheen = 0.6f, .sheen_tint = 0.3f, .flatness = 0.4f, .eta = 1.4f};
    for (float diff_trans : {0.f, 0.8f, 2.f}) {
        m.diff_trans = diff_trans;
        for (double a : {5.0, 50.0, 85.0}) {
            const Vec3 wo = direction_at(a, 0.3), wi = direction_at(60, 2.2);
            expect_color(f_of(m, wo, wi), (1.f - 0.5f * diff_trans) * opaque.f_local(wo, wi, Transport::radiance).sum(),
                         1e-5f, "front");
            expect_color(f_of(m, wo, through(wi)), 0.5f * diff_trans * amber * inv_pi, 1e-5f, "through");
        }
    }
    const PrincipledThin paper{.base_color = Color::Ones(), .diff_trans = 2.f};
    EXPECT_NEAR(sampled_share(paper, direction_at(70, 1)).weight, 1, 1e-4);
}

// The specular share is a rough dielectric's reflection, and a rough mirror of another roughness seen in the sheet,
// times the base colour and 1 - F.
TEST(PrincipledThin, SpecularLightIsReflectedOrGoesOnUnbent) {
    const PrincipledThin m{.base_color = amber,
                           .roughness = 0.6f,
                           .anisotropic = 0.5f,
                           .spec_trans = 0.75f,
                           .diff_trans = 0.f,
                           .eta = 1.4f};
    const PrincipledThin matte{.base_color = amber, .roughness = 0.6f};
    const float aspect = std::sqrt(0.55f), alpha = sqr(0.6f), bent = sqr((0.65f * 1.4f - 0.35f) * 0.6f);
    const RoughDielectric interface {
        1.4f, 0.f, { MicrofacetType::ggx, alpha / aspect, alpha* aspect }
    };
    const RoughConductor mirror{{}, {MicrofacetType::ggx, bent / aspect, bent * aspect}};
    for (double a : {5.0, 50.0, 80.0})
        for (double b : {10.0, 48.0, 75.0}) {
            const Vec3 wo = direction_at(a, 0.3), wi = direction_at(b, 3.3);
            expect_color(f_of(m, wo, wi),
                         0.25f * f_of(matte, wo, wi) + 0.75f * interface.f_local(wo, wi, Transport::radiance).sum(),
                         1e-4f, "front");
            const float cos_d = wo.dot((wo + wi).normalized());
            expect_color(f_of(m, wo, through(wi)),
                         0.75f * (1.f - fresnel_dielectric(cos_d, 1.4f).reflectance) * amber *
                             mirror.f_local(wo, wi, Transport::radiance).sum(),
                         1e-4f, "through");
        }
    EXPECT_FALSE(m.traits().refraction);
}

TEST(PrincipledThin, TintColoursTheReflectionAtNormalIncidence) {
    PrincipledThin m{.base_color = amber, .roughness = 0.6f, .spec_trans = 1.f, .eta = 1.5f};
    const Vec3 n = Vec3::UnitZ();
    const float per_reflectance = 1.f / (4.f * pi * sqr(0.36f));
    expect_color(f_of(m, n, n), Color::Constant(0.04f * per_reflectance), 1e-4f, "plain");
    m.spec_tint = 0.5f;
    expect_color(f_of(m, n, n), 0.04f * per_reflectance * 0.5f * (1.f + amber / luminance(amber)), 1e-4f, "tinted");
}

TEST(PrincipledThin, IsAlikeOnBothSidesAndReciprocal) {
    for (const PrincipledThin& m : models())
        for (double a : {10.0, 70.0})
            for (double b : {30.0, 80.0, 100.0, 160.0}) {
                const Vec3 wo = direction_at(a, 0.3), wi = direction_at(b, 2.9);
                expect_color(f_of(m, through(wo), through(wi)), f_of(m, wo, wi), 1e-5f, "behind");
                expect_color(f_of(m, wi, wo), f_of(m, wo, wi), 1e-4f, "exchanged");
            }
}

TEST(PrincipledThin, NothingIsEverNaN) {
    for (std::size_t i = 0; i < models().size(); ++i)
        expect_finite(models()[i], "thin " + std::to_string(i));
}

TEST(PrincipledThin, SamplesCarryTheirOwnValueAndDensity) {
    for (const PrincipledThin& m : models())
        for (double degrees : {0.0, 45.0, 80.0, 100.0, 170.0})
            expect_samples_agree(m, direction_at(degrees, 0.3), 1e-5f, "thin", 12.f);
}

// The reflecting lobe has alpha 0.12, the transmitting one alpha 0.12 (0.65 1.5 - 0.35)^2 = 0.047, which counts as
// specular.
TEST(PrincipledThin, LobesCountByTheirOwnRoughness) {
    const PrincipledThin m{.base_color = amber, .roughness = std::sqrt(0.12f), .spec_trans = 1.f};
    const Vec3 n = Vec3::UnitZ();
    const LobeValues front = m.f_local(n, n, Transport::radiance), behind = m.f_local(n, -n, Transport::radiance);
    EXPECT_TRUE(is_black(front.specular) && front.diffuse[0] > 0.f);
    EXPECT_TRUE(is_black(behind.diffuse) && behind.specular[0] > 0.f);
    EXPECT_TRUE(m.traits().diffuse && m.traits().glossy && m.traits().transmission && !m.traits().anisotropic);
    EXPECT_FALSE((PrincipledThin{.base_color = Color::Zero()}.traits().scatters()));
}

}  // namespace
}  // namespace gib::test::principled_thin_test
