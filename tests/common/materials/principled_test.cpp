// Tests of the principled models against closed forms of their lobes and against the models that they contain.

#include "common/materials/principled.h"
#include "common/materials/fresnel.h"
#include "common/materials/gtr1.h"
#include "common/materials/principled_thin.h"
#include "common/materials/rough_scattering.h"
#include "tests/common/materials/scattering_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::principled_test {
namespace {

const Color amber(0.8f, 0.5f, 0.1f);

double schlick_weight(double cosine) { return std::pow(1 - cosine, 5); }

TEST(Principled, SpecularIsTheReflectanceAtNormalIncidence) {
    for (double specular : {0.0, 0.1, 0.5, 1.0}) {
        const double eta = Principled::eta_of_specular(specular);
        EXPECT_NEAR(sqr((eta - 1) / (eta + 1)), 0.08 * specular, 1e-12) << specular;
    }
}

// At normal incidence and reflection Schlick's weights are 0: f = c / pi + F0 / (4 pi alpha^2). Flat light is 5 / 8 of
// the diffuse one there.
TEST(Principled, AlongTheNormalIsDiffuseAndReflectedLight) {
    Principled m{.base_color = amber, .roughness = 0.6f};
    const Vec3 n = Vec3::UnitZ();
    const float alpha = 0.36f, reflected = 0.04f / (4.f * pi * sqr(alpha));
    expect_color(f_of(m, n, n), amber * inv_pi + reflected, 1e-5f, "plain");
    m.flatness = 1.f;
    expect_color(f_of(m, n, n), 0.625f * amber * inv_pi + reflected, 1e-5f, "flat");
    m.metallic = 1.f;
    expect_color(f_of(m, n, n), amber / (4.f * pi * sqr(alpha)), 1e-5f, "metal");
}

// Towards where the light comes from d is 0: with Schlick's weight w and R = 2 roughness, Burley's diffuse light is
// (1 - w / 2)^2 + R (2 w + w^2 (R - 1)).
TEST(Principled, RetroReflectionFollowsBurley) {
    for (double degrees : {20.0, 60.0, 85.0})
        for (float roughness : {0.2f, 0.9f}) {
            Principled m{.base_color = amber, .roughness = roughness, .eta = 1.f};
            const Vec3 w = direction_at(degrees, 0.4);
            const double weight = schlick_weight(double{w.z()}), r = 2 * double{roughness};
            const double share = sqr(1 - weight / 2) + r * (2 * weight + sqr(weight) * (r - 1));
            expect_color(f_of(m, w, w), amber * static_cast<float>(share / std::numbers::pi), 1e-4f, "retro");
            m.flatness = 1.f;
            const double s = sqr(1 + weight * (r / 2 - 1));
            const double flat = 1.25 * (s * (0.5 / double{w.z()} - 0.5) + 0.5);
            expect_color(f_of(m, w, w), amber * static_cast<float>(flat / std::numbers::pi), 1e-4f, "flat");
        }
}

// A metal is a rough conductor whose reflectance is Schlick's, c + (1 - c) w(d).
TEST(Principled, MetalIsARoughConductorWithSchlicksReflectance) {
    const Principled m{.base_color = amber, .roughness = 0.7f, .anisotropic = 0.8f, .metallic = 1.f};
    const float aspect = std::sqrt(1.f - 0.9f * 0.8f);
    const RoughConductor mirror{{}, {MicrofacetType::ggx, 0.49f / aspect, 0.49f * aspect}};
    for (double a : {0.0, 40.0, 80.0})
        for (double b : {10.0, 60.0, 88.0}) {
            const Vec3 wo = direction_at(a, 0.3), wi = direction_at(b, 1.9);
            const double weight = schlick_weight(double{wo.dot((wo + wi).normalized())});
            const Color reflectance = amber + static_cast<float>(weight) * (1.f - amber);
            expect_color(f_of(m, wo, wi), reflectance * f_of(mirror, wo, wi), 1e-4f, "metal");
        }
    const Principled dark{.base_color = amber, .roughness = 0.7f, .anisotropic = 0.8f, .metallic = 1.f, .eta = 1.f};
    const Vec3 w = direction_at(30, 0.1);
    expect_color(f_of(dark, w, w), f_of(m, w, w), 1e-6f, "without a change of index");
}

TEST(Principled, WhiteGlassIsARoughDielectric) {
    const Principled m{.base_color = Color::Ones(), .roughness = 0.6f, .spec_trans = 1.f, .eta = 1.4f};
    const RoughDielectric glass{1.4f, 0.f, {MicrofacetType::ggx, 0.36f, 0.36f}};
    int bright = 0;
    for (double a : {5.0, 50.0, 85.0, 120.0, 170.0})
        for (double b : {10.0, 70.0, 95.0, 140.0, 175.0})
            for (Transport transport : {Transport::radiance, Transport::power}) {
                const Vec3 wo = direction_at(a, 0.3), wi = direction_at(b, 3.3);
                const Color expected = f_of(glass, wo, wi, transport);
                expect_color(f_of(m, wo, wi, transport), expected, 1e-4f, std::to_string(a) + ' ' + std::to_string(b));
                if (expected[0] > 1e-3f) ++bright;
            }
    EXPECT_GT(bright, 20);
    Principled tinted = m;
    tinted.base_color = amber;
    tinted.metallic = 0.25f;
    const Vec3 wo = direction_at(20, 0.3), wi = direction_at(165, 3.3);
    expect_color(f_of(tinted, wo, wi), 0.75f * amber.sqrt() * f_of(m, wo, wi), 1e-4f, "transmitted");
    const Vec3 inside = direction_at(150, 0.3);
    expect_color(f_of(tinted, wi, inside), 0.75f * f_of(m, wi, inside), 1e-4f, "reflected inside");
}

TEST(Principled, SheenAndTintsFollowSchlicksWeight) {
    const Vec3 wo = direction_at(70, 0.3), wi = direction_at(75, 3.0);
    const double weight = schlick_weight(double{wo.dot((wo + wi).normalized())});
    const Color tint = amber / luminance(amber);
    const Principled plain{.base_color = amber, .metallic = 0.5f};
    Principled m = plain;
    m.sheen = 0.8f;
    m.sheen_tint = 0.25f;
    const Color added = f_of(m, wo, wi) - f_of(plain, wo, wi);
    expect_color(added, 0.5f * 0.8f * static_cast<float>(weight) * (0.75f + 0.25f * tint), 1e-4f, "sheen");

    const Principled shiny{.base_color = amber, .roughness = 0.6f, .eta = 1.5f};
    Principled tinted = shiny;
    tinted.spec_tint = 1.f;
    const Vec3 n = Vec3::UnitZ();
    expect_color(f_of(tinted, n, n) - f_of(shiny, n, n), 0.04f * (tint - 1.f) / (4.f * pi * sqr(0.36f)), 1e-3f, "tint");
}

// The lobe that Mitsuba 3 adds: clearcoat / 4 F D G1 G1, with F0 = 0.04 and G1 of roughness 1 / 4.
TEST(Principled, ClearCoatIsAddedWithItsOwnDistribution) {
    for (float gloss : {0.f, 0.5f, 1.f}) {
        const Principled plain{.base_color = amber};
        Principled m = plain;
        m.clearcoat = 0.6f;
        m.clearcoat_gloss = gloss;
        const Vec3 wo = direction_at(40, 0.3), wi = direction_at(44, 3.4);
        const Vec3d h = (wo.cast<double>() + wi.cast<double>()).normalized();
        const double alpha2 = sqr(0.1 + double{gloss} * (0.001 - 0.1));
        const double density = (alpha2 - 1) / (std::numbers::pi * std::log(alpha2) * (1 + (alpha2 - 1) * sqr(h.z())));
        const auto g1 = [](double c) { return 2 / (1 + std::sqrt(1 + 0.0625 * (1 - c * c) / (c * c))); };
        const double fresnel = 0.04 + 0.96 * schlick_weight(wo.cast<double>().dot(h));
        const double expected = 0.15 * fresnel * density * g1(double{wo.z()}) * g1(double{wi.z()});
        const LobeValues found = m.f_local(wo, wi, Transport::radiance);
        EXPECT_NEAR(found.specular[0], expected, 1e-3 * expected) << gloss;
        expect_color(found.diffuse, f_of(plain, wo, wi), 1e-6f, "the rest");
    }
}

// All lobes together. The values come from a script that reproduces those of Mitsuba 3's own test of this material
// (test_principled.py, test05) to all their digits; here both directions are unit vectors.
TEST(Principled, SumOfAllLobesIsThatOfMitsuba) {
    const Principled m{.base_color = Color::Constant(0.5f),
                       .roughness = 0.5f,
                       .anisotropic = 0.3f,
                       .metallic = 0.3f,
                       .spec_trans = 0.5f,
                       .spec_tint = 0.6f,
                       .sheen = 0.9f,
                       .sheen_tint = 0.9f,
                       .flatness = 0.5f,
                       .clearcoat = 0.3f,
                       .clearcoat_gloss = 0.5f,
                       .eta = static_cast<float>(Principled::eta_of_specular(0.4))};
    const Vec3 wo = direction_at(45, 0);
    for (const auto& [degrees, expected] : {std::pair(0.0, 0.0956009f), std::pair(30.0, 0.0646102f),
                                            std::pair(60.0, 0.066804f), std::pair(80.0, 0.0807701f)})
        EXPECT_NEAR(f_of(m, wo, direction_at(degrees, 0))[0], expected, 1e-5f) << degrees;
}

// Only light that comes through the surface is scattered on its back.
TEST(Principled, IsOneSidedUnlessItTransmits) {
    const Principled opaque{.base_color = amber, .clearcoat = 1.f};
    const Vec3 below = direction_at(130, 0.2);
    EXPECT_FALSE(opaque.sample_local(below, 0.5f, {0.3f, 0.3f}, Transport::radiance, Lobes::all));
    EXPECT_TRUE(is_black(f_of(opaque, below, direction_at(150, 0.3))));
    EXPECT_TRUE(is_black(f_of(opaque, direction_at(20, 0.2), below)));
    EXPECT_FALSE(opaque.traits().transmission);
    const Principled glass{.base_color = amber, .spec_trans = 0.5f};
    EXPECT_TRUE(glass.traits().transmission && glass.traits().refraction);
    EXPECT_FALSE(is_black(f_of(glass, below, direction_at(30, 3.3))));
}

TEST(Principled, LobesCountByTheirRoughness) {
    const Principled sharp{.base_color = amber, .roughness = 0.3f};  // alpha 0.09
    EXPECT_TRUE(sharp.traits().diffuse && sharp.traits().glossy && sharp.traits().rough);
    const Principled dull{.base_color = amber, .roughness = 0.33f};
    EXPECT_TRUE(dull.traits().diffuse && !dull.traits().glossy);
    EXPECT_TRUE((Principled{.base_color = amber, .roughness = 0.33f, .clearcoat = 0.1f}.traits().glossy));
    EXPECT_TRUE((Principled{.base_color = amber, .anisotropic = 0.1f}.traits().anisotropic));
    EXPECT_FALSE((Principled{.base_color = amber, .roughness = 0.1f, .metallic = 1.f}.traits().diffuse));
    EXPECT_FALSE((Principled{.base_color = Color::Zero(), .eta = 1.f}.traits().scatters()));
}

// Without a specular share the sheet reflects 1 - t of Principled's diffuse light, t = diff_trans / 2. It transmits the
// share t as Lambertian light.
TEST(PrincipledThin, DiffuseLightIsReflectedOrTransmitted) {
    const Principled opaque{
        .base_color = amber, .roughness = 0.7f, .sheen = 0.6f, .sheen_tint = 0.3f, .flatness = 0.4f, .eta = 1.f};
    PrincipledThin m{
        .base_color = amber, .roughness = 0.7f, .sheen = 0.6f, .sheen_tint = 0.3f, .flatness = 0.4f, .eta = 1.4f};
    for (float diff_trans : {0.f, 0.8f, 2.f}) {
        m.diff_trans = diff_trans;
        for (double a : {5.0, 50.0, 85.0}) {
            const Vec3 wo = direction_at(a, 0.3), wi = direction_at(60, 2.2);
            expect_color(f_of(m, wo, wi), (1.f - 0.5f * diff_trans) * f_of(opaque, wo, wi), 1e-5f, "front");
            expect_color(f_of(m, wo, behind(wi)), 0.5f * diff_trans * amber * inv_pi, 1e-5f, "through");
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
            expect_color(f_of(m, wo, wi), 0.25f * f_of(matte, wo, wi) + 0.75f * f_of(interface, wo, wi), 1e-4f,
                         "front");
            const float cos_d = wo.dot((wo + wi).normalized());
            expect_color(f_of(m, wo, behind(wi)),
                         0.75f * (1.f - fresnel_dielectric(cos_d, 1.4f).reflectance) * amber * f_of(mirror, wo, wi),
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

// The reflecting lobe has alpha 0.12, the transmitting one alpha 0.12 (0.65 1.5 - 0.35)^2 = 0.047, which counts as
// specular.
TEST(PrincipledThin, LobesCountByTheirOwnRoughness) {
    const PrincipledThin m{.base_color = amber, .roughness = std::sqrt(0.12f), .spec_trans = 1.f};
    const Vec3 n = Vec3::UnitZ();
    const LobeValues front = m.f_local(n, n, Transport::radiance), back = m.f_local(n, -n, Transport::radiance);
    EXPECT_TRUE(is_black(front.specular) && front.diffuse[0] > 0.f);
    EXPECT_TRUE(is_black(back.diffuse) && back.specular[0] > 0.f);
    EXPECT_TRUE(m.traits().diffuse && m.traits().glossy && m.traits().transmission && !m.traits().anisotropic);
    EXPECT_FALSE((PrincipledThin{.base_color = Color::Zero()}.traits().scatters()));
}

}  // namespace
}  // namespace gib::test::principled_test
