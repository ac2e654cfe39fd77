// Kernels and density estimates on surfaces and in media: bias, variance, and which photons count.
#include "methods/parts/density/density_estimate.h"
#include "methods/parts/density/surface_disc.h"
#include "methods/parts/density/volume_estimate.h"
#include "tests/methods/parts/density/density_fixtures.h"

#include <iostream>

namespace gib::test::density_estimate_test {
namespace {

constexpr double pi_d = std::numbers::pi;

TEST(Kernel, EachIntegratesToOneOverItsDisc) {
    for (std::size_t i = 0; i < kernel_names.size(); ++i) {
        const auto kernel = static_cast<Kernel>(i);
        const double r = 2.5;
        double integral = 0;
        constexpr int n = 200000;
        for (int j = 0; j < n; ++j) {
            const double d = r * (j + 0.5) / n;
            integral += static_cast<double>(kernel_weight(kernel, static_cast<float>(d * d), static_cast<float>(r))) *
                        2 * std::numbers::pi * d * r / n;
            if (j % 20000 == 0) {
                EXPECT_NEAR(kernel_mass(kernel, static_cast<float>(d / r)), integral, 2e-4) << kernel_names[i];
            }
        }
        EXPECT_NEAR(integral, 1, 1e-4) << kernel_names[i];
        for (float u : {0.f, 0.01f, 0.3f, 0.5f, 0.9f, 1.f})
            EXPECT_NEAR(kernel_mass(kernel, kernel_radius(kernel, u)), u, 1e-5f) << kernel_names[i];
    }
}

/// The estimate relative to the truth on a square with evenly spread photons of 1 [W/area]. Look-ups are so far apart
/// that no two discs overlap.
Moments on_even_photons(const DensityEstimator& estimator, std::uint64_t look_ups) {
    static const LoadedScene scene = scene_of_shapes(white("rectangle", scale(2)));
    constexpr std::size_t n = 20000;
    const float spacing = 2.5f * std::sqrt(static_cast<float>(estimator.k) / (pi * n));
    const auto per_side = static_cast<std::size_t>(1.f / spacing) - 1;
    std::vector<Ray> eyes;
    for (std::size_t i = 0; i < per_side * per_side; ++i)
        eyes.push_back(down_at(static_cast<float>(i % per_side + 1) / static_cast<float>(per_side + 1),
                               static_cast<float>(i / per_side + 1) / static_cast<float>(per_side + 1)));
    return relative_estimates(*scene.scene, {estimator}, look_ups / eyes.size() + 1, 1.0,
                              [](std::uint64_t seed) {
                                  std::vector<Photon> photons;
                                  spread(photons, n, Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), 1.f,
                                         seed);
                                  return photons;
                              },
                              {eyes})[0][0];
}

// For k = 5 the variance of one look-up is 4/3 (1 + v / 4) - 1, where v is the variance of a kernel's weights: 0,
// 1/2, 0.313 and 1/3. It is at most 0.5, so 6e5 look-ups in hundreds of independent maps have a standard error below
// 0.001. The whole disc lies on the surface, which `surface` must find.
TEST(DensityEstimate, EveryKernelIsUnbiasedOnUniformPhotons) {
    const std::array variance = {1. / 3, 0.5, 4. / 3 * (1 + 0.313 / 4) - 1, 4. / 3 * (1 + 1. / 12) - 1};
    for (std::size_t i = 0; i < kernel_names.size(); ++i)
        for (DiscArea area : {DiscArea::plain, DiscArea::surface}) {
            SCOPED_TRACE(kernel_names[i]);
            const Moments found = on_even_photons({static_cast<Kernel>(i), 5, 1.f, area}, 600000);
            EXPECT_GE(found.count(), 300000u);
            EXPECT_NEAR(found.mean(), 1.0, 0.003);
            EXPECT_NEAR(found.standard_error() * std::sqrt(static_cast<double>(found.count())), std::sqrt(variance[i]),
                        0.03);
        }
}

/// A white square with few photons around its middle.
struct FewPhotons {
    LoadedScene scene = scene_of_shapes(white("rectangle", scale(2)));
    RayQueries rays{*scene.scene};

    float radiance(const DensityEstimator& e, const std::vector<Photon>& photons, int max_edges = 100) {
        const Ray eye = down_at(0, 0);
        return e
            .reflected_radiance(PhotonMap(photons, 1), rays, *scene.scene->intersect(eye), -eye.d, EyePath{max_edges},
                                Sampler(PointSet::independent, 1, 0, 0), 0)
            .between_surfaces[0];
    }
};

const Vec3 up(0, 0, 1);

TEST(DensityEstimate, FewerThanKPhotonsAreDividedByTheLargestDisc) {
    const std::vector<Photon> photons = {photon_at(Vec3(0.1f, 0, 0), up, 1), photon_at(Vec3(0, -0.2f, 0), up, 1),
                                         photon_at(Vec3(1.5f, 0, 0), up, 1)};
    for (std::size_t k : {std::size_t{10}, all_photons})
        EXPECT_NEAR(FewPhotons().radiance({Kernel::uniform, k, 0.5f, DiscArea::plain}, photons),
                    2.f / (pi * 0.25f) / pi, 1e-6f);
}

TEST(DensityEstimate, PhotonsOfTooLongPathsDoNotCount) {
    std::vector<Photon> photons;
    spread(photons, 1000, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), up, 1.f, 1);
    for (DiscArea area : {DiscArea::surface, DiscArea::plain})
        for (std::size_t k : {std::size_t{10}, all_photons}) {
            FewPhotons few;
            const DensityEstimator e{Kernel::uniform, k, 0.5f, area};
            EXPECT_GT(few.radiance(e, photons, 2), 0.f);
            EXPECT_EQ(few.radiance(e, photons, 1), 0.f);
        }
}

// A look-up begins with the ball that the one before has found. That one counted twice as many photons, so that the ball
// holds too few for this one.
TEST(DensityEstimate, DoesNotDependOnTheLookUpsBefore) {
    std::vector<Photon> photons;
    spread(photons, 1000, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), up, 1.f, 1);
    for (std::size_t i = 0; i < photons.size(); i += 2)
        photons[i].edges = 5;
    const PhotonMap map(photons, 1);
    FewPhotons few;
    const Ray eye = down_at(0, 0);
    const SurfaceHit hit = *few.scene.scene->intersect(eye);
    const DensityEstimator e{Kernel::uniform, 50, 0.9f, DiscArea::plain};
    const auto radiance = [&](int max_edges, LastLookUp* last) {
        return e
            .reflected_radiance(map, few.rays, hit, -eye.d, EyePath{max_edges}, Sampler(PointSet::independent, 1, 0, 0),
                                0, last)
            .between_surfaces[0];
    };
    LastLookUp last;
    EXPECT_GT(radiance(100, &last), 1.5f * radiance(2, nullptr));
    EXPECT_LT(last.radius, 0.5f);
    EXPECT_FLOAT_EQ(radiance(2, &last), radiance(2, nullptr));
}

// The bound of the normals' ratio loses the share sin^2(delta) / 200 of even light, to second order in delta. Without
// the bound nothing would be lost, because |wi.ns| integrates to pi over every hemisphere.
TEST(DensityEstimate, TheBoundOfTheNormalsRatioLosesWhatItsCommentSays) {
    const LoadedScene scene = scene_of_shapes(white("rectangle", scale(2)));
    SurfaceHit hit = *scene.scene->intersect(down_at(0, 0));
    for (const double degrees : {5.0, 10.0, 30.0, 45.0}) {
        const double delta = degrees * std::numbers::pi / 180;
        hit.ns = Vec3(static_cast<float>(std::sin(delta)), 0, static_cast<float>(std::cos(delta)));
        double E = 0;
        constexpr int rings = 16000, steps = 100;
        for (int i = 0; i < rings; ++i) {
            // More rings near the horizon, where the bound acts: z = v^2.
            const double v = (i + 0.5) / rings, z = v * v;
            for (int j = 0; j < steps; ++j) {
                const double phi = 2 * std::numbers::pi * (j + 0.5) / steps, s = std::sqrt(1 - z * z);
                const Vec3 wi = Vec3d(s * std::cos(phi), s * std::sin(phi), z).cast<float>();
                E += static_cast<double>(shading_normal_factor(hit, wi)) * z * 2 * v / rings * 2 * std::numbers::pi /
                     steps;
            }
        }
        const double expected = std::pow(std::sin(delta), 2) / 200;
        EXPECT_NEAR(1 - E / std::numbers::pi, expected, 0.1 * expected + 1e-6) << degrees;
    }
}

constexpr std::array kernels = {Kernel::uniform, Kernel::cone, Kernel::gaussian, Kernel::epanechnikov};

/// The integral of a kernel for the radius r over the ball of radius s.
double ball_share(Kernel kernel, float s, float r) {
    double share = 0;
    constexpr int steps = 20000;
    for (int i = 0; i < steps; ++i) {
        const double d = static_cast<double>(s) * (i + 0.5) / steps;
        share += 4 * pi_d * d * d * static_cast<double>(ball_kernel_weight(kernel, static_cast<float>(d * d), r)) *
                 static_cast<double>(s) / steps;
    }
    return share;
}

TEST(BallKernel, IntegratesToOneOverTheBall) {
    for (const Kernel kernel : kernels)
        for (const float r : {1e-3f, 1.f, 70.f})
            EXPECT_NEAR(ball_share(kernel, r, r), 1, 1e-4) << static_cast<int>(kernel) << ' ' << r;
}

TEST(BallKernel, RadiusIsTheInverseOfItsShare) {
    for (const Kernel kernel : kernels)
        for (int j = 0; j <= 8; ++j)
            EXPECT_NEAR(ball_share(kernel, ball_kernel_radius(kernel, static_cast<float>(j) / 8), 1), j / 8.0, 1e-4)
                << static_cast<int>(kernel);
}

/// A camera in a plane z = 0 without an end.
const LoadedScene& large_plane() {
    static const auto scene =
        Scene(element("sensor", "perspective", box_film(4)), shape("rectangle", to_world(scale(100)))).load();
    return scene;
}

/// Photons of power 1 / count each, uniform in a cube of side 2 around (0, 0, 5), where the density is 1/8.
PhotonMap uniform_photons(std::uint64_t seed, std::size_t count) {
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < count; ++i) {
        const Sampler u(PointSet::independent, seed, i, 0);
        const Vec2 a = u.get_2d(0);
        const Vec3 p(2 * a.x() - 1, 2 * a.y() - 1, 4 + 2 * u.get_1d(1));
        photons.emplace_back(p, Color::Constant(1.f / static_cast<float>(count)), Vec3::UnitZ(), Vec3::UnitZ(), 2,
                             true);
    }
    return PhotonMap(std::move(photons), 1);
}

// The k-th photon lies on the rim: if k photons counted as inside, the density would be too large by the factor k /
// (k - 1), 25 % for k = 5. One look-up has a relative deviation of 1 / sqrt(k - 2) for the uniform kernel, and
// somewhat more for the others.
TEST(VolumeEstimate, HasTheDensityOfUniformPhotonsForEveryKernel) {
    const PhaseFunction isotropic;
    for (const Kernel kernel : kernels) {
        Moments means;  // one for each map, because look-ups in one map share its photons
        for (std::uint64_t seed = 1; seed <= 32; ++seed) {
            const PhotonMap map = uniform_photons(seed, 40000);
            RayQueries rays(*large_plane().scene);
            const VolumeEstimator estimator{kernel, 5, 1.f, DiscArea::surface};
            double sum = 0;
            constexpr int look_ups = 4000;
            for (int i = 0; i < look_ups; ++i) {
                const Sampler u(PointSet::independent, seed + 1000, static_cast<std::uint64_t>(i), 0);
                const Vec2 a = u.get_2d(0);
                const Vec3 p(a.x() - 0.5f, a.y() - 0.5f, 4.5f + u.get_1d(1));
                NumberStream numbers(u);
                sum += static_cast<double>(
                    estimator.scattered_radiance(map, rays, p, isotropic, Vec3::UnitX(), EyePath{100}, numbers)
                        .radiance[0]);
            }
            means.add(sum / look_ups * 4 * pi_d * 8);
        }
        EXPECT_LT(means.standard_error(), 0.004) << "the test would not see an error";
        EXPECT_NEAR(means.mean(), 1, 5 * means.standard_error()) << kernel_names[static_cast<std::size_t>(kernel)];
    }
}

TEST(VolumeEstimate, CountsOnlyPhotonsThatAPathCanBeJoinedWith) {
    std::vector<Photon> photons;
    for (int i = 0; i < 8; ++i)
        photons.emplace_back(Vec3(0.1f * static_cast<float>(i % 2), 0.1f * static_cast<float>(i / 2), 5), Color::Ones(),
                             Vec3::UnitZ(), Vec3::UnitZ(), i + 1, true,
                             i < 4 ? std::optional<int>() : std::optional<int>(i + 10));
    const PhotonMap map(photons, 1);
    RayQueries rays(*large_plane().scene);
    const Sampler u(PointSet::independent, 1, 1, 0);
    NumberStream numbers(u);
    const VolumeEstimator estimator{Kernel::uniform, 100, 1.f, DiscArea::plain};
    const auto sum = [&](const EyePath& eye) {
        return Color(estimator.scattered_radiance(map, rays, Vec3(0, 0, 5), {}, Vec3::UnitX(), eye, numbers).radiance *
                     (4 * pi * 4 / 3 * pi));
    };
    EXPECT_NEAR(sum({100})[1], 8, 1e-4);
    EXPECT_NEAR(sum({3})[1], 3, 1e-4) << "edges";
    // Four photons were never split by wavelength. One has the eye path's stratum; it counts for all 32 strata, but
    // with only one of the two weights.
    ASSERT_GT(stratum_weight(16)[1], 0.1f);
    EXPECT_NEAR(sum({100, 16})[1], 4 + 32 / stratum_weight(16)[1], 1e-2);
    EXPECT_NEAR(sum({100, 20})[1], 4, 1e-4);
}

// At a distance d from a plane, the share (r - d)^2 (2 r + d) / (4 r^3) of a ball of radius r lies
// behind the plane. The estimate needs the reciprocal of the rest; the reciprocal of the share
// among 8 probes is 12 % too large at the wall.
TEST(VolumeEstimate, ReciprocalShareInSightIsThatOfTheBallBeforeAWall) {
    RayQueries rays(*large_plane().scene);
    for (const float d : {0.01f, 0.1f, 0.5f, 0.9f, 1.5f}) {
        Moments reciprocal;
        for (std::uint64_t i = 0; i < 20000; ++i) {
            const Sampler sampler(PointSet::independent, 7, i, 0);
            NumberStream u(sampler);
            reciprocal.add(
                static_cast<double>(reciprocal_share_in_sight(Kernel::uniform, rays, Vec3(0, 0, d), 1.f, u)));
        }
        const double x = std::min(static_cast<double>(d), 1.0);
        const double share = 1 - (1 - x) * (1 - x) * (2 + x) / 4;
        EXPECT_NEAR(reciprocal.mean(), 1 / share, 5 * reciprocal.standard_error() + 1e-6) << d;
        EXPECT_LT(reciprocal.standard_error(), 0.005);
    }
}

}  // namespace
}  // namespace gib::test::density_estimate_test
