// Tests of cameras: pinhole and orthographic, thin lenses, crops and reconstruction filters.

#include "common/scene/sensor.h"
#include "common/sampling/sampler.h"

#include <gtest/gtest.h>

#include <map>

namespace gib::test::sensor_test {
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

TEST(Sensor, ClipDistancesCountAlongTheAxis) {
    auto p = square(8);
    p.near_clip = 2;
    p.far_clip = 10;
    const Ray corner = Sensor(p).generate_ray(0, 0, {0.f, 0.f});
    EXPECT_NEAR(corner.t_min * corner.d.z(), 2.f, 1e-5f);
    EXPECT_NEAR(corner.t_max * corner.d.z(), 10.f, 1e-4f);
}

Sensor::Parameters behind_a_lens() {
    auto p = square(8);
    p.fov = 60;
    p.to_world.topLeftCorner<3, 3>() = Eigen::AngleAxisd(0.7, Vec3d(1, -2, 0.5).normalized()).toRotationMatrix();
    p.to_world.topRightCorner<3, 1>() = Vec3d(3, -1, 2);
    p.aperture_radius = 0.25;
    p.focus_distance = 4;
    return p;
}

constexpr std::uint32_t lens_samples = 4096;
Vec2 lens_sample(std::uint32_t i) { return Sampler(PointSet::sobol, 1, 0, i).get_2d(dimension::lens); }

/// The point of a ray at distance z from the sensor, measured along the sensor's axis.
Vec3 at_depth(const Ray& ray, const Sensor::Parameters& p, double z) {
    const Vec3 axis = p.to_world.block<3, 1>(0, 2).cast<float>(), o = p.to_world.block<3, 1>(0, 3).cast<float>();
    return ray.o + (static_cast<float>(z) - (ray.o - o).dot(axis)) / ray.d.dot(axis) * ray.d;
}

TEST(ThinLens, RaysOfAFilmPositionMeetInThePlaneOfFocus) {
    const auto p = behind_a_lens();
    const Sensor sensor(p);
    EXPECT_TRUE(sensor.has_lens());
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(3, 4), std::pair(7, 2)}) {
        const Vec3 focus = at_depth(sensor.generate_ray(x, y, {0.3f, 0.8f}), p, p.focus_distance);
        for (std::uint32_t i = 0; i < 64; ++i) {
            const Ray ray = sensor.generate_ray(x, y, {0.3f, 0.8f}, lens_sample(i));
            EXPECT_LT((at_depth(ray, p, p.focus_distance) - focus).norm(), 1e-5f);
            EXPECT_NEAR(ray.d.norm(), 1.f, 1e-6f);
        }
    }
}

// By similar triangles, the cone from a lens of radius A to the point of focus at depth f has the radius R = A |1 - z
// / f| at depth z. Over a disc, the squared radius is uniform in [0, R^2]: its mean is R^2 / 2, its standard
// deviation R^2 / sqrt(12).
TEST(ThinLens, CircleOfConfusionIsInClosedForm) {
    const auto p = behind_a_lens();
    const Sensor sensor(p);
    for (const double z : {0.0, 1.0, 3.0, 6.0, 40.0}) {
        const double radius = p.aperture_radius * std::abs(1 - z / p.focus_distance);
        const Vec3 center = at_depth(sensor.generate_ray(1, 6, {0.5f, 0.5f}), p, z);
        double square_mean = 0, largest = 0;
        Vec3d mean = Vec3d::Zero();
        for (std::uint32_t i = 0; i < lens_samples; ++i) {
            const Vec3 offset = at_depth(sensor.generate_ray(1, 6, {0.5f, 0.5f}, lens_sample(i)), p, z) - center;
            square_mean += static_cast<double>(offset.squaredNorm()) / lens_samples;
            mean += offset.cast<double>() / lens_samples;
            largest = std::max(largest, double{offset.norm()});
        }
        EXPECT_NEAR(largest, radius, 0.01 * radius) << z;
        EXPECT_LT(largest, radius + 1e-5) << z;
        EXPECT_NEAR(square_mean, radius * radius / 2, 4 * radius * radius / std::sqrt(12.0 * lens_samples)) << z;
        EXPECT_LT(mean.norm(), 4 * radius / std::sqrt(2.0 * lens_samples)) << z;
    }
}

void expect_same_ray(const Ray& a, const Ray& b) {
    EXPECT_EQ(a.o, b.o);
    EXPECT_EQ(a.d, b.d);
    EXPECT_EQ(a.t_min, b.t_min);
    EXPECT_EQ(a.t_max, b.t_max);
}

TEST(ThinLens, ClipDistancesCountFromTheLens) {
    auto p = behind_a_lens();
    p.near_clip = 2;
    p.far_clip = 10;
    for (std::uint32_t i = 0; i < 16; ++i) {
        const Ray ray = Sensor(p).generate_ray(0, 7, {0.5f, 0.5f}, lens_sample(i));
        const float cosine = ray.d.dot(p.to_world.block<3, 1>(0, 2).cast<float>());
        EXPECT_NEAR(ray.t_min * cosine, 2.f, 1e-5f);
        EXPECT_NEAR(ray.t_max * cosine, 10.f, 1e-4f);
    }
}

TEST(Sensor, TakesLensSamplesOnlyForALens) {
    const auto p = behind_a_lens();
    const Sensor lens(p), pinhole(square(8));
    const Sampler sampler(PointSet::independent, 1, 2, 3);
    const Vec2 u_film = sampler.get_2d(dimension::film), u_lens = sampler.get_2d(dimension::lens);
    expect_same_ray(lens.sample_ray(1, 2, sampler), lens.generate_ray(1, 2, u_film, u_lens));
    expect_same_ray(pinhole.sample_ray(1, 2, sampler), pinhole.generate_ray(1, 2, u_film));
}

TEST(Sensor, ACropShowsItsPartOfTheFilm) {
    for (const bool orthographic : {false, true}) {
        auto p = behind_a_lens();
        p.width = 40;
        p.height = 30;
        p.fov_axis = Sensor::FovAxis::smaller;  // the film's smaller side, not the image's
        p.principal_point_offset = Vec2d(0.1, -0.2);
        if (orthographic) p.projection = Sensor::Projection::orthographic;
        const Sensor whole(p);
        p.crop = Sensor::Crop{Vec2d(40, 30), Vec2d(7, 11)};
        p.width = 5;
        p.height = 13;
        const Sensor part(p);
        EXPECT_EQ(part.width(), 5);
        EXPECT_EQ(part.height(), 13);
        for (int y = 0; y < 13; ++y)
            for (int x = 0; x < 5; ++x)
                expect_same_ray(part.generate_ray(x, y, {0.2f, 0.7f}, {0.9f, 0.1f}),
                                whole.generate_ray(x + 7, y + 11, {0.2f, 0.7f}, {0.9f, 0.1f}));
    }
}

/// Cameras of all kinds, with axes that are neither orthogonal nor of unit length, an offset, clip distances and a crop.
std::vector<Sensor> some_cameras() {
    Sensor::Parameters p = square(16);
    p.to_world << 1.2, 0.1, 0.3, 4, -0.2, 0.9, 0.2, -1, 0.1, -0.3, 1.5, 2, 0, 0, 0, 1;
    p.principal_point_offset = Vec2d(0.1, -0.2);
    p.crop = Sensor::Crop{Vec2d(32, 24), Vec2d(5, 3)};
    p.near_clip = 0.5f;
    p.far_clip = 100.f;
    std::vector<Sensor> cameras{Sensor(p)};
    p.aperture_radius = 0.3;
    p.focus_distance = 3;
    cameras.emplace_back(p);
    p.aperture_radius = 0;
    p.projection = Sensor::Projection::orthographic;
    cameras.emplace_back(p);
    return cameras;
}

TEST(Sensor, SeesAPointWhereItsRaysMeetIt) {
    for (const Sensor& sensor : some_cameras()) {
        for (std::uint32_t i = 0; i < 100; ++i) {
            const Sampler u(PointSet::independent, 1, i, 0);
            const int x = static_cast<int>(i % 16), y = static_cast<int>(i / 7);
            const Vec2 u_film = u.get_2d(0), u_lens = u.get_2d(1);
            const Ray ray = sensor.generate_ray(x, y, u_film, u_lens);
            const float t = 1.f + 20.f * u.get_1d(2);
            const auto view = sensor.view_of(ray.o + t * ray.d, u_lens);
            ASSERT_TRUE(view);
            // Rounding of positions near 10, relative to distances of at least 1, at a field of 16 pixels.
            EXPECT_NEAR(view->film.x(), static_cast<float>(x) + u_film.x(), 2e-3f);
            EXPECT_NEAR(view->film.y(), static_cast<float>(y) + u_film.y(), 2e-3f);
            EXPECT_NEAR((view->ray.d - ray.d).norm(), 0.f, 1e-5f);
            EXPECT_NEAR((view->ray.o - ray.o).norm(), 0.f, 1e-4f);
            EXPECT_NEAR(view->distance, t, 1e-4f * t);
            EXPECT_NEAR(view->ray.t_min, ray.t_min, 1e-4f);
            EXPECT_NEAR(view->ray.t_max, ray.t_max, 1e-3f * ray.t_max);
            EXPECT_FALSE(sensor.view_of(ray.o - t * ray.d, u_lens));
        }
    }
}

// The density is the ratio of areas: of a small square on the film and of the rays through it.
TEST(Sensor, RayDensityIsTheFilmsAreaByThatOfItsRays) {
    for (const Sensor& sensor : some_cameras()) {
        for (int pixel = 0; pixel < 16; ++pixel) {
            const auto ray = [&](float u, float v) { return sensor.generate_ray(pixel, 15 - pixel, {u, v}); };
            const Ray middle = ray(0.5f, 0.5f), right = ray(1.f, 0.5f), left = ray(0.f, 0.5f), up = ray(0.5f, 1.f),
                      down = ray(0.5f, 0.f);
            const bool parallel = sensor.is_orthographic();
            const auto difference = [&](const Ray& a, const Ray& b) {
                return parallel ? Vec3(a.o - b.o) : Vec3(a.d - b.d);
            };
            const float area = std::abs(difference(right, left).cross(difference(up, down)).dot(middle.d));
            EXPECT_NEAR(sensor.ray_density(middle.d) * double{area}, 1.0, 4e-3);  // a pixel has a width
        }
    }
}

// A light path's point of the film adds to a pixel with the density with which this pixel's own samples fall on it.
TEST(ReconstructionFilter, PixelsAreChosenByTheDensityOfTheirSamples) {
    for (const auto& filter : {ReconstructionFilter::box(0.5f), ReconstructionFilter::box(1.3f),
                               ReconstructionFilter::tent(1.f), ReconstructionFilter::gaussian(0.5f)}) {
        std::map<std::pair<int, int>, double> samples, points;  // pixels' shares of a square of the film
        constexpr std::uint32_t n = 1 << 17;
        constexpr int reach = 3;
        const Vec2 corner(0.3f, 0.6f);
        constexpr float side = 0.25f;
        for (std::uint32_t i = 0; i < n; ++i) {
            const Sampler u(PointSet::sobol, 1, 0, i);
            const auto pixel = filter.choose_pixel(corner + side * u.get_2d(0), u.get_1d(1));
            points[{pixel.x, pixel.y}] += static_cast<double>(pixel.weight * side * side) / n;
        }
        for (int x = -reach; x <= reach; ++x)
            for (int y = -reach; y <= reach; ++y)
                for (std::uint32_t i = 0; i < n; ++i) {
                    const Vec2 at = Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) +
                                    filter.sample(Sampler(PointSet::sobol, 2, 0, i).get_2d(0)) - corner;
                    if (at.minCoeff() >= 0.f && at.maxCoeff() < side) samples[{x, y}] += 1.0 / n;
                }
        for (const auto& [pixel, share] : samples)
            EXPECT_NEAR(points[pixel], share, 1e-4) << pixel.first << ' ' << pixel.second;
    }
}

}  // namespace
}  // namespace gib::test::sensor_test
