// Tests of mixtures of scattering models, and of materials that become one at a point: blends,
// masks, sides, bump and normal maps.
#include "common/materials/material.h"
#include "common/sampling/sampler.h"
#include "tests/support/moments.h"

#include <gtest/gtest.h>

namespace gib::test::material_test {
namespace {

Vec3 direction(float degrees, float phi) {
    const float theta = degrees * pi / 180.f;
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

Scattering diffuse(float r) { return Diffuse{Color::Constant(r)}; }
NestedMaterial nested(Material::Node node) { return std::make_shared<const Material>(std::move(node)); }
NestedMaterial nested(Scattering model) { return std::make_shared<const Material>(std::move(model)); }
Texture constant(float x) { return Texture(Color::Constant(x)); }

/// A point in the plane z = 0 with u along x and v along y.
MaterialPoint flat_point(const Vec2& uv = Vec2::Zero()) {
    return {uv, Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(), frame_along(Vec3::UnitZ(), Vec3::UnitX())};
}

/// A normal map of one colour: the normal (x, y, z) / length everywhere.
Material tilted(const Vec3& n, NestedMaterial inside, PerturbationOptions options = {false, false}) {
    return Material(NormalMap{Texture(Color(0.5f * (n.array() + 1.f))), std::move(inside), options});
}

/// The mean weight of the samples from wo, and its standard error.
struct Albedo {
    double mean, error;
};
Albedo sampled_albedo(const Bsdf& bsdf, const Vec3& wo, Transport transport = Transport::power) {
    constexpr std::uint32_t n = 1 << 16;
    Moments weights;
    for (std::uint32_t i = 0; i < n; ++i) {
        const Sampler u(PointSet::independent, 3, 5, i);
        const auto s = bsdf.sample_local(wo, u.get_2d(0), u.get_2d(1), transport);
        weights.add(s ? double{s->f[0] * std::abs(s->wi.z()) / s->pdf_w} : 0.0);
    }
    return {weights.mean(), weights.standard_error()};
}

TEST(Material, ABlendIsTheWeightedSumOfItsParts) {
    const Material blend(Blend{constant(0.25f), nested(diffuse(0.8f)), nested(diffuse(0.2f))});
    ASSERT_TRUE(blend.constant());
    const Vec3 wo = direction(30, 0), wi = direction(50, 2);
    EXPECT_NEAR(blend.constant()->f_local(wo, wi).diffuse[0], (0.75f * 0.8f + 0.25f * 0.2f) * inv_pi, 1e-7f);
    EXPECT_NEAR(blend.constant()->coefficients_local(wo).diffuse[0], 0.75f * 0.8f + 0.25f * 0.2f, 1e-6f);
    EXPECT_NEAR(sampled_albedo(*blend.constant(), wo).mean, 0.65, 1e-6);  // both parts are cosine-weighted
}

// The conductor stays a delta lobe and the diffuse part a diffuse one; the blend loses no light.
TEST(Material, ABlendOfDeltaAndDiffuseLobesKeepsBoth) {
    const Material blend(Blend{constant(0.5f), nested(Scattering(Conductor{})), nested(diffuse(0.6f))});
    const Bsdf& bsdf = *blend.constant();
    const Vec3 wo = direction(40, 1);
    const Albedo all = sampled_albedo(bsdf, wo);
    EXPECT_NEAR(all.mean, 0.5 + 0.5 * 0.6, 4 * all.error + 1e-6);
    int delta = 0;
    for (std::uint32_t i = 0; i < 4096; ++i) {
        const Sampler u(PointSet::sobol, 1, 0, i);
        delta += bsdf.sample_local(wo, u.get_2d(0), u.get_2d(1), Transport::radiance)->delta;
    }
    EXPECT_NEAR(delta / 4096.0, 0.5 / 0.8, 2e-3);  // chosen in proportion to the light that they scatter
    const auto mirror = bsdf.sample_local(wo, {0.1f, 0.f}, {0.5f, 0.5f}, Transport::radiance, Lobes::specular);
    ASSERT_TRUE(mirror && mirror->delta);
    EXPECT_NEAR(mirror->f[0] * std::abs(mirror->wi.z()) / mirror->pdf_w, 0.5f, 1e-6f);
    const auto base = bsdf.sample_local(wo, {0.1f, 0.f}, {0.5f, 0.5f}, Transport::radiance, Lobes::diffuse);
    ASSERT_TRUE(base && !base->delta);
    EXPECT_NEAR(base->f[0] * base->wi.z() / base->pdf_w, 0.3f, 1e-6f);
}

TEST(Material, AMaskIsASurfaceThatIsThereWithItsOpacity) {
    const Material mask(Mask{constant(0.3f), nested(diffuse(0.5f))});
    EXPECT_TRUE(mask.has_holes());
    EXPECT_NEAR(mask.constant()->pass_through(), 0.7f, 1e-6f);
    EXPECT_NEAR(mask.constant()->f_local(direction(20, 0), direction(30, 0)).diffuse[0], 0.5f * inv_pi, 1e-6f);
    // A mask in a mask has the product of both opacities.
    const Material twice(Mask{constant(0.5f), nested(mask.node())});
    EXPECT_NEAR(twice.constant()->pass_through(), 1.f - 0.15f, 1e-6f);
    const Material null{Material::Node(Nothing{})};
    EXPECT_EQ(null.constant()->pass_through(), 1.f);
    EXPECT_FALSE(null.constant()->reflects());
    EXPECT_FALSE(Material(Mask{constant(1.f), nested(diffuse(0.5f))}).has_holes());
}

TEST(Material, TwoSidesAreSeenFromTheirOwnSide) {
    const Material sides(TwoSided{nested(diffuse(0.2f)), nested(Scattering(Conductor{}))});
    const Bsdf& bsdf = *sides.constant();
    EXPECT_TRUE(bsdf.traits_at(0.5f).diffuse);
    EXPECT_FALSE(bsdf.traits_at(0.5f).delta);
    EXPECT_TRUE(bsdf.traits_at(-0.5f).delta);
    const Vec3 below = direction(150, 0.4f);
    const auto s = bsdf.sample_local(below, {0.5f, 0.5f}, {0.5f, 0.5f}, Transport::radiance);
    ASSERT_TRUE(s);
    EXPECT_NEAR((s->wi - Vec3(-below.x(), -below.y(), below.z())).norm(), 0.f, 1e-6f);
    // A blend as one side, seen from both sides.
    const Material blended(
        TwoSided{nested(Blend{constant(0.5f), nested(diffuse(0.2f)), nested(diffuse(0.6f))}), nested(diffuse(0.9f))});
    EXPECT_NEAR(blended.constant()->coefficients_local(direction(10, 0)).diffuse[0], 0.4f, 1e-6f);
    EXPECT_NEAR(blended.constant()->coefficients_local(direction(170, 0)).diffuse[0], 0.9f, 1e-6f);
}

TEST(Material, ANormalMapTurnsAMirror) {
    const Vec3 n = Vec3(0.2f, -0.1f, 1.f).normalized();
    const Bsdf bsdf = tilted(n, nested(Scattering(Conductor{}))).at(flat_point());
    const Vec3 wo = direction(25, 0.3f);
    const auto s = bsdf.sample_local(wo, {0.5f, 0.5f}, {0.5f, 0.5f}, Transport::radiance);
    ASSERT_TRUE(s);
    EXPECT_NEAR((s->wi - (2.f * n.dot(wo) * n - wo)).norm(), 0.f, 1e-6f);
    EXPECT_NEAR(s->f[0] * std::abs(s->wi.z()) / s->pdf_w, 1.f, 1e-5f);
}

// The tilted surface reflects f |wi.z| = rho / pi max(n . wi, 0). f_local lacks the factor wi.z, by which its caller
// multiplies.
TEST(Material, ATiltedDiffuseSurfaceFollowsItsOwnCosine) {
    const Vec3 n = Vec3(0.5f, 0.f, 1.f).normalized();
    const Bsdf bsdf = tilted(n, nested(diffuse(0.5f))).at(flat_point());
    const Vec3 wo = direction(10, 0);
    for (float degrees : {0.f, 40.f, 70.f}) {
        const Vec3 wi = direction(degrees, 0.7f);
        EXPECT_NEAR(bsdf.f_local(wo, wi).diffuse[0] * wi.z(), 0.5f * inv_pi * n.dot(wi), 1e-6f);
    }
    const Vec3 behind = direction(80, pi);  // above the surface, below the tilted one
    EXPECT_EQ(bsdf.f_local(wo, behind).diffuse[0], 0.f);
    const Vec3 beneath = direction(95, 0);  // below the surface, above the tilted one
    EXPECT_EQ(bsdf.f_local(wo, beneath).diffuse[0], 0.f);
    EXPECT_LE(sampled_albedo(bsdf, wo, Transport::radiance).mean, 0.5 + 1e-6);
}

TEST(Material, AFlatNormalMapChangesNothing) {
    const Bsdf bsdf = tilted(Vec3::UnitZ(), nested(diffuse(0.5f))).at(flat_point());
    const Vec3 wo = direction(35, 0.2f), wi = direction(65, 2.f);
    EXPECT_NEAR(bsdf.f_local(wo, wi).diffuse[0], 0.5f * inv_pi, 1e-6f);
    EXPECT_NEAR(bsdf.pdf_w_local(wo, wi), wi.z() * inv_pi, 1e-6f);
}

// The shadowing of the light at an angle theta is 2 / (1 + sqrt(1 + alpha^2 tan^2 theta)), where alpha^2 =
// tan^2(theta_n) / 8, but at most 1 (Estevez, Lecocq and Stein 2019).
TEST(Material, ShadowingOfATiltedNormalIsThatOfTheLight) {
    const Vec3 eye = direction(10, 0), light = direction(60, 0.7f);
    const struct {
        Vec3 normal;
        double alpha2;
    } rows[] = {{{0.5f, 0.f, 1.f}, 0.25 / 8}, {{0.f, 2.f, 1.f}, 4.0 / 8}, {{3.f, 0.f, 1.f}, 1}};
    for (const auto& row : rows) {
        const Vec3 n = row.normal.normalized();
        const Bsdf plain = tilted(n, nested(diffuse(0.5f))).at(flat_point());
        const Bsdf shadowed = tilted(n, nested(diffuse(0.5f)), {false, true}).at(flat_point());
        const double expected = 2 / (1 + std::sqrt(1 + row.alpha2 * 3));
        const auto ratio = [&](const Vec3& wo, const Vec3& wi, Transport transport) {
            return static_cast<double>(shadowed.f_local(wo, wi, transport).diffuse[0] /
                                       plain.f_local(wo, wi, transport).diffuse[0]);
        };
        EXPECT_NEAR(ratio(eye, light, Transport::radiance), expected, 1e-5);
        EXPECT_NEAR(ratio(light, eye, Transport::power), expected, 1e-5) << "followed the other way";
        EXPECT_EQ(shadowed.pdf_w_local(eye, light), plain.pdf_w_local(eye, light));
        const Bsdf mirror = tilted(n, nested(Scattering(Conductor{})), {false, true}).at(flat_point());
        const Vec3 bisector = (n + Vec3::UnitZ()).normalized(), glancing = (n + bisector).normalized();
        const auto s = mirror.sample_local(glancing, {0.5f, 0.5f}, {0.5f, 0.5f}, Transport::radiance);
        const Vec3 reflected = 2.f * n.dot(glancing) * n - glancing;
        ASSERT_TRUE(s) << n.transpose();
        const double tan2 = 1 / sqr(double{reflected.z()}) - 1;
        EXPECT_NEAR(s->f[0] * std::abs(s->wi.z()) / s->pdf_w, 2 / (1 + std::sqrt(1 + row.alpha2 * tan2)), 1e-4);
    }
}

TEST(Material, ANormalThatTheEyeSeesFromBehindIsTurned) {
    const Vec3 n = Vec3(1.f, 0.f, 1.f).normalized(), turned(-n.x(), -n.y(), n.z());
    const Bsdf bsdf = tilted(n, nested(diffuse(0.5f)), {true, false}).at(flat_point());
    const Vec3 light = direction(20, 2.f), front = direction(30, 1.f), behind = direction(60, pi);
    EXPECT_NEAR(bsdf.f_local(front, light).diffuse[0] * light.z(), 0.5f * inv_pi * n.dot(light), 1e-6f);
    EXPECT_NEAR(bsdf.f_local(behind, light).diffuse[0] * light.z(), 0.5f * inv_pi * turned.dot(light), 1e-6f);
    EXPECT_NEAR(bsdf.pdf_w_local(behind, light), turned.dot(light) * inv_pi, 1e-6f);
    EXPECT_NEAR(bsdf.coefficients_local(behind).diffuse[0], 0.5f, 1e-6f) << "one of both normals";
    // A photon scatters towards either eye as that eye sees it. The caller of f_local divides by the
    // cosine of the photon's direction.
    for (const Vec3& eye : {front, behind})
        EXPECT_NEAR(bsdf.f_local(light, eye, Transport::power).diffuse[0], bsdf.f_local(eye, light).diffuse[0], 1e-6f);
    const Vec3 below = direction(120, 0);  // the eye is inside and sees n from behind
    const Bsdf glass = tilted(n, nested(Scattering(Dielectric{})), {true, false}).at(flat_point());
    EXPECT_TRUE(glass.sample_local(below, {0.01f, 0.5f}, {0.5f, 0.5f}, Transport::radiance));
    // The holes of the material under the normal map are counted once.
    const Material holes = tilted(n, nested(Mask{constant(0.4f), nested(diffuse(0.5f))}), {true, true});
    EXPECT_NEAR(holes.at(flat_point()).pass_through(), 0.6f, 1e-6f);
    EXPECT_NEAR(holes.at(flat_point()).coefficients_local(front).diffuse[0], 0.5f, 1e-6f);
}

TEST(Material, ATextureVariesAParameterOverTheSurface) {
    TexturedScattering node{diffuse(1.f), {}};
    node.parameters.push_back({Texture(CheckerboardTexture{constant(0.25f), constant(0.75f), {}}),
                               [](Scattering& s, const Color& c) { std::get<Diffuse>(s).reflectance = c; }});
    const Material material(node);
    EXPECT_FALSE(material.constant());
    EXPECT_TRUE(material.is_textured());
    const Vec3 up = Vec3::UnitZ();
    EXPECT_EQ(material.at(flat_point({0.25f, 0.25f})).coefficients_local(up).diffuse[0], 0.25f);
    EXPECT_EQ(material.at(flat_point({0.75f, 0.25f})).coefficients_local(up).diffuse[0], 0.75f);
}

// A conductor whose roughness and colour vary in squares: it is cyan (no red) in some places and red (no green or
// blue) in others, and black nowhere. The lowest value of each channel is 0, so a bound from these alone would take
// the material for black and hide its sharp lobe.
TEST(Material, TraitsAreThoseOfAllCombinationsOfItsTextures) {
    const auto board = [](const Color& a, const Color& b) {
        return Texture(CheckerboardTexture{Texture(a), Texture(b), {}});
    };
    RoughConductor conductor;
    conductor.distribution.alpha_u = conductor.distribution.alpha_v = 0.2f;
    TexturedScattering node{conductor, {}};
    node.parameters.push_back({board(Color(1, 0, 0), Color(0, 1, 1)), [](Scattering& s, const Color& c) {
                                   std::get<RoughConductor>(s).specular_reflectance = c;
                               }});
    TexturedParameter alpha{board(Color::Constant(0.05f), Color::Constant(0.6f)), {}};
    alpha.set_value = [](Scattering& s, float value) {
        auto& distribution = std::get<RoughConductor>(s).distribution;
        distribution.alpha_u = distribution.alpha_v = value;
    };
    node.parameters.push_back(alpha);
    LobeTraits everywhere;
    const Material material(node);
    for (const Vec2& uv : {Vec2(0.25f, 0.25f), Vec2(0.75f, 0.25f)})
        everywhere |= material.at(flat_point(uv)).traits();
    EXPECT_EQ(material.traits().glossy, everywhere.glossy);
    EXPECT_EQ(material.traits().diffuse, everywhere.diffuse);
    EXPECT_TRUE(everywhere.glossy);
}

TEST(Material, TooManyModelsAreRefused) {
    NestedMaterial all = nested(diffuse(0.5f));
    for (std::size_t i = 1; i < Bsdf::max_layers; ++i)
        all = nested(Blend{constant(0.5f), all, nested(diffuse(0.1f))});
    EXPECT_THROW(Material(Blend{constant(0.5f), all, nested(diffuse(0.1f))}), std::invalid_argument);
}

}  // namespace
}  // namespace gib::test::material_test
