// Tests of the modified Phong model: its density, energy, sampling and lobes.

#include "common/materials/phong.h"

#include "common/sampling/warp.h"
#include "tests/common/materials/scattering_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::phong_test {
namespace {

Phong glossy(float exponent) { return {Color::Zero(), Color::Ones(), exponent}; }

// The density integrates to less than 1, because the part of the lobe below the surface gives empty samples.
TEST(Phong, DensityIntegratesToTheShareOfSamplesThatAreNotEmpty) {
    for (float n : {0.f, 1.f, 30.f, 300.f})
        for (double degrees : {0.0, 40.0, 80.0, 89.0}) {
            const Phong m{Color::Constant(0.3f), Color::Constant(0.5f), n};
            const Vec3 wo = direction_at(degrees, 0.3);
            const auto integral = [&](Lobes which) {
                return sphere_integral(mirrored_direction(wo),
                                       [&](const Vec3& wi) { return m.pdf_w_local(wo, wi, which); });
            };
            EXPECT_NEAR(integral(Lobes::all), sampled_share(m, wo).valid, 3e-3) << n << ' ' << degrees;
        }
}

// Both lobes together reflect rho_d + rho_s at normal incidence, and never more
// (Lafortune and Willems 1994, section 4).
TEST(Phong, ReflectsAtMostTheSumOfItsReflectances) {
    for (float n : {0.f, 1.f, 30.f, 1e3f, 1e6f}) {
        const Phong m{Color::Constant(0.3f), Color::Constant(0.5f), n};
        EXPECT_NEAR(sampled_share(m, Vec3(0, 0, 1)).weight, 0.8, 1e-3) << n;
        double last = 1;
        for (double degrees : {20.0, 50.0, 80.0, 89.0}) {
            const double share = sampled_share(m, direction_at(degrees, 0.3)).weight;
            EXPECT_LE(share, 0.8 + 1e-3) << n << ' ' << degrees;
            EXPECT_LE(share, last + 1e-3);
            last = share;
        }
    }
    for (double degrees : {0.0, 50.0, 80.0}) {
        const Phong m{Color::Constant(0.3f), Color::Constant(0.5f), 30.f};
        const Vec3 wo = direction_at(degrees, 0.3);
        const double sum = sphere_integral(mirrored_direction(wo), [&](const Vec3& wi) {
            return wi.z() > 0 ? m.f_local(wo, wi, Transport::radiance).sum()[0] * wi.z() : 0.f;
        });
        EXPECT_NEAR(sampled_share(m, wo).weight, sum, 1e-3) << degrees;
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

TEST(Phong, SamplesCarryTheirOwnValueAndDensity) {
    for (float n : {0.f, 30.f, 1e4f})
        for (double degrees : {0.0, 45.0, 80.0, 89.0})
            expect_samples_agree(Phong{Color::Constant(0.3f), Color::Constant(0.5f), n}, direction_at(degrees, 0.3),
                                 1e-6f, "phong", n == 0.f ? 2.f : 1.1f);
    const Phong only = glossy(30.f);
    const Vec3 wo = direction_at(20, 0.3), wi = direction_at(25, 3.2);
    // f / pdf = rho_s (n + 2) / (n + 1).
    EXPECT_NEAR(only.f_local(wo, wi, Transport::radiance).sum()[0] / only.pdf_w_local(wo, wi, Lobes::all), 32.f / 31.f,
                1e-5f);
}

TEST(Phong, IsReciprocalAndOneSided) {
    const Phong m{Color(0.2f, 0.3f, 0.4f), Color(0.5f, 0.2f, 0.1f), 20.f};
    for (double a : {5.0, 50.0, 88.0})
        for (double b : {10.0, 70.0, 95.0, 170.0}) {
            const Vec3 o = direction_at(a, 0.4), i = direction_at(b, 3.0);
            const Color there = m.f_local(o, i, Transport::radiance).sum(),
                        back = m.f_local(i, o, Transport::radiance).sum();
            EXPECT_TRUE(((there - back).abs() <= 1e-5f * there).all());
            EXPECT_EQ(is_black(there), b > 90);
            EXPECT_EQ(m.sample_local(i, 0.5f, {0.3f, 0.3f}, Transport::radiance, Lobes::all).has_value(), b < 90);
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

TEST(Phong, NothingIsEverNaN) {
    for (float n : {0.f, 0.1f, 30.f, 1e8f})
        for (const Color& diffuse : {Color(Color::Zero()), Color(Color::Constant(0.5f))})
            for (const Color& specular : {Color(Color::Zero()), Color(Color::Constant(0.5f))})
                expect_finite(Phong{diffuse, specular, n}, "phong " + std::to_string(n));
}

}  // namespace
}  // namespace gib::test::phong_test
