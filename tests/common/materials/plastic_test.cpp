// Tests of smooth and rough plastic: a dielectric coat over a diffuse base.

#include "common/materials/plastic.h"
#include "common/materials/fresnel.h"

#include "tests/common/materials/scattering_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::plastic_test {
namespace {

template <typename Model>
Model colored(float eta, const Color& base, bool nonlinear) {
    Model m;
    m.eta = eta;
    m.diffuse_reflectance = base;
    m.nonlinear = nonlinear;
    return m;
}

Plastic plastic(float eta = 1.49f, const Color& base = Color::Ones(), bool nonlinear = false) {
    Plastic m = colored<Plastic>(eta, base, nonlinear);
    m.prepare();
    return m;
}

RoughPlastic rough_plastic(MicrofacetType type, float alpha, const Color& base = Color::Ones(),
                           bool nonlinear = false) {
    RoughPlastic m = colored<RoughPlastic>(1.49f, base, nonlinear);
    m.distribution = {type, alpha, alpha};
    m.prepare();
    return m;
}

/// The closed form of Walsh 1926, "The reflection factor of a polished glass surface for diffused light", for n > 1.
double walsh(double n) {
    const double n2 = n * n, n4 = n2 * n2;
    return 0.5 + (n - 1) * (3 * n + 1) / (6 * sqr(n + 1)) +
           n2 * sqr(n2 - 1) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
           2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
           8 * n4 * (n4 + 1) / ((n2 + 1) * sqr(n4 - 1)) * std::log(n);
}

TEST(Plastic, DiffuseFresnelReflectanceIsWalshs) {
    for (double n : {1.05, 1.33, 1.49, 1.9, 2.5, 10.0}) {
        EXPECT_NEAR(static_cast<double>(diffuse_fresnel_reflectance(static_cast<float>(n))), walsh(n), 2e-6) << n;
        EXPECT_NEAR(static_cast<double>(diffuse_fresnel_reflectance(static_cast<float>(1 / n))),
                    1 - (1 - walsh(n)) / (n * n), 2e-6);
    }
    EXPECT_NEAR(diffuse_fresnel_reflectance(1.f), 0.f, 1e-7f);
    // The reflectance from inside is compared with the integral over all angles, total reflection included.
    double sum = 0;
    for (int i = 0; i < 20000; ++i) {
        const double c = (i + 0.5) / 20000;
        sum += 2 * c * static_cast<double>(fresnel_dielectric(static_cast<float>(c), 1 / 1.5f).reflectance) / 20000;
    }
    EXPECT_NEAR(static_cast<double>(diffuse_fresnel_reflectance(1 / 1.5f)), sum, 2e-5);
}

// A white base absorbs nothing: all light that the coat does not reflect comes back from the base. The tolerance is
// the error of the quadrature, which is larger for eta < 1, where light cannot enter beyond a critical angle.
TEST(Plastic, AWhiteOneReflectsAllLight) {
    for (float eta : {1.2f, 1.49f, 1.9f, 0.8f})
        for (bool nonlinear : {false, true})
            for (double degrees : {0.0, 45.0, 80.0, 89.0}) {
                const Plastic m = plastic(eta, Color::Ones(), nonlinear);
                const Vec3 wo = direction_at(degrees, 0.3);
                const double coat = fresnel_dielectric(wo.z(), eta).reflectance;
                EXPECT_NEAR(reflected_integral(m, wo) + coat, 1, eta < 1 ? 3e-4 : 2e-4) << eta << ' ' << degrees;
                EXPECT_NEAR(sampled_share(m, wo).weight, 1, 1e-3) << eta << ' ' << degrees;
                EXPECT_NEAR(sampled_share(m, wo, Transport::power, Lobes::specular).weight, coat, 1e-6);
                EXPECT_NEAR(m.coefficients_local(wo).of(Lobes::all)[0], 1.f, 2e-5f);
            }
}

// The colour is the sum over internal reflections under the coat: T rho (1 - R) (1 + rho R + (rho R)^2 ...). Unless
// nonlinear, the base does not absorb the light that the coat reflects back to it, so the sum is T rho.
TEST(Plastic, ColorsAreTheSumOverInternalReflections) {
    const Color rho(0.9f, 0.5f, 0.1f);
    const Vec3 wo = direction_at(30, 1);
    const float t = 1 - fresnel_dielectric(wo.z(), 1.49f).reflectance, r = diffuse_fresnel_reflectance(1 / 1.49f);
    const Plastic linear = plastic(1.49f, rho, false), nonlinear = plastic(1.49f, rho, true);
    for (int c = 0; c < 3; ++c) {
        float rounds = 0, trapped = rho[c];
        for (int k = 0; k < 200; ++k, trapped *= rho[c] * r)
            rounds += trapped * (1 - r);
        EXPECT_NEAR(reflected_integral(nonlinear, wo, c), t * rounds, 1e-4);
        EXPECT_NEAR(reflected_integral(linear, wo, c), t * rho[c], 1e-4);
        EXPECT_NEAR(nonlinear.coefficients_local(wo).diffuse[c], t * rounds, 1e-5);
        EXPECT_NEAR(linear.coefficients_local(wo).diffuse[c], t * rho[c], 1e-5);
    }
}

TEST(Plastic, SamplesLobesByWhatTheyReflect) {
    Plastic m = plastic(1.49f, Color::Constant(0.5f));
    for (double degrees : {0.0, 60.0, 89.0}) {
        const Vec3 wo = direction_at(degrees, 0.3);
        const float r = fresnel_dielectric(wo.z(), 1.49f).reflectance, coat = r / (r + (1 - r) * 0.5f);
        const auto mirrored = m.sample_local(wo, 0.f, {0.3f, 0.6f}, Transport::radiance, Lobes::all);
        ASSERT_TRUE(mirrored && mirrored->delta);
        EXPECT_NEAR(mirrored->pdf_w, coat, 1e-6f);
        EXPECT_LT((mirrored->wi - mirrored_direction(wo)).norm(), 1e-6f);
        EXPECT_NEAR(sphere_integral(Vec3(0, 0, 1), [&](const Vec3& wi) { return m.pdf_w_local(wo, wi, Lobes::all); }),
                    1 - coat, 2e-4);
        EXPECT_NEAR(
            sphere_integral(Vec3(0, 0, 1), [&](const Vec3& wi) { return m.pdf_w_local(wo, wi, Lobes::diffuse); }), 1,
            2e-4);
        EXPECT_EQ(m.pdf_w_local(wo, Vec3(0, 0, 1), Lobes::specular), 0.f);
    }
    EXPECT_TRUE(m.traits().diffuse && m.traits().delta && !m.traits().glossy && !m.traits().rough);
    m.diffuse_reflectance = Color::Zero();
    EXPECT_FALSE(m.traits().diffuse);
    EXPECT_TRUE(m.sample_local(Vec3(0, 0, 1), 0.999f, {0.3f, 0.6f}, Transport::radiance, Lobes::all)->delta);
    EXPECT_FALSE(m.sample_local(Vec3(0, 0, 1), 0.5f, {0.3f, 0.6f}, Transport::radiance, Lobes::diffuse));
    m.specular_reflectance = Color::Zero();
    EXPECT_FALSE(m.traits().scatters());
    EXPECT_FALSE(m.sample_local(Vec3(0, 0, 1), 0.5f, {0.3f, 0.6f}, Transport::radiance, Lobes::all));
}

// Compares the table of the coat with the rough dielectric, whose sampled shares have a standard error below 4e-4;
// the tolerance is four of these.
TEST(RoughPlastic, ItsCoatTransmitsWhatARoughDielectricDoes) {
    for (auto type : microfacet_types)
        for (float alpha : {0.05f, 0.3f, 1.f}) {
            const MicrofacetDistribution d{type, alpha, alpha};
            const RoughCoat coat(d, 1.49f);
            RoughDielectric transmitting{1.49f, 0.f, d}, reflecting{1.49f, 0.f, d};
            transmitting.specular_reflectance = reflecting.specular_transmittance = Color::Zero();
            for (int node : {1, 5, 30, 63}) {
                const float c = static_cast<float>(node) / 63;
                const Vec3 wo(std::sqrt(1 - c * c), 0, c);
                EXPECT_NEAR(double{coat.transmittance(c)}, sampled_share(transmitting, wo).weight, 1.6e-3)
                    << alpha << ' ' << node;
            }
            const float between = 10.25f / 63;
            EXPECT_NEAR(coat.transmittance(between), 0.75f * coat.nodes[10] + 0.25f * coat.nodes[11], 1e-6f);
            // The internal reflectance is a plain mean over 64 cosines, as in Mitsuba.
            double mean = 0;
            for (int node = 1; node < 64; ++node) {
                const float c = static_cast<float>(node) / 63;
                mean += 2 * static_cast<double>(c) *
                        sampled_share(reflecting, Vec3(std::sqrt(1 - c * c), 0, -c)).weight / 64;
            }
            EXPECT_NEAR(double{coat.internal_reflectance}, mean, 3e-4) << alpha;
        }
}

TEST(RoughPlastic, TendsToPlasticButForTheTablesMean) {
    for (auto type : microfacet_types) {
        const RoughPlastic rough = rough_plastic(type, 1e-3f);
        const RoughCoat coat(rough.distribution, 1.49f);
        const Plastic smooth = plastic();
        const float darker = (1 - diffuse_fresnel_reflectance(1 / 1.49f)) / (1 - coat.internal_reflectance);
        EXPECT_NEAR(darker, 0.974f, 2e-3f);
        for (double degrees : {0.0, 40.0, 70.0}) {
            const Vec3 wo = direction_at(degrees, 0.3), wi = direction_at(50, 2.0);
            const float f = smooth.f_local(wo, wi, Transport::radiance).diffuse[0];
            EXPECT_NEAR(rough.f_local(wo, wi, Transport::radiance).diffuse[0], f * darker, 2e-3f * f);
            EXPECT_NEAR(sampled_share(rough, wo, Transport::power, Lobes::specular).weight,
                        fresnel_dielectric(wo.z(), 1.49f).reflectance, 1e-3);
        }
    }
}

TEST(RoughPlastic, ReflectsAtMostAllLight) {
    for (auto type : microfacet_types)
        for (float alpha : {0.01f, 0.1f, 0.4f, 1.f})
            for (bool nonlinear : {false, true}) {
                const RoughPlastic white = rough_plastic(type, alpha, Color::Ones(), nonlinear);
                for (double degrees : {0.0, 60.0, 85.0}) {
                    const double share = sampled_share(white, direction_at(degrees, 0.3)).weight;
                    EXPECT_LE(share, 1.0) << alpha << ' ' << degrees;
                    if (degrees > 60) continue;
                    const double tolerance = alpha < 0.1f ? 0.02 : 2e-3;
                    EXPECT_NEAR(share, reflected_integral(white, direction_at(degrees, 0.3)), tolerance) << alpha;
                }
            }
}

// According to the tables, a white base gives off at most the light that enters. The tolerance is the rounding of R
// to a float, whose effect grows as 1 / (1 - R), and four roundings of numbers below 1.
TEST(RoughPlastic, ItsBaseGivesOffAtMostWhatComesIn) {
    for (auto type : microfacet_types)
        for (float alpha : {1e-4f, 0.01f, 0.1f, 1.f})
            for (float eta : {1.0001f, 1.49f, 3.f, 5.7f, 7.f, 100.f}) {
                RoughPlastic white = colored<RoughPlastic>(eta, Color::Ones(), false);
                white.distribution = {type, alpha, alpha};
                white.prepare();
                const float escaping = 1 - RoughCoat(white.distribution, eta).internal_reflectance;
                const float rounding = unit_roundoff * (1 / escaping + 4);
                for (double degrees : {0.0, 60.0, 89.0})
                    EXPECT_LE(white.coefficients_local(direction_at(degrees, 0.3)).of(Lobes::all)[0], 1 + rounding)
                        << alpha << ' ' << eta << ' ' << degrees;
            }
}

TEST(RoughPlastic, ItsCoatIsSpecularIfItIsSmoothEnough) {
    const Vec3 wo = direction_at(30, 0), wi = direction_at(30, std::numbers::pi);
    const RoughPlastic narrow = rough_plastic(MicrofacetType::beckmann, 0.1f),
                       wide = rough_plastic(MicrofacetType::beckmann, 0.2f);
    EXPECT_TRUE(narrow.traits().glossy && narrow.traits().rough && narrow.traits().diffuse && !narrow.traits().delta);
    EXPECT_TRUE(!wide.traits().glossy && wide.traits().rough && wide.traits().diffuse);
    const LobeValues f = narrow.f_local(wo, wi, Transport::radiance);
    // The expected value is F D / (4 cos^2) at the facet along z, with D = 1 / (pi alpha^2); the masking differs from
    // 1 by only 1e-9 here.
    EXPECT_NEAR(f.specular[0], fresnel_dielectric(wo.z(), 1.49f).reflectance / (0.04f * pi * sqr(wo.z())), 1e-4f);
    EXPECT_LT(f.diffuse[0], inv_pi);
    EXPECT_EQ(wide.f_local(wo, wi, Transport::radiance).specular[0], 0.f);
    EXPECT_FALSE(wide.sample_local(wo, 0.f, {0.3f, 0.3f}, Transport::radiance, Lobes::specular));
    EXPECT_EQ(narrow.pdf_w_local(wo, wi, Lobes::diffuse), cosine_hemisphere_pdf(wi.z()));
    const auto s = narrow.sample_local(wo, 0.999f, {0.3f, 0.3f}, Transport::radiance, Lobes::specular);
    ASSERT_TRUE(s);
    EXPECT_EQ(s->lobe, LobeKind::specular);
    EXPECT_EQ(s->f[0], narrow.f_local(wo, s->wi, Transport::radiance).specular[0]);
    EXPECT_EQ(s->pdf_w, narrow.pdf_w_local(wo, s->wi, Lobes::specular));
}

}  // namespace
}  // namespace gib::test::plastic_test
