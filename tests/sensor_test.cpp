#include "common/sensor.h"
#include "common/sampler.h"

#include <gtest/gtest.h>

namespace gib {
namespace {

Sensor::Parameters square(int pixels) {
    Sensor::Parameters p;
    p.width = p.height = pixels;
    p.fov = 90;
    p.filter = ReconstructionFilter::box(0.5f);
    return p;
}

// Mitsuba adds the offset to film positions: the optical axis is where position + offset = 1/2.
TEST(Sensor, PrincipalPointOffsetMovesTheAxisTheOtherWay) {
    auto p = square(4);
    p.principal_point_offset = Vec2d(0.25, -0.25);
    const Sensor sensor(p);
    const Ray axis = sensor.generate_ray(1, 3, {0.f, 0.f});  // the corner between pixels (0, 2) and (1, 3)
    EXPECT_NEAR(axis.d.x(), 0.f, 1e-6f);
    EXPECT_NEAR(axis.d.y(), 0.f, 1e-6f);
    // Film x grows to the right, camera x to the left; film y grows down, camera y up.
    const Ray right_below = sensor.generate_ray(2, 3, {0.5f, 0.5f});
    EXPECT_LT(right_below.d.x(), 0.f);
    EXPECT_LT(right_below.d.y(), 0.f);
}

TEST(Sensor, FilmSpansTheFieldOfView) {
    const Sensor sensor(square(8));
    const Ray corner = sensor.generate_ray(0, 0, {0.f, 0.f});
    EXPECT_NEAR(corner.d.x() / corner.d.z(), 1.f, 1e-6f);  // tan 45 degrees
    EXPECT_NEAR(corner.d.y() / corner.d.z(), 1.f, 1e-6f);
    EXPECT_NEAR(corner.d.norm(), 1.f, 1e-6f);
}

TEST(Sensor, ClipDistancesCountAlongTheAxis) {
    auto p = square(8);
    p.near_clip = 2;
    p.far_clip = 10;
    const Ray corner = Sensor(p).generate_ray(0, 0, {0.f, 0.f});
    EXPECT_NEAR(corner.t_min * corner.d.z(), 2.f, 1e-5f);
    EXPECT_NEAR(corner.t_max * corner.d.z(), 10.f, 1e-4f);
}

// Offsets are distributed like the filter: its second moment in closed form, the cut at 4 deviations and the shift included.
TEST(ReconstructionFilter, GaussianSamplesHaveItsMoments) {
    const double sigma = 0.5, r = 4 * sigma, cut = std::exp(-8.0), root = sigma * std::sqrt(2 * std::numbers::pi);
    const double mass = root * std::erf(r / (sigma * std::sqrt(2.0))) - cut * 2 * r;
    const double second =
        sigma * sigma * (root * std::erf(r / (sigma * std::sqrt(2.0))) - 2 * r * cut) - cut * 2 * r * r * r / 3;
    const auto filter = ReconstructionFilter::gaussian(0.5f);
    double mean = 0, square_mean = 0;
    constexpr std::uint32_t n = 1 << 16;
    for (std::uint32_t i = 0; i < n; ++i) {
        const Vec2 x = filter.sample(Sampler(PointSet::sobol, 1, 0, i).get_2d(0));
        EXPECT_LE(x.cwiseAbs().maxCoeff(), 2.f);
        mean += static_cast<double>(x.x());
        square_mean += static_cast<double>(x.y() * x.y());
    }
    EXPECT_NEAR(mean / n, 0.0, 1e-3);
    EXPECT_NEAR(square_mean / n, second / mass, 1e-3 * second / mass);
}

}  // namespace
}  // namespace gib
