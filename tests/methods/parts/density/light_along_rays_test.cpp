// Look-ups around an eye's ray, against the light of a point scattered once, which is an integral along the ray.

#include "methods/parts/density/light_along_rays.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <gtest/gtest.h>

#include <numbers>

namespace gib::light_along_rays_test {
namespace {

using namespace test;

constexpr double sigmas = 5;  ///< allowed errors, in standard errors: false alarm below 1e-6 a comparison
constexpr double sigma_t = 1, albedo = 0.8;
constexpr float offset = 0.4f;  ///< of the ray from the light

/// A point light of intensity 1 in the middle of a cube [-1, 1]^3 of fog.
LoadedScene lit_fog() {
    return scene_of(scene_xml(camera(40, to_world(translate(0, 0, -4)), box_film(4)) + point_light(0, 0, 0, 1) +
                              shape("cube", bsdf("null"), "<medium name='interior' type='homogeneous'>",
                                    number("sigma_t", sigma_t), number("albedo", albedo), "</medium>")));
}

/// Light that the fog scatters once into the ray at the distance `offset`: the integral over z of sigma_s / (4 pi) exp(-sigma_t rho)
/// / rho^2 exp(-sigma_t (1 + z)).
double scattered_once() {
    constexpr int steps = 20000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double z = -1 + (i + 0.5) * 2 / steps, rho = std::hypot(z, double{offset});
        sum += std::exp(-sigma_t * (rho + 1 + z)) / (rho * rho) * 2 / steps;
    }
    return albedo * sigma_t / (4 * std::numbers::pi) * sum;
}

struct Settings {
    VolumeLookUp look_up;
    Kernel kernel;
    float radius;
    std::uint64_t photons, seeds;
};

/// The radiance that the fog around the origin shows on the way of length 2 `half`, over seeds and over 24 rays that see the
/// same: along all axes both ways, at this distance from the middle on all sides. Few photons come close to two of them.
Moments found(const LoadedScene& scene, float distance, float half, int max_edges, const Settings& s) {
    RayQueries rays(*scene.scene);
    const FlatRegions regions(*scene.scene, 32);
    const Sampler sampler(PointSet::independent, 1, 1, 0);
    NumberStream u(sampler);
    std::vector<std::uint32_t> scratch;
    Moments moments;
    for (std::uint64_t seed = 1; seed <= s.seeds; ++seed) {
        const auto kind = s.look_up == VolumeLookUp::beams ? PhotonMapKind::beams : PhotonMapKind::media;
        const LightAlongRays light(trace_photons(*scene.scene, kind, s.photons, max_edges, seed), s.kernel,
                                   {s.radius, s.radius}, regions);
        for (int along = 0; along < 6; ++along)
            for (int side = 0; side < 4; ++side) {
                const float way = along % 2 == 0 ? half : -half, by = side % 2 == 0 ? distance : -distance;
                const Vec3 middle = by * Vec3::Unit((along / 2 + 1 + side / 2) % 3);
                const Vec3 from = middle - way * Vec3::Unit(along / 2), w = (middle - from).normalized();
                const Medium* medium = rays.medium_at(middle);
                const MediumStretch stretch{*medium, from, w, 2 * half,
                                            medium->transmittance_along(from, w, 2 * half, u)};
                moments.add(double{light.radiance(stretch, {max_edges - 1}, rays, scratch).radiance[1]});
            }
    }
    return moments;
}
Moments found_by_point_light(const Settings& s) { return found(lit_fog(), offset, 1, 2, s); }

class LookUpsAlongRays : public testing::TestWithParam<VolumeLookUp> {};
INSTANTIATE_TEST_SUITE_P(All, LookUpsAlongRays, testing::Values(VolumeLookUp::ray, VolumeLookUp::beams),
                         [](const auto& look_up) {
                             return std::string(volume_look_up_names[static_cast<std::size_t>(look_up.param)]);
                         });

TEST_P(LookUpsAlongRays, HaveTheMeanOfTheIntegralWithEveryKernel) {
    for (const Kernel kernel : {Kernel::uniform, Kernel::cone, Kernel::gaussian, Kernel::epanechnikov}) {
        const Moments m = found_by_point_light({GetParam(), kernel, 0.05f, 4000, 12});
        EXPECT_LT(m.standard_error(), 0.04 * scattered_once()) << "the test would not see an error";
        EXPECT_NEAR(m.mean(), scattered_once(), sigmas * m.standard_error() + 0.002 * scattered_once());
    }
}

// Half the radius leaves a quarter of the bias; the variance doubles for beams, which blur along one dimension, and grows
// fourfold for photons, which blur along two. A fourth of the photons has four times the variance. Each logarithm of a ratio of
// variances over n samples has the standard error sqrt(2 (kurtosis - 1) / n); 3 stands for the kurtosis.
TEST_P(LookUpsAlongRays, BiasAndVarianceFollowTheRadiusAndThePhotons) {
    constexpr std::uint64_t seeds = 80, samples = 24 * seeds;
    const double truth = scattered_once();
    const Moments wide = found_by_point_light({GetParam(), Kernel::uniform, 0.2f, 2000, seeds}),
                  narrow = found_by_point_light({GetParam(), Kernel::uniform, 0.1f, 2000, seeds}),
                  few = found_by_point_light({GetParam(), Kernel::uniform, 0.2f, 500, seeds});
    const double bias = wide.mean() - truth;
    EXPECT_GT(std::abs(bias), sigmas * wide.standard_error()) << "the test would not see an error";
    EXPECT_NEAR(narrow.mean() - truth, bias / 4,
                sigmas * std::hypot(narrow.standard_error(), wide.standard_error() / 4) + 0.15 * std::abs(bias) / 4);
    const double log_error = sigmas * std::sqrt(2 * 2.0 / samples);
    const auto variance = [](const Moments& m) { return samples * m.standard_error() * m.standard_error(); };
    const double dimensions = GetParam() == VolumeLookUp::beams ? 1 : 2;
    EXPECT_NEAR(std::log2(variance(narrow) / variance(wide)), dimensions, log_error / std::numbers::ln2 + 0.1);
    EXPECT_NEAR(std::log(variance(few) / variance(wide)), std::log(4), log_error);
}

// A ball of white fog around a white cube under an even sky has the radiance 1 everywhere, so that the fog shows the share of light
// that it takes away. Most of a look-up's line lies beyond the ball or in the cube.
TEST_P(LookUpsAlongRays, EvenLightStaysEvenNearSurfacesAndTheEdgeOfTheMedium) {
    const LoadedScene scene =
        scene_of(scene_xml(camera(40, to_world(translate(0, 0, -4)), box_film(4)) + constant_light(1) +
                           shape("cube", to_world(scale(0.3)), diffuse(1)) +
                           shape("sphere", bsdf("null"), "<medium name='interior' type='homogeneous'>",
                                 number("sigma_t", sigma_t), number("albedo", 1), "</medium>")));
    constexpr float radius = 0.3f;
    for (const float distance : {0.32f, 0.95f})
        for (const Kernel kernel : {Kernel::uniform, Kernel::cone, Kernel::gaussian, Kernel::epanechnikov}) {
            const float half = std::sqrt(1 - distance * distance);
            const double shown = -std::expm1(-2 * sigma_t * double{half});
            const Moments m = found(scene, distance, half, 1000, {GetParam(), kernel, radius, 1000, 12});
            EXPECT_LT(m.standard_error(), 0.03 * shown) << "the test would not see an error";
            EXPECT_NEAR(m.mean(), shown, sigmas * m.standard_error()) << distance;
        }
}

}  // namespace
}  // namespace gib::light_along_rays_test
