// Kernels and the density estimate in participating media.
#include "methods/parts/density/volume_estimate.h"

#include "common/sampling/sampler.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <fmt/format.h>
#include <numbers>

namespace gib::volume_estimate_test {
namespace {

using test::Moments;

constexpr double pi_d = std::numbers::pi;
constexpr std::array kernels = {Kernel::uniform, Kernel::cone, Kernel::gaussian, Kernel::epanechnikov};

TEST(BallKernel, IntegratesToOneOverTheBall) {
    for (const Kernel kernel : kernels)
        for (const float r : {1e-3f, 1.f, 70.f}) {
            double sum = 0;
            constexpr int steps = 20000;
            for (int i = 0; i < steps; ++i) {
                const double d = static_cast<double>(r) * (i + 0.5) / steps;
                sum += 4 * pi_d * d * d *
                       static_cast<double>(ball_kernel_weight(kernel, static_cast<float>(d * d), r)) *
                       static_cast<double>(r) / steps;
            }
            EXPECT_NEAR(sum, 1, 1e-4) << static_cast<int>(kernel) << ' ' << r;
        }
}

TEST(BallKernel, RadiusIsTheInverseOfItsShare) {
    for (const Kernel kernel : kernels)
        for (int j = 0; j <= 8; ++j) {
            const float s = ball_kernel_radius(kernel, static_cast<float>(j) / 8);
            double share = 0;
            constexpr int steps = 20000;
            for (int i = 0; i < steps; ++i) {
                const double d = static_cast<double>(s) * (i + 0.5) / steps;
                share += 4 * pi_d * d * d *
                         static_cast<double>(ball_kernel_weight(kernel, static_cast<float>(d * d), 1)) *
                         static_cast<double>(s) / steps;
            }
            EXPECT_NEAR(share, j / 8.0, 1e-4) << static_cast<int>(kernel);
        }
}

const LoadedScene& empty_space() {
    static const auto scene = test::scene_of(test::scene_xml(
        "<sensor type='perspective'>" + test::box_film(4) +
        "</sensor><shape type='rectangle'><transform name='to_world'><scale value='100'/></transform></shape>"));
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
            RayQueries rays(*empty_space().scene);
            const VolumeEstimator estimator{kernel, 5, 1.f, DiscArea::surface};
            double sum = 0;
            constexpr int look_ups = 4000;
            for (int i = 0; i < look_ups; ++i) {
                const Sampler u(PointSet::independent, seed + 1000, static_cast<std::uint64_t>(i), 0);
                const Vec2 a = u.get_2d(0);
                const Vec3 p(a.x() - 0.5f, a.y() - 0.5f, 4.5f + u.get_1d(1));
                sum += static_cast<double>(
                    estimator.scattered_radiance(map, rays, p, isotropic, Vec3::UnitX(), EyePath{100}, u, 2)
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
    RayQueries rays(*empty_space().scene);
    const Sampler u(PointSet::independent, 1, 1, 0);
    const VolumeEstimator estimator{Kernel::uniform, 100, 1.f, DiscArea::plain};
    const auto sum = [&](const EyePath& eye) {
        return Color(estimator.scattered_radiance(map, rays, Vec3(0, 0, 5), {}, Vec3::UnitX(), eye, u, 0).radiance *
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
    const auto scene = test::scene_of(test::scene_xml(
        "<sensor type='perspective'>" + test::box_film(4) +
        "</sensor><shape type='rectangle'><transform name='to_world'><scale value='100'/></transform></shape>"));
    RayQueries rays(*scene.scene);
    const VolumeEstimator estimator{Kernel::uniform, 50, 1.f, DiscArea::surface};
    for (const float d : {0.01f, 0.1f, 0.5f, 0.9f, 1.5f}) {
        Moments reciprocal;
        for (std::uint64_t i = 0; i < 20000; ++i)
            reciprocal.add(static_cast<double>(estimator.reciprocal_share_in_sight(
                rays, Vec3(0, 0, d), 1.f, Sampler(PointSet::independent, 7, i, 0), 0)));
        const double x = std::min(static_cast<double>(d), 1.0);
        const double share = 1 - (1 - x) * (1 - x) * (2 + x) / 4;
        EXPECT_NEAR(reciprocal.mean(), 1 / share, 5 * reciprocal.standard_error() + 1e-6) << d;
        EXPECT_LT(reciprocal.standard_error(), 0.005);
    }
}

}  // namespace
}  // namespace gib::volume_estimate_test
