#include "methods/surface_disc.h"

#include "tests/density_fixtures.h"

namespace gib {
namespace {

using test::down_at;
using test::Moments;
using test::relative_estimates;
using test::scene_of_shapes;
using test::spread;
using test::white;

const Vec3 up(0, 0, 1);
const std::string floor_square = white("rectangle", "");

/// Look-ups of about this radius: k photons of n over [-1, 1]^2.
constexpr std::size_t n = 40000;
float radius_of(std::size_t k) { return 2.f * std::sqrt(static_cast<float>(k) / (pi * static_cast<float>(n))); }

/// Photons of 1 [W/area] on [-1, 1]^2, those beyond the line x cos(turn) + y sin(turn) = at of 1000 times the power.
std::vector<Photon> bright_beyond(float at, float turn, std::uint64_t seed) {
    std::vector<Photon> photons;
    spread(photons, n, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), up, 4.f, seed);
    for (Photon& p : photons)
        if (p.p.x() * std::cos(turn) + p.p.y() * std::sin(turn) > at) p.power *= 1000.f;
    return photons;
}

/// The estimators that must find the density 1 on the dark side; the fixed radius is that of k photons.
std::vector<DensityEstimator> estimators(std::size_t k, DiscArea area = DiscArea::surface) {
    return {{Kernel::uniform, k, 0.5f, area},
            {Kernel::cone, k, 0.5f, area},
            {Kernel::gaussian, all_photons, radius_of(k), area},
            {Kernel::epanechnikov, all_photons, radius_of(k), area}};
}

// The estimate stays within four standard errors and the 1 % that the noise of the probed area may add. Without the area, an edge
// through the centre halves it; pi r^2 (1 - (acos(s) - s sqrt(1 - s^2)) / pi) is left at the distance s r.
TEST(SurfaceDisc, WhereTheSurfaceEndsTheAreaIsCut) {
    const LoadedScene scene = scene_of_shapes(floor_square);
    const auto photons = [](std::uint64_t seed) { return bright_beyond(2.f, 0.f, seed); };
    for (const DensityEstimator& e : estimators(200)) {
        for (float s : {0.01f, 0.3f, 0.6f, 0.8f, 0.9f, 1.2f}) {
            SCOPED_TRACE(testing::Message() << kernel_names[static_cast<std::size_t>(e.kernel)] << " at " << s);
            std::vector<Ray> eyes;
            for (int i = -3; i <= 3; ++i)
                eyes.push_back(down_at(1.f - s * radius_of(200), 0.25f * static_cast<float>(i)));
            const Moments found = relative_estimates(*scene.scene, e, 60, 1.0, photons, eyes);
            EXPECT_NEAR(found.mean(), 1.0, 0.01 + 4 * found.standard_error());
            EXPECT_LT(found.standard_error(), 0.006);
        }
        const Moments corner =
            relative_estimates(*scene.scene, e, 400, 1.0, photons, {down_at(1.f - 1e-3f, 1.f - 1e-3f)});
        EXPECT_NEAR(corner.mean(), 1.0, 0.015 + 4 * corner.standard_error());
    }
}

// A wall of no thickness at all, at any angle: what lies behind it, 1000 times brighter, adds nothing, and the estimate is
// exact. With photons rejected by normal and height alone it is wrong by more than 100 at half a radius.
TEST(SurfaceDisc, NothingIsSeenThroughAThinWall) {
    for (float turn : {0.f, 0.2f, 0.7f, 2.f}) {
        const std::string degrees = std::to_string(turn * 180.f / pi);
        const LoadedScene scene = scene_of_shapes(
            floor_square +
            white("rectangle", "<rotate y='1' angle='90'/><scale y='4'/><rotate z='1' angle='" + degrees + "'/>"));
        const auto photons = [&](std::uint64_t seed) { return bright_beyond(0.f, turn, seed); };
        for (const DensityEstimator& e : estimators(200)) {
            for (float s : {0.02f, 0.3f, 0.7f, 0.95f}) {
                SCOPED_TRACE(testing::Message() << kernel_names[static_cast<std::size_t>(e.kernel)] << " at " << s
                                                << " radii, turned by " << degrees);
                const float a = -s * radius_of(200);
                std::vector<Ray> eyes;
                for (int i = -2; i <= 2; ++i) {
                    const float b = 0.3f * static_cast<float>(i);
                    eyes.push_back(
                        down_at(a * std::cos(turn) - b * std::sin(turn), a * std::sin(turn) + b * std::cos(turn)));
                }
                const Moments found = relative_estimates(*scene.scene, e, 40, 1.0, photons, eyes);
                EXPECT_NEAR(found.mean(), 1.0, 0.005 + 4 * found.standard_error());
                EXPECT_LT(found.standard_error(), 0.012);
            }
        }
        const DensityEstimator rejected{Kernel::uniform, 200, 0.5f, DiscArea::rejected};
        const float a = -0.5f * radius_of(200);
        const auto leak = relative_estimates(*scene.scene, rejected, 4, 1.0, photons,
                                             {down_at(a * std::cos(turn), a * std::sin(turn))});
        EXPECT_GT(leak.mean(), 100.0);
    }
}

// Three walls meet; each has its own density. The photons of the others do not count, and what the discs lose beyond the edges is
// known.
TEST(SurfaceDisc, AnInsideCornerKeepsEachWallsOwnLight) {
    const LoadedScene scene =
        scene_of_shapes(white("rectangle", "<translate x='1' y='1'/>") +
                        white("rectangle", "<rotate y='1' angle='90'/><translate y='1' z='1'/>") +
                        white("rectangle", "<rotate x='1' angle='-90'/><translate x='1' z='1'/>"));
    const Vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);
    const auto photons = [&](std::uint64_t seed) {
        std::vector<Photon> all;
        spread(all, n, Vec3::Zero(), x, y, up, 4.f, seed);
        spread(all, n, Vec3::Zero(), y, z, Vec3(1, 0, 0), 400.f, seed + 100000);
        spread(all, n, Vec3::Zero(), x, z, Vec3(0, 1, 0), 4000.f, seed + 200000);
        return all;
    };
    const float r = radius_of(200);
    for (const DensityEstimator& e : estimators(200))
        for (const auto& [a, b] : {std::pair{0.05f, 0.05f}, {0.4f, 0.1f}, {0.4f, 0.6f}, {3.f, 0.3f}}) {
            SCOPED_TRACE(testing::Message()
                         << kernel_names[static_cast<std::size_t>(e.kernel)] << ' ' << a << ' ' << b);
            const Moments found = relative_estimates(*scene.scene, e, 300, 1.0, photons, {down_at(a * r, b * r)});
            EXPECT_NEAR(found.mean(), 1.0, 0.005 + 4 * found.standard_error());
        }
}

// Layers 1e-4 of the scene's size (about 35) apart, with the same normal: the photons of the lower one, and of both undersides, do
// not count on the upper one, nor the other way round.
TEST(SurfaceDisc, ALayerCloseByIsAnotherSurface) {
    constexpr float gap = 3.5e-3f;
    const LoadedScene scene =
        scene_of_shapes(floor_square + white("rectangle", "<translate z='" + std::to_string(-gap) + "'/>"));
    const auto photons = [&](float upper, float lower) {
        return [=](std::uint64_t seed) {
            std::vector<Photon> all;
            const Vec3 x(2, 0, 0), y(0, 2, 0);
            spread(all, n, Vec3(-1, -1, 0), x, y, up, 4.f * upper, seed);
            spread(all, n, Vec3(-1, -1, -gap), x, y, up, 4.f * lower, seed + 100000);
            spread(all, n, Vec3(-1, -1, 0), x, y, -up, 4e3f, seed + 200000);
            spread(all, n, Vec3(-1, -1, -gap), x, y, -up, 4e3f, seed + 300000);
            return all;
        };
    };
    std::vector<Ray> eyes, inner;
    for (int i = -3; i <= 3; ++i) {
        eyes.push_back(down_at(0.2f * static_cast<float>(i), 0.1f));
        inner.push_back(down_at(0.2f * static_cast<float>(i), 0.1f, -0.5f * gap));
    }
    for (const DensityEstimator& e : estimators(200)) {
        SCOPED_TRACE(kernel_names[static_cast<std::size_t>(e.kernel)]);
        const Moments outside = relative_estimates(*scene.scene, e, 60, 1.0, photons(1, 1000), eyes);
        EXPECT_NEAR(outside.mean(), 1.0, 0.005 + 4 * outside.standard_error());
        const Moments between = relative_estimates(*scene.scene, e, 60, 1.0, photons(1000, 1), inner);
        EXPECT_NEAR(between.mean(), 1.0, 0.005 + 4 * between.standard_error());
    }
}

// The cap of a sphere within the chord d has the area pi d^2: nothing is to be cut, inside or outside, up to radii near the
// sphere's own.
TEST(SurfaceDisc, ACurvedSurfaceIsNotCut) {
    const LoadedScene scene = scene_of_shapes("<shape type='sphere'>" + test::diffuse(1.0) + "</shape>");
    const auto photons = [](float side) {
        return [side](std::uint64_t seed) {
            std::vector<Photon> all;
            for (std::size_t i = 0; i < n; ++i) {
                const Vec2 u = Sampler(PointSet::independent, seed, i, 0).get_2d(0);
                const float z = 1.f - 2.f * u.x(), s = std::sqrt(std::max(1.f - z * z, 0.f));
                const Vec3 p(s * std::cos(2.f * pi * u.y()), s * std::sin(2.f * pi * u.y()), z);
                all.push_back(test::photon_at(p, side * p, 4.f * pi / n));
            }
            return all;
        };
    };
    for (float r : {0.1f, 0.3f, 0.6f})
        for (Kernel kernel : {Kernel::uniform, Kernel::cone}) {
            SCOPED_TRACE(r);
            const DensityEstimator e{kernel, all_photons, r, DiscArea::surface};
            const Moments outside = relative_estimates(*scene.scene, e, 40, 1.0, photons(1.f),
                                                       {down_at(0, 0, 2.f), down_at(0.4f, 0.2f, 2.f)});
            EXPECT_NEAR(outside.mean(), 1.0, 0.005 + 4 * outside.standard_error());
            const Moments inside = relative_estimates(*scene.scene, e, 40, 1.0, photons(-1.f),
                                                      {down_at(0, 0, 0.f), down_at(0.4f, 0.2f, 0.f)});
            EXPECT_NEAR(inside.mean(), 1.0, 0.005 + 4 * inside.standard_error());
        }
}

}  // namespace
}  // namespace gib
