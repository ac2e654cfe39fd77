// Tests of the distributions of microfacets (normalisation, masking, sampling and Jacobians), and of the rough conductor
// and the rough dielectric.

#include "common/materials/rough_scattering.h"
#include "common/materials/fresnel.h"
#include "common/materials/microfacet.h"
#include "tests/common/materials/scattering_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::rough_scattering_test {
namespace {

const std::vector<MicrofacetDistribution> distributions = {
    {MicrofacetType::beckmann, 1e-4f, 1e-4f}, {MicrofacetType::beckmann, 0.05f, 0.3f},
    {MicrofacetType::beckmann, 0.5f, 0.5f},   {MicrofacetType::beckmann, 1.f, 0.2f},
    {MicrofacetType::ggx, 1e-4f, 1e-4f},      {MicrofacetType::ggx, 0.05f, 0.3f},
    {MicrofacetType::ggx, 0.5f, 0.5f},        {MicrofacetType::ggx, 1.f, 0.2f},
};
const std::vector<double> angles = {0, 30, 60, 80, 89, 89.999};

std::string name_of(const MicrofacetDistribution& d, double degrees = 0) {
    return std::string(d.type == MicrofacetType::ggx ? "ggx " : "beckmann ") + std::to_string(d.alpha_u) + ' ' +
           std::to_string(d.alpha_v) + " at " + std::to_string(degrees);
}

/// The integral of g(m) D(m) over all normals m by the midpoint rule in polar coordinates of the stretched slopes:
/// the radius r = t / (1 - t) in [0, infinity), and the azimuth.
template <typename G>
auto normal_integral(const MicrofacetDistribution& d, G&& g) {
    constexpr int rings = 1000, sectors = 128;
    const double area = double{d.alpha_u} * double{d.alpha_v};
    decltype(g(Vec3d())) sum = 0 * g(Vec3d(0, 0, 1));
    for (int i = 0; i < rings; ++i) {
        const double t = (i + 0.5) / rings, r = t / (1 - t);
        for (int j = 0; j < sectors; ++j) {
            const double phi = 2 * std::numbers::pi * (j + 0.5) / sectors;
            const Vec3d m =
                Vec3d(-double{d.alpha_u} * r * std::cos(phi), -double{d.alpha_v} * r * std::sin(phi), 1).normalized();
            // dm = cos^3 d(slopes); d(slopes) = alpha_u alpha_v r dr dphi.
            const double density = d.density(m.cast<float>());
            sum += g(m) * (density * m.z() * m.z() * m.z() * area * r / sqr(1 - t));
        }
    }
    return decltype(sum)(sum * (2 * std::numbers::pi / (rings * sectors)));
}

// The integral of cos(m) D(m) over all normals is 1 (Walter et al. 2007, equation 4).
TEST(Microfacet, ProjectedAreaOfAllFacetsIsOne) {
    for (const auto& d : distributions)
        EXPECT_NEAR(normal_integral(d, [](const Vec3d& m) { return m.z(); }), 1, 1e-5) << name_of(d);
}

TEST(Microfacet, VisibleAreaIsTheIntegralOfFacingFacets) {
    for (const auto& d : distributions)
        for (double degrees : angles) {
            const Vec3d w = direction_at(degrees, 0.6).cast<double>();
            const double area = normal_integral(d, [&](const Vec3d& m) { return std::max(w.dot(m), 0.0); });
            EXPECT_NEAR(static_cast<double>(d.visible_area(w.cast<float>())) / area, 1, 2e-4) << name_of(d, degrees);
        }
}

// The expected values use Lambda in its textbook form (Heitz 2014, section 5.3; Walter et al. 2007, equation 34).
TEST(Microfacet, MaskingIsSmiths) {
    for (double degrees : {5.0, 45.0, 75.0, 88.0})
        for (double alpha : {0.05, 0.3, 1.0}) {
            const Vec3 w = direction_at(degrees, 1.1);
            const double a_tan = alpha * std::tan(degrees * std::numbers::pi / 180), a = 1 / a_tan;
            const double ggx = 2 / (1 + std::sqrt(1 + sqr(a_tan)));
            const double lambda = 0.5 * (std::exp(-a * a) / (a * std::sqrt(std::numbers::pi)) - std::erfc(a));
            const auto f = static_cast<float>(alpha);
            EXPECT_NEAR((MicrofacetDistribution{MicrofacetType::ggx, f, f}.g1(w)), ggx, 2e-6);
            EXPECT_NEAR((MicrofacetDistribution{MicrofacetType::beckmann, f, f}.g1(w)), 1 / (1 + lambda), 2e-6);
        }
    EXPECT_EQ((MicrofacetDistribution{MicrofacetType::beckmann, 0.3f, 0.3f}.g1(Vec3(0, 0, 1))), 1.f);
    EXPECT_EQ((MicrofacetDistribution{MicrofacetType::ggx, 0.3f, 0.3f}.g1(Vec3(0, 0, 1))), 1.f);
}

// The weak white furnace test (Heitz 2014, section 3.5): without shadowing, mirror facets reflect all light, though
// partly below the horizon. The test passes only if the masking function belongs to the distribution of normals.
TEST(Microfacet, PassesTheWeakWhiteFurnaceTest) {
    for (const auto& d : distributions)
        for (double degrees : {0.0, 30.0, 60.0, 80.0}) {
            if (d.alpha_u < 0.01f) continue;  // too narrow for this quadrature
            const Vec3 wo = direction_at(degrees, 0.6);
            const double sum = sphere_integral(mirrored_direction(wo), [&](const Vec3& wi) {
                const Vec3 m = (wo + wi).normalized();
                return d.density(m) / (4 * d.visible_area(wo));
            });
            EXPECT_NEAR(sum, 1, 2e-3) << name_of(d, degrees);
        }
}

// Compares the moments of the sampled normals with integrals over D.
TEST(Microfacet, SampledNormalsAreThoseThatAreVisible) {
    constexpr std::uint32_t n = 1u << 16;
    for (const auto& d : distributions)
        for (double degrees : angles) {
            const Vec3 wo = direction_at(degrees, 0.6);
            // Slopes in units of alpha, squeezed into (-1, 1).
            const auto squeezed = [&](const Vec3d& m) {
                const Vec2d s(m.x() / (m.z() * double{d.alpha_u}), m.y() / (m.z() * double{d.alpha_v}));
                return Vec2d(s / std::sqrt(1 + s.squaredNorm()));
            };
            using Moments = Eigen::Array<double, 5, 1>;
            const auto moments = [&](const Vec3d& m) {
                const Vec2d s = squeezed(m);
                return Moments(s.x(), s.y(), s.x() * s.x(), s.x() * s.y(), s.y() * s.y());
            };
            Moments sampled = Moments::Zero();
            for (std::uint32_t i = 0; i < n; ++i) {
                const Sampler u(PointSet::sobol, 5, 1, i);
                const Vec3 m = d.sample_visible(wo, u.get_2d(0));
                ASSERT_GT(wo.cast<double>().dot(m.cast<double>()), 0) << name_of(d, degrees);
                ASSERT_GT(d.density(m), 0.f);
                ASSERT_NEAR(m.norm(), 1.f, 1e-6f);
                sampled += moments(m.cast<double>()) / n;
            }
            const double area = d.visible_area(wo);
            const Moments expected = normal_integral(d, [&](const Vec3d& m) {
                return Moments(moments(m) * (std::max(wo.cast<double>().dot(m), 0.0) / area));
            });
            EXPECT_LT((sampled - expected).abs().maxCoeff(), 3e-4)
                << name_of(d, degrees) << ": " << sampled.transpose() << " for " << expected.transpose();
        }
}

TEST(Microfacet, NoFacetFacesDownAndNoRoughnessIsZero) {
    const MicrofacetDistribution d{MicrofacetType::ggx, 0.f, 0.f};
    EXPECT_EQ(d.density(Vec3(0, 0, 1)),
              (MicrofacetDistribution{MicrofacetType::ggx, 1e-4f, 1e-4f}.density(Vec3(0, 0, 1))));
    for (auto type : {MicrofacetType::beckmann, MicrofacetType::ggx}) {
        const MicrofacetDistribution rough{type, 1.f, 1.f};
        EXPECT_EQ(rough.density(Vec3(0.6f, 0.f, -0.8f)), 0.f);
        EXPECT_EQ(rough.density(Vec3(1.f, 0.f, 0.f)), 0.f);
        EXPECT_EQ(rough.density(Vec3(1.f, 0.f, 1e-20f)),
                  type == MicrofacetType::ggx ? rough.density(Vec3(1.f, 0.f, 1e-10f)) : 0.f);
    }
}

RoughConductor mirror(const MicrofacetDistribution& d) { return {{}, d}; }
RoughDielectric glass(const MicrofacetDistribution& d, float eta = 1.5f) { return {eta, 0.f, d}; }

// Checks the table at the head of common/materials/rough_scattering.h: the share of light
// [percent] that single scattering loses.
TEST(RoughScattering, LosesTheTabulatedShareOfLight) {
    struct Row {
        float alpha;
        std::array<double, 20>
            lost;  // dielectric: beckmann, ggx; conductor: beckmann, ggx; each at 0, 30, 60, 80, 89 degrees
    };
    const std::vector<Row> rows = {
        {0.01f, {0.0, 0.0, 0.0, 0.0, 5.8, 0.0, 0.0, 0.0, 0.1, 9.2, 0.0, 0.0, 0.0, 0.0, 6.1, 0.0, 0.0, 0.0, 0.2, 9.9}},
        {0.1f, {0.0, 0.0, 0.0, 3.9, 4.3, 0.1, 0.2, 0.8, 5.8, 7.7, 0.0, 0.0, 0.0, 6.2, 5.0, 1.2, 1.4, 3.1, 10.8, 8.8}},
        {0.2f, {0.0, 0.0, 0.7, 5.6, 3.3, 0.5, 0.8, 2.8, 8.7, 11.8, 0.0, 0.0, 2.8, 9.2, 4.3, 5.2, 6.1, 10.6, 15.2, 9.9}},
        {0.3f,
         {0.0, 0.1, 2.1, 5.0, 2.9, 1.2, 1.7, 5.3, 12.5, 19.3, 0.0, 0.9, 7.7, 8.8, 4.2, 12.3, 13.7, 18.2, 17.9, 12.4}},
        {0.5f,
         {0.3, 0.9, 3.7, 4.8, 4.7, 3.2, 4.6, 11.8, 24.8, 36.6, 5.7, 9.7, 13.1, 8.2, 4.4, 31.2, 31.9, 31.4, 25.3, 19.4}},
        {0.7f, {1.3,  2.3,  4.8,  8.9, 12.8, 5.9,  8.3,  19.9, 38.1, 51.5,
                25.1, 23.4, 16.5, 8.8, 5.2,  49.7, 48.6, 43.4, 34.3, 27.5}},
        {1.f, {3.3,  4.6,  9.4,  21.0, 29.8, 10.7, 15.1, 32.8, 54.1, 67.0,
               53.9, 45.2, 24.4, 12.0, 7.7,  69.3, 67.1, 59.1, 47.7, 39.7}},
    };
    constexpr std::array<double, 5> degrees = {0, 30, 60, 80, 89};
    for (const Row& row : rows)
        for (std::size_t k = 0; k < 20; ++k) {
            const MicrofacetDistribution d{microfacet_types[k / 5 % 2], row.alpha, row.alpha};
            const Vec3 wo = direction_at(degrees[k % 5], 0.4);
            const double kept = k < 10 ? sampled_share(glass(d), wo).weight : sampled_share(mirror(d), wo).weight;
            EXPECT_NEAR(100 - 100 * kept, row.lost[k], 0.2)
                << name_of(d, degrees[k % 5]) << (k < 10 ? " glass" : " metal");
        }
}

TEST(RoughScattering, TendsToTheSmoothModel) {
    for (auto type : microfacet_types)
        for (double degrees : {0.0, 30.0, 60.0, 80.0}) {
            const MicrofacetDistribution d{type, 1e-3f, 1e-3f};
            const Vec3 up = direction_at(degrees, 0.4);
            for (float side : {1.f, -1.f}) {
                const Vec3 wo(up.x(), up.y(), side * up.z());
                EXPECT_NEAR(sampled_share(glass(d), wo).weight, 1, 1e-3) << name_of(d, degrees);
                RoughDielectric reflecting = glass(d);
                reflecting.specular_transmittance = Color::Zero();
                EXPECT_NEAR(sampled_share(reflecting, wo).weight, fresnel_dielectric(wo.z(), 1.5f).reflectance, 1e-3)
                    << name_of(d, degrees) << " side " << side;
            }
            const ConductorIndex gold{Color(0.2f, 0.9f, 1.5f), Color(3.f, 2.f, 2.f)};
            EXPECT_NEAR(sampled_share(RoughConductor{gold, d}, up).weight,
                        fresnel_conductor(up.z(), gold.eta, gold.k)[0], 1e-3);
            // The light goes close to the directions of the smooth interface.
            const auto reflected = glass(d).sample_local(up, 0.f, {0.3f, 0.3f}, Transport::radiance, Lobes::all);
            const auto refracted = glass(d).sample_local(up, 0.999f, {0.3f, 0.3f}, Transport::radiance, Lobes::all);
            ASSERT_TRUE(reflected && refracted);
            EXPECT_LT((reflected->wi - mirrored_direction(up)).norm(), 5e-3f);
            EXPECT_LT((refracted->wi.head<2>() + up.head<2>() / 1.5f).norm(), 5e-3f);
            EXPECT_EQ(refracted->eta, 1.5f);
            EXPECT_EQ(reflected->eta, 1.f);
        }
}

TEST(RoughScattering, AnInterfaceWithoutAnIndexChangesNothing) {
    const RoughDielectric none = glass({MicrofacetType::ggx, 0.5f, 0.5f}, 1.f);
    EXPECT_TRUE(none.traits().delta);
    EXPECT_FALSE(none.traits().rough || none.traits().glossy || none.traits().diffuse || none.traits().refraction);
    for (double degrees : {0.0, 50.0, 89.999, 130.0}) {
        const Vec3 wo = direction_at(degrees, 1);
        const auto s = none.sample_local(wo, 0.5f, {0.2f, 0.7f}, Transport::radiance, Lobes::all);
        ASSERT_TRUE(s && s->delta);
        EXPECT_EQ(s->wi, Vec3(-wo));
        EXPECT_NEAR(s->f[0] * std::abs(wo.z()) / s->pdf_w, 1.f, 1e-6f);
        EXPECT_EQ(none.pdf_w_local(wo, -wo, Lobes::all), 0.f);
        EXPECT_TRUE(is_black(f_of(none, wo, -wo)));
        EXPECT_FALSE(none.sample_local(wo, 0.5f, {0.2f, 0.7f}, Transport::radiance, Lobes::diffuse));
    }
    // An index close to 1, which is not a special case of the code, gives nearly the same.
    for (float eta : {1.f + 1e-6f, 1.f - 1e-6f, 1.001f})
        EXPECT_NEAR(sampled_share(glass({MicrofacetType::ggx, 0.1f, 0.1f}, eta), direction_at(40, 1)).weight, 1, 5e-3)
            << eta;
}

TEST(RoughScattering, ItsLobeIsDiffuseOrSpecularByTheLargerRoughness) {
    const Vec3 wo = direction_at(30, 0), wi = direction_at(30, 3.1);
    const auto check = [&](const auto& model, LobeKind kind) {
        const bool diffuse = kind == LobeKind::diffuse;
        EXPECT_EQ(model.traits().diffuse, diffuse);
        EXPECT_EQ(model.traits().glossy, !diffuse);
        EXPECT_TRUE(model.traits().rough);
        EXPECT_FALSE(model.traits().delta);
        const Lobes own = diffuse ? Lobes::diffuse : Lobes::specular,
                    other = diffuse ? Lobes::specular : Lobes::diffuse;
        EXPECT_GT(model.f_local(wo, wi, Transport::radiance).of(own)[0], 0.f);
        EXPECT_EQ(model.f_local(wo, wi, Transport::radiance).of(other)[0], 0.f);
        EXPECT_EQ(model.pdf_w_local(wo, wi, own), model.pdf_w_local(wo, wi, Lobes::all));
        EXPECT_EQ(model.pdf_w_local(wo, wi, other), 0.f);
        EXPECT_FALSE(model.sample_local(wo, 0.2f, {0.3f, 0.3f}, Transport::radiance, other));
        EXPECT_EQ(model.sample_local(wo, 0.2f, {0.3f, 0.3f}, Transport::radiance, own)->lobe, kind);
        EXPECT_GT(model.coefficients_local(wo).of(own)[0], 0.f);
        EXPECT_EQ(model.coefficients_local(wo).of(other)[0], 0.f);
    };
    const MicrofacetDistribution narrow{MicrofacetType::ggx, 0.1f, 0.05f}, wide{MicrofacetType::ggx, 0.05f, 0.11f};
    check(mirror(narrow), LobeKind::specular);
    check(mirror(wide), LobeKind::diffuse);
    check(glass(narrow), LobeKind::specular);
    check(glass(wide), LobeKind::diffuse);
    EXPECT_TRUE(glass(wide).traits().refraction && glass(wide).traits().transmission);
    RoughConductor black = mirror(wide);
    black.specular_reflectance = Color::Zero();
    EXPECT_FALSE(black.traits().scatters());
}

TEST(RoughScattering, AConductorHasNoBackAndADielectricIsTheInverseOneFromBehind) {
    const MicrofacetDistribution d{MicrofacetType::beckmann, 0.4f, 0.2f};
    const Vec3 up = direction_at(30, 0.3), up2 = direction_at(50, 2.0), down = behind(up), down2 = behind(up2);
    EXPECT_TRUE(is_black(f_of(mirror(d), down, down2)));
    EXPECT_EQ(mirror(d).pdf_w_local(down, down2, Lobes::all), 0.f);
    EXPECT_FALSE(mirror(d).sample_local(down, 0.5f, {0.5f, 0.5f}, Transport::radiance, Lobes::all));
    EXPECT_EQ(mirror(d).coefficients_local(down).of(Lobes::all)[0], 0.f);
    const RoughDielectric in = glass(d, 1.5f), out = glass(d, 1.f / 1.5f);
    EXPECT_NEAR(f_of(in, down, down2)[0], f_of(out, up, up2)[0], 1e-6f);
    EXPECT_NEAR(f_of(in, down, up2)[0], f_of(out, up, down2)[0], 1e-5f);
}

}  // namespace
}  // namespace gib::test::rough_scattering_test
