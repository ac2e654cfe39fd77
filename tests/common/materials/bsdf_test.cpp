// Tests of Fresnel reflection, of the smooth scattering models, of the modified Phong model, and of the Bsdf that is made
// of them.

#include "common/materials/bsdf.h"
#include "common/materials/fresnel.h"
#include "common/materials/phong.h"
#include "common/sampling/sampler.h"
#include "common/sampling/warp.h"
#include "tests/common/materials/scattering_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::bsdf_test {
namespace {

Vec3 direction(float cos_theta, float phi) {
    const float s = safe_sqrt(1.f - cos_theta * cos_theta);
    return {s * std::cos(phi), s * std::sin(phi), cos_theta};
}

TEST(Fresnel, NormalIncidenceBrewsterAndTotalReflectionAreExact) {
    const float eta = 1.5f;
    EXPECT_NEAR(fresnel_dielectric(1.f, eta).reflectance, sqr((eta - 1) / (eta + 1)), 1e-7f);
    EXPECT_NEAR(fresnel_dielectric(-1.f, eta).reflectance, sqr((eta - 1) / (eta + 1)), 1e-7f);
    // At Brewster's angle only the s-polarised half is reflected: R = ((eta^2 - 1) / (eta^2 + 1))^2 / 2.
    const float brewster = std::cos(std::atan(eta));
    EXPECT_NEAR(fresnel_dielectric(brewster, eta).reflectance, 0.5f * sqr((eta * eta - 1) / (eta * eta + 1)), 1e-6f);
    EXPECT_EQ(fresnel_dielectric(0.f, eta).reflectance, 1.f);
    const float critical = std::sqrt(1.f - 1.f / (eta * eta));
    EXPECT_EQ(fresnel_dielectric(-critical + 1e-3f, eta).reflectance, 1.f);
    EXPECT_LT(fresnel_dielectric(-critical - 1e-3f, eta).reflectance, 1.f);
    // Schlick's approximation gives 0.07 here.
    EXPECT_NEAR(fresnel_dielectric(0.5f, eta).reflectance, 0.0891867f, 1e-6f);
}

// The reflectance is the same along a ray path and its reverse; Schlick's approximation with the angle on the
// incident side would break this.
TEST(Fresnel, ReflectanceIsTheSameAlongTheReversedPath) {
    for (float c : {0.05f, 0.3f, 0.7f, 0.99f}) {
        const auto in = fresnel_dielectric(c, 1.7f);
        const auto back = fresnel_dielectric(in.cos_t, 1.7f);
        EXPECT_NEAR(in.reflectance, back.reflectance, 1e-5f);
        EXPECT_NEAR(back.cos_t, c, 1e-5f);
        EXPECT_NEAR(in.eta_ti * back.eta_ti, 1.f, 1e-6f);
    }
}

TEST(Fresnel, ConductorWithoutAbsorptionIsADielectric) {
    for (float c : {0.05f, 0.3f, 0.7f, 1.f})
        EXPECT_NEAR(fresnel_conductor(c, Color::Constant(1.5f), Color::Zero())[0],
                    fresnel_dielectric(c, 1.5f).reflectance, 1e-5f);
    // At normal incidence with eta = k = 0 the formula is 0 / 0.
    EXPECT_EQ(fresnel_conductor(1.f, Color::Zero(), Color::Zero())[0], 1.f);
    // Gold at 630 nm, normal incidence: ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2).
    const float n = 0.197f, k = 3.09f;
    EXPECT_NEAR(fresnel_conductor(1.f, Color::Constant(n), Color::Constant(k))[0],
                (sqr(n - 1) + k * k) / (sqr(n + 1) + k * k), 1e-5f);
}

// Radiance L / eta^2 is constant along a refracted ray: f(o -> i) / eta_i^2 is symmetric (Veach 1997, eq. 5.14). For
// a delta lobe, f |cos_i| is (1 - F) / eta_ti^2 one way and (1 - F) eta_ti^2 the other way; power has no such factor.
TEST(Dielectric, RefractionIsReciprocalWithTheSquaredIndex) {
    const Dielectric glass{1.5f};
    for (float c : {0.2f, 0.6f, 0.95f}) {
        const Vec3 wo = direction(c, 0.7f);
        const auto in = glass.sample_local(wo, 0.9999f, {0.5f, 0.5f}, Transport::radiance, Lobes::all);
        ASSERT_TRUE(in && in->wi.z() < 0);
        const auto out = glass.sample_local(in->wi, 0.9999f, {0.5f, 0.5f}, Transport::radiance, Lobes::all);
        ASSERT_TRUE(out && out->wi.z() > 0);
        EXPECT_LT((out->wi - wo).norm(), 1e-5f);
        const float f_in = in->f[0] * std::abs(in->wi.z()), f_out = out->f[0] * std::abs(out->wi.z());
        EXPECT_NEAR(f_in * sqr(1.5f), f_out / sqr(1.5f), 1e-4f);
        EXPECT_NEAR(in->f[0] * std::abs(in->wi.z()) / in->pdf_w, 1.f / sqr(1.5f), 1e-5f);
        const auto photon = glass.sample_local(wo, 0.9999f, {0.5f, 0.5f}, Transport::power, Lobes::all);
        EXPECT_NEAR(photon->f[0] * std::abs(photon->wi.z()) / photon->pdf_w, 1.f, 1e-5f);
    }
}

TEST(Dielectric, ReflectsAndRefractsWithProbabilitiesThatSumToOne) {
    const Dielectric glass{1.5f};
    for (float c : {-0.9f, -0.5f, 0.1f, 0.8f}) {
        const Vec3 wo = direction(c, 1.f);
        const auto reflected = glass.sample_local(wo, 0.f, {0.5f, 0.5f}, Transport::power, Lobes::all);
        ASSERT_TRUE(reflected);
        EXPECT_GT(reflected->wi.z() * wo.z(), 0.f);
        const auto other = glass.sample_local(wo, 0.9999999f, {0.5f, 0.5f}, Transport::power, Lobes::all);
        const float transmitted = other && other->wi.z() * wo.z() < 0.f ? other->pdf_w : 0.f;
        EXPECT_NEAR(reflected->pdf_w + transmitted, 1.f, 1e-6f) << c;
    }
}

TEST(Bsdf, CoefficientsAreTheMeanWeightOfItsSamples) {
    const std::vector<Bsdf> bsdfs = {
        Bsdf(Diffuse{Color(0.2f, 0.5f, 0.9f)}),
        Bsdf(Diffuse{Color(0.2f, 0.5f, 0.9f)}, Diffuse{Color(0.1f, 0.3f, 0.3f)}),
        Bsdf(Dielectric{1.5f, 0.f, Color(0.9f, 0.8f, 1.f), Color(1.f, 0.5f, 0.25f)}),
        Bsdf(Conductor{ConductorIndex{Color(0.2f, 0.9f, 1.5f), Color(3.f, 2.f, 2.f)}}),
    };
    constexpr std::uint32_t n = 1 << 14;
    for (std::size_t b = 0; b < bsdfs.size(); ++b)
        for (float c : {-0.7f, 0.1f, 0.8f}) {
            const Vec3 wo = direction(c, 0.3f);
            Colord sum = Colord::Zero();
            for (std::uint32_t i = 0; i < n; ++i) {
                const Sampler u(PointSet::sobol, b, 0, i);
                if (const auto s = bsdfs[b].sample_local(wo, u.get_2d(0), u.get_2d(1), Transport::power))
                    sum += (s->f * (std::abs(s->wi.z()) / s->pdf_w)).cast<double>();
            }
            const auto k = bsdfs[b].coefficients_local(wo);
            for (int ch = 0; ch < 3; ++ch)
                EXPECT_NEAR(sum[ch] / n, static_cast<double>(k.diffuse[ch] + k.specular[ch]), 2e-3) << b << ' ' << c;
        }
}

// Both lobes together scatter all light: R is reflected, and 1 - R is refracted and scaled by the
// squared index, as radiance is.
TEST(Bsdf, DeltaPairIsAllLightOfASmoothInterface) {
    const float eta = 1.5f;
    for (const float cosine : {0.05f, 0.4f, 0.99f, -0.8f, -0.99f}) {
        const Vec3 wo = direction(cosine, 0.3f);
        const auto pair = Bsdf(Dielectric{eta}).delta_pair_local(wo, Transport::radiance);
        ASSERT_TRUE(pair);
        const auto fresnel = fresnel_dielectric(cosine, eta);
        EXPECT_NEAR((*pair)[0].f[0] * std::abs((*pair)[0].wi.z()), fresnel.reflectance, 1e-6f);
        EXPECT_NEAR((*pair)[1].f[0] * std::abs((*pair)[1].wi.z()) * sqr((*pair)[1].eta), 1.f - fresnel.reflectance,
                    1e-6f);
        EXPECT_EQ((*pair)[0].eta, 1.f);
        EXPECT_GT((*pair)[0].wi.z() * cosine, 0.f);
        EXPECT_LT((*pair)[1].wi.z() * cosine, 0.f);
    }
}

// A thin sheet lets the light straight on that it does not reflect, tinted, the same from both sides; so do holes of a mask.
TEST(Bsdf, ThinSheetsLetStraightOnWhatTheyDoNotReflect) {
    const Color tint(1.f, 0.5f, 0.f);
    const ThinDielectric sheet{.eta = 1.5f, .specular_transmittance = tint};
    const Bsdf masked({{sheet, 0.6f}}, 0.4f), mixed({{sheet, 0.5f}, {Diffuse{Color::Ones()}, 0.5f}}, 0.f);
    for (const float cosine : {0.05f, 0.4f, 0.99f, -0.8f}) {
        const Vec3 wo = direction(cosine, 0.3f);
        const float reflected = Bsdf(sheet).coefficients_local(wo).specular[0];
        const float r = fresnel_dielectric(std::abs(cosine), 1.5f).reflectance;
        EXPECT_NEAR(reflected, 2 * r / (1 + r), 1e-6f);
        for (int c = 0; c < 3; ++c) {
            const float straight = (1 - reflected) * tint[c];
            EXPECT_NEAR(Bsdf(sheet).straight_on_local(wo)[c], straight, 1e-6f);
            EXPECT_NEAR(Bsdf(sheet).straight_on_local(-wo)[c], straight, 1e-6f);
            EXPECT_NEAR(masked.straight_on_local(wo)[c], 0.4f + 0.6f * straight, 1e-6f);
            EXPECT_NEAR(mixed.straight_on_local(wo)[c], 0.5f * straight, 1e-6f);
        }
    }
    EXPECT_EQ(Bsdf(Dielectric{1.5f}).straight_on_local(direction(0.5f, 0.f))[0], 0.f);
}

TEST(Bsdf, DeltaPairIsEmptyWhereThereIsOneWayOrAThird) {
    const auto pair = [](const Bsdf& bsdf, float cosine) {
        return bsdf.delta_pair_local(direction(cosine, 0.3f), Transport::radiance).has_value();
    };
    EXPECT_FALSE(pair(Bsdf(Dielectric{1.5f}), -0.3f));  // total reflection
    EXPECT_FALSE(pair(Bsdf(Dielectric{1.f}), 0.5f));    // nothing is reflected
    EXPECT_FALSE(pair(Bsdf(Conductor{}), 0.5f));
    EXPECT_FALSE(pair(Bsdf(Diffuse{Color::Constant(0.5f)}), 0.5f));
    const Bsdf mixture({{Dielectric{1.5f}, 0.5f}, {ThinDielectric{1.3f}, 0.5f}}, 0.f);
    EXPECT_FALSE(pair(mixture, 0.5f));
    const Bsdf coated({{Dielectric{1.5f}, 0.5f}, {Diffuse{Color::Constant(0.5f)}, 0.5f}}, 0.f);
    EXPECT_FALSE(pair(coated, 0.5f));
}

TEST(Bsdf, OneSidedScattersNothingFromBehindAndTwoSidedDoes) {
    const Bsdf one(Diffuse{Color::Constant(0.5f)});
    const Bsdf two(Diffuse{Color::Constant(0.5f)}, Diffuse{Color::Constant(0.25f)});
    const Vec3 up = direction(0.6f, 0.f), down = direction(-0.6f, 0.f);
    EXPECT_EQ(one.f_local(down, down).diffuse[0], 0.f);
    EXPECT_FALSE(one.sample_local(down, {0.f, 0.f}, {0.3f, 0.3f}, Transport::radiance));
    EXPECT_NEAR(two.f_local(down, down).diffuse[0], 0.25f * inv_pi, 1e-7f);
    EXPECT_NEAR(two.f_local(up, up).diffuse[0], 0.5f * inv_pi, 1e-7f);
    EXPECT_EQ(two.f_local(up, down).diffuse[0], 0.f);
    EXPECT_LT(two.sample_local(down, {0.f, 0.f}, {0.3f, 0.3f}, Transport::radiance)->wi.z(), 0.f);
}

Phong glossy(float exponent) { return {Color::Zero(), Color::Ones(), exponent}; }

// The density integrates to less than 1, because the part of the lobe below the surface gives empty samples.
TEST(Phong, DensityIntegratesToTheShareOfSamplesThatAreNotEmpty) {
    for (float n : {0.f, 1.f, 30.f, 300.f})
        for (double degrees : {0.0, 40.0, 80.0, 89.0}) {
            const Phong m{Color::Constant(0.3f), Color::Constant(0.5f), n};
            const Vec3 wo = direction_at(degrees, 0.3);
            EXPECT_NEAR(density_integral(m, wo), sampled_share(m, wo).valid, 3e-3) << n << ' ' << degrees;
        }
}

// The mean of cos(alpha) under the density (n + 1) / (2 pi) cos^n is (n + 1) / (n + 2).
TEST(Phong, SamplesKeepTheirDigitsForHighExponents) {
    for (float n : {1.f, 100.f, 1e4f, 1e7f}) {
        const Vec3 wo = direction_at(45, 0.3), r = mirrored_direction(wo);
        double mean = 0;
        int count = 0;
        for (std::uint32_t i = 0; i < 1u << 14; ++i) {
            const Sampler u(PointSet::sobol, 1, 1, i);
            const auto s =
                glossy(n).sample_local(n < 100 ? Vec3(0, 0, 1) : wo, 0.f, u.get_2d(0), Transport::radiance, Lobes::all);
            if (!s) continue;
            mean += 0.5 * (s->wi - (n < 100 ? Vec3(0, 0, 1) : r)).cast<double>().squaredNorm();
            ++count;
        }
        EXPECT_NEAR(mean / count * (static_cast<double>(n) + 2), 1, 3e-3) << n;
    }
}

TEST(Phong, ItsLobeIsSpecularFromARoughnessOfATenthOn) {
    const Vec3 wo = direction_at(30, 0), wi = direction_at(31, 3.1);
    const Phong wide{Color::Constant(0.3f), Color::Constant(0.5f), 197.f},
        narrow{Color::Constant(0.3f), Color::Constant(0.5f), 199.f};
    EXPECT_TRUE(wide.traits().diffuse && !wide.traits().glossy && wide.traits().rough);
    EXPECT_TRUE(narrow.traits().diffuse && narrow.traits().glossy && narrow.traits().rough);
    EXPECT_EQ(wide.f_local(wo, wi, Transport::radiance).specular[0], 0.f);
    EXPECT_NEAR(narrow.f_local(wo, wi, Transport::radiance).diffuse[0], 0.3f * inv_pi, 1e-6f);
    EXPECT_EQ(narrow.pdf_w_local(wo, wi, Lobes::diffuse), cosine_hemisphere_pdf(wi.z()));
    EXPECT_NEAR(
        narrow.pdf_w_local(wo, wi, Lobes::all),
        (0.3f * narrow.pdf_w_local(wo, wi, Lobes::diffuse) + 0.5f * narrow.pdf_w_local(wo, wi, Lobes::specular)) / 0.8f,
        1e-4f);
    EXPECT_EQ(narrow.sample_local(wo, 0.9f, {0.3f, 0.3f}, Transport::radiance, Lobes::specular)->lobe,
              LobeKind::specular);
    EXPECT_FALSE(glossy(30.f).sample_local(wo, 0.9f, {0.3f, 0.3f}, Transport::radiance, Lobes::specular));
    EXPECT_FALSE((Phong{Color::Zero(), Color::Zero(), 30.f}.traits().scatters()));
}

}  // namespace
}  // namespace gib::test::bsdf_test
