// Tests of the distributions of microfacets: their normalisation, masking, sampling and Jacobians.

#include "common/materials/microfacet.h"

#include "tests/common/materials/scattering_fixtures.h"

#include <gtest/gtest.h>

namespace gib::test::microfacet_test {
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
    const double area = static_cast<double>(d.alpha_u) * static_cast<double>(d.alpha_v);
    decltype(g(Vec3d())) sum = 0 * g(Vec3d(0, 0, 1));
    for (int i = 0; i < rings; ++i) {
        const double t = (i + 0.5) / rings, r = t / (1 - t);
        for (int j = 0; j < sectors; ++j) {
            const double phi = 2 * std::numbers::pi * (j + 0.5) / sectors;
            const Vec3d m = Vec3d(-static_cast<double>(d.alpha_u) * r * std::cos(phi),
                                  -static_cast<double>(d.alpha_v) * r * std::sin(phi), 1)
                                .normalized();
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
                const Vec2d s(m.x() / (m.z() * static_cast<double>(d.alpha_u)),
                              m.y() / (m.z() * static_cast<double>(d.alpha_v)));
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

TEST(Microfacet, CornersOfTheUnitSquareGiveFiniteNormals) {
    const float last = 1.f - unit_roundoff;
    for (const auto& d : distributions)
        for (double degrees : {0.0, 1e-4, 45.0, 89.999, 90.0})
            for (float x : {0.f, unit_roundoff, 0.5f, last})
                for (float y : {0.f, unit_roundoff, 0.5f, last}) {
                    Vec3 wo = direction_at(degrees, 2.0);
                    wo.z() = std::max(wo.z(), 1e-30f);
                    const Vec3 m = d.sample_visible(wo, {x, y});
                    ASSERT_TRUE(m.allFinite()) << name_of(d, degrees) << ' ' << x << ' ' << y;
                    EXPECT_GE(m.z(), 0.f);
                    EXPECT_TRUE(std::isfinite(d.density(m)));
                    EXPECT_GT(d.visible_area(wo), 0.f);
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

TEST(Facet, MirrorsAndRefractsWithTheJacobianOfItsNormal) {
    const Vec3 wo = direction_at(50, 0.3);
    const auto angle_ratio = [](auto&& normal_of, const Vec3& wi) {
        // The area that two small turns of wi span on the sphere of normals.
        const Frame frame(wi);
        constexpr float h = 2e-3f;
        const auto turned = [&](float a, float b) {
            return normal_of(Vec3((wi + a * frame.s + b * frame.t).normalized()));
        };
        const Vec3 du = (turned(h, 0) - turned(-h, 0)) / (2 * h), dv = (turned(0, h) - turned(0, -h)) / (2 * h);
        return du.cross(dv).norm();
    };
    const Vec3 up = direction_at(20, 2.5);
    const Facet mirror = reflecting_facet(wo, up);
    EXPECT_NEAR(mirror.cos_o, mirror.cos_i, 1e-6f);
    EXPECT_LT((2 * mirror.cos_o * mirror.m - wo - up).norm(), 1e-6f);
    EXPECT_NEAR(angle_ratio([&](const Vec3& wi) { return reflecting_facet(wo, wi).m; }, up) * mirror.cos_o,
                mirror.jacobian, 1e-4f);
    for (float eta : {1.5f, 1 / 1.5f, 1.001f}) {
        const Vec3 down = (-wo / eta + 0.01f * (eta - 1) * Vec3(1, 2, 0) - Vec3(0, 0, (eta - 1) * 0.3f)).normalized();
        const auto facet = refracting_facet(wo, down, eta);
        ASSERT_TRUE(facet) << eta;
        // Snell's law: the tangential components of the two directions, each times its index, cancel.
        EXPECT_LT((wo + eta * down).cross(facet->m).norm(), 1e-5f);
        EXPECT_NEAR(wo.dot(facet->m), facet->cos_o, 1e-5f);
        EXPECT_NEAR(-down.dot(facet->m), facet->cos_i, 1e-5f);
        if (eta == 1.001f) continue;  // the turns are too large for facets that turn a thousand times as fast
        const float ratio = angle_ratio([&](const Vec3& wi) { return refracting_facet(wo, wi, eta).value().m; }, down);
        EXPECT_NEAR(ratio * facet->cos_o / facet->jacobian, 1.f, 2e-3f) << eta;
    }
    EXPECT_FALSE(refracting_facet(wo, direction_at(95, 0.3), 1.5f));
}

}  // namespace
}  // namespace gib::test::microfacet_test
