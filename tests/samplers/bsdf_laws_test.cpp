// The laws of physics that every material must obey, whatever its model.

#include "tests/samplers/sampler_cases.h"

#include <gtest/gtest.h>

namespace gib::test::bsdf_laws_test {
namespace {

Vec3 random_direction(const Vec2& u) {
    const Vec2d x(2 * static_cast<double>(u.x()), 2 * std::numbers::pi * static_cast<double>(u.y()));
    return SphereChart().direction(x).cast<float>();
}

constexpr std::uint32_t pairs = 10'000;

// Reciprocity (Veach 1997, equation 5.14): f(wo, wi) / eta_o^2 = f(wi, wo) / eta_i^2, where f(wo, wi) scatters light
// from wi to wo. Half of the pairs come from the material's own sampling, so that narrow lobes are tested too.
TEST(BsdfLaws, EveryMaterialIsReciprocal) {
    for (const BsdfModel& model : bsdf_models()) {
        const LocalBsdf bsdf(model);
        int wrong = 0;
        for (std::uint32_t i = 0; i < pairs; ++i) {
            const Sampler numbers(PointSet::independent, 5, 0, i);
            const Vec3 wo = random_direction(numbers.get_2d(7));
            Vec3 wi = random_direction(numbers.get_2d(8));
            if (i % 2 == 0) {
                const auto s = bsdf.sample(wo, RandomNumbers(numbers), Transport::radiance);
                if (!s || s->delta) continue;
                wi = s->wi;
            }
            const Colord there = bsdf.f(wo, wi).cast<double>() / sqr(bsdf.index(wo));
            const Colord back = bsdf.f(wi, wo).cast<double>() / sqr(bsdf.index(wi));
            // The rounding of nearly grazing directions changes the values of narrow lobes.
            const double tolerance = std::min(std::abs(wo.z()), std::abs(wi.z())) < 1e-2f ? 1e-2 : 1e-3;
            if (!((there - back).abs() <= tolerance * there.max(back)).all() && wrong++ == 0) {
                ADD_FAILURE() << model.name << ": f(" << wo.transpose() << " | " << wi.transpose() << ") = " << there[0]
                              << ", reversed " << back[0];
            }
        }
        EXPECT_EQ(wrong, 0) << model.name;
    }
}

// Radiance is scaled by (eta_o / eta_i)^2 at a refraction, power is not (Veach 1997, section 5.2). Directions are
// sampled alike for both.
TEST(BsdfLaws, RadianceAndPowerDifferByTheSquaredIndexOnly) {
    for (const BsdfModel& model : bsdf_models()) {
        const LocalBsdf bsdf(model);
        for (std::uint32_t i = 0; i < pairs; ++i) {
            const Sampler numbers(PointSet::independent, 6, 0, i);
            const Vec3 wo = random_direction(numbers.get_2d(7));
            const auto radiance = bsdf.sample(wo, RandomNumbers(numbers), Transport::radiance);
            const auto power = bsdf.sample(wo, RandomNumbers(numbers), Transport::power);
            ASSERT_EQ(radiance.has_value(), power.has_value()) << model.name;
            if (!radiance) continue;
            EXPECT_EQ(radiance->wi, power->wi) << model.name;
            EXPECT_EQ(radiance->pdf_w, power->pdf_w) << model.name;
            const double eta = bsdf.index(radiance->wi) / bsdf.index(wo);
            EXPECT_NEAR(static_cast<double>(radiance->eta), eta, 1e-5) << model.name;
            const Colord expected = power->f.cast<double>() / sqr(eta);
            ASSERT_TRUE(((radiance->f.cast<double>() - expected).abs() <= 1e-4 * expected).all())
                << model.name << ' ' << wo.transpose() << " | " << power->wi.transpose();
        }
    }
}

std::vector<BsdfModel> all_models() {
    std::vector<BsdfModel> models = bsdf_models();
    for (BsdfModel& model : perturbed_models())
        models.push_back(std::move(model));
    return models;
}

// Veach 1997, equation 3.22: the f of power from wo to wi is the f of radiance that an eye at wi sees
// from wo. The law is exact for bump and normal maps too; without it, paths from the light and paths from
// the eye would disagree on them.
TEST(BsdfLaws, PowerIsScatteredAsTheEyeSeesIt) {
    for (const BsdfModel& model : all_models()) {
        const LocalBsdf bsdf(model);
        int wrong = 0, bright = 0;
        for (std::uint32_t i = 0; i < pairs; ++i) {
            const Sampler numbers(PointSet::independent, 8, 0, i);
            const Vec3 wo = random_direction(numbers.get_2d(7));
            Vec3 wi = random_direction(numbers.get_2d(8));
            if (i % 2 == 0) {
                const auto s = bsdf.sample(wo, RandomNumbers(numbers), Transport::power);
                if (!s || s->delta) continue;
                wi = s->wi;
            }
            const Color power = bsdf.f(wo, wi, Transport::power), radiance = bsdf.f(wi, wo);
            if (!is_black(radiance)) ++bright;
            const float tolerance = std::min(std::abs(wo.z()), std::abs(wi.z())) < 1e-2f ? 1e-2f : 1e-3f;
            if (!((power - radiance).abs() <= tolerance * power.max(radiance)).all() && wrong++ == 0) {
                ADD_FAILURE() << model.name << ": f(" << wo.transpose() << " | " << wi.transpose() << ") = " << power[0]
                              << " for power, as the eye sees it " << radiance[0];
            }
        }
        EXPECT_EQ(wrong, 0) << model.name;
        if (model.name.find("normalmap") != std::string::npos) {
            EXPECT_GT(bright, pairs / 10) << model.name;
        }
    }
}

/// Along the normal, level and nearly so, and the mirrored ones of all.
std::vector<Vec3> hard_directions() {
    std::vector<Vec3> directions = {Vec3(0, -1, 0), Vec3(1, 0, 1e-30f), Vec3(-1, 0, -1e-38f)};
    for (const double degrees : {0.0, 1e-3, 89.999, 90.0, 90.001, 179.999, 180.0})
        for (const double azimuth : {0.0, 110.0, 180.0})
            directions.push_back(direction_at(degrees, azimuth));
    return directions;
}

TEST(BsdfLaws, ScatteringIsNeverNegative) {
    const std::vector<Vec3> hard = hard_directions();
    for (const BsdfModel& model : all_models()) {
        const LocalBsdf bsdf(model);
        for (const Vec3& wo : hard)
            for (const Vec3& wi : hard) {
                // ward and ward-duer have a pole where both directions are level.
                if (wo.z() * wi.z() == 0.f && model.name.starts_with("ward")) continue;
                const Color f = bsdf.f(wo, wi);
                const double pdf = bsdf.pdf(wo, wi);
                ASSERT_TRUE((f >= 0.f).all() && f.allFinite() && pdf >= 0 && std::isfinite(pdf))
                    << model.name << ' ' << wo.transpose() << " | " << wi.transpose();
            }
        for (std::uint32_t i = 0; i < pairs; ++i) {
            const Sampler numbers(PointSet::independent, 7, 0, i);
            const Vec3 wo = random_direction(numbers.get_2d(7)), wi = random_direction(numbers.get_2d(8));
            const Color f = bsdf.f(wo, wi);
            const double pdf = bsdf.pdf(wo, wi);
            ASSERT_TRUE((f >= 0.f).all() && f.allFinite() && pdf >= 0 && std::isfinite(pdf)) << model.name;
            // A direction with f > 0 must have a density, or the sampling would be biased.
            ASSERT_TRUE(is_black(f) || pdf > 0) << model.name << ' ' << wo.transpose() << " | " << wi.transpose();
        }
    }
}

}  // namespace
}  // namespace gib::test::bsdf_laws_test
