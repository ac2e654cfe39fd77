// The part of a disc that lies on the surface (area=surface) at edges, walls, corners, layers and on spheres.
#include "methods/parts/density/surface_disc.h"

#include "tests/methods/parts/density/density_fixtures.h"

namespace gib::surface_disc_test {
namespace {

using test::down_at;
using test::Moments;
using test::relative_estimates;
using test::scene_of_shapes;
using test::spread;
using test::white;

const Vec3 up(0, 0, 1);
const std::string floor_square = white("rectangle", "");

/// About k of the n photons over [-1, 1]^2 lie within the radius r.
constexpr std::size_t n = 20000, k = 100;
const float r = 2.f * std::sqrt(static_cast<float>(k) / (pi * static_cast<float>(n)));

/// Photons of 1 [W/area] on [-1, 1]^2. Those beyond the line x cos(turn) + y
/// sin(turn) = at have 1000 times the power.
std::vector<Photon> bright_beyond(float at, float turn, std::uint64_t seed) {
    std::vector<Photon> photons;
    spread(photons, n, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), up, 4.f, seed);
    for (Photon& p : photons)
        if (p.p.x() * std::cos(turn) + p.p.y() * std::sin(turn) > at) p.set_power(1000.f * p.power());
    return photons;
}

/// The estimators that must find the density 1 on the dark side.
std::vector<DensityEstimator> estimators(DiscArea area = DiscArea::surface) {
    return {{Kernel::uniform, k, 0.5f, area},
            {Kernel::cone, k, 0.5f, area},
            {Kernel::gaussian, all_photons, r, area},
            {Kernel::epanechnikov, all_photons, r, area}};
}

std::string name_of(const DensityEstimator& e) { return std::string(kernel_names[static_cast<std::size_t>(e.kernel)]); }

// The estimate stays within four standard errors plus 1 %, which the noise of the probed area may add. If the area
// were not cut, an edge through the centre would halve the estimate. At the distance s r from the edge, the area pi
// r^2 (1 - (acos(s) - s sqrt(1 - s^2)) / pi) is left.
TEST(SurfaceDisc, WhereTheSurfaceEndsTheAreaIsCut) {
    const LoadedScene scene = scene_of_shapes(floor_square);
    const auto photons = [](std::uint64_t seed) { return bright_beyond(2.f, 0.f, seed); };
    const std::array distances = {0.01f, 0.3f, 0.6f, 0.8f, 0.9f, 1.2f};
    test::Groups groups;
    for (float s : distances) {
        auto& eyes = groups.emplace_back();
        for (int i = -3; i <= 3; ++i)
            eyes.push_back(down_at(1.f - s * r, 0.25f * static_cast<float>(i)));
    }
    groups.push_back({down_at(1.f - 1e-3f, 1.f - 1e-3f), down_at(-1.f + 1e-3f, 1.f - 1e-3f),
                      down_at(1.f - 1e-3f, -1.f + 1e-3f), down_at(-1.f + 1e-3f, -1.f + 1e-3f)});
    const auto found = relative_estimates(*scene.scene, estimators(), 150, 1.0, photons, groups);
    for (std::size_t e = 0; e < found.size(); ++e) {
        SCOPED_TRACE(name_of(estimators()[e]));
        for (std::size_t g = 0; g < distances.size(); ++g) {
            EXPECT_NEAR(found[e][g].mean(), 1.0, 0.01 + 4 * found[e][g].standard_error()) << distances[g];
            EXPECT_LT(found[e][g].standard_error(), 0.006) << distances[g];
        }
        EXPECT_NEAR(found[e].back().mean(), 1.0, 0.015 + 4 * found[e].back().standard_error()) << "corner";
    }
}

// The wall has no thickness and stands at any angle. The light behind it is 1000 times brighter but adds
// nothing, so the estimate is exact. If photons are rejected by normal and height alone, the estimate is
// wrong by more than 100 at half a radius.
TEST(SurfaceDisc, NothingIsSeenThroughAThinWall) {
    for (float turn : {0.f, 0.2f, 0.7f, 2.f}) {
        SCOPED_TRACE(turn);
        const std::string degrees = std::to_string(turn * 180.f / pi);
        const LoadedScene scene = scene_of_shapes(floor_square + white("rectangle",
                                                                       "<rotate y='1' angle='90'/><scale y='4'/>"
                                                                       "<rotate z='1' angle='" +
                                                                           degrees + "'/>"));
        const auto photons = [&](std::uint64_t seed) { return bright_beyond(0.f, turn, seed); };
        const std::array distances = {0.02f, 0.3f, 0.5f, 0.7f, 0.95f};
        test::Groups groups;
        for (float s : distances) {
            auto& eyes = groups.emplace_back();
            for (int i = -2; i <= 2; ++i) {
                const float a = -s * r, b = 0.3f * static_cast<float>(i);
                eyes.push_back(
                    down_at(a * std::cos(turn) - b * std::sin(turn), a * std::sin(turn) + b * std::cos(turn)));
            }
        }
        const auto found = relative_estimates(*scene.scene, estimators(), 60, 1.0, photons, groups);
        for (std::size_t e = 0; e < found.size(); ++e)
            for (std::size_t g = 0; g < groups.size(); ++g) {
                SCOPED_TRACE(name_of(estimators()[e]));
                EXPECT_NEAR(found[e][g].mean(), 1.0, 0.005 + 4 * found[e][g].standard_error()) << distances[g];
                EXPECT_LT(found[e][g].standard_error(), 0.015) << distances[g];
            }
        const auto leak = relative_estimates(*scene.scene, estimators(DiscArea::rejected), 2, 1.0, photons, groups);
        EXPECT_GT(leak[0][2].mean(), 100.0);
    }
}

// Three walls meet, and each has its own density. Photons of the other walls do not count, and the area that discs
// lose beyond the edges is known. A quarter of a fixed disc has 25 photons: the standard error is 1 / sqrt(25 x 300),
// times 1.15 at most for the kernel.
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
    const test::Groups groups = {{down_at(0.05f * r, 0.05f * r)},
                                 {down_at(0.4f * r, 0.1f * r)},
                                 {down_at(0.4f * r, 0.6f * r)},
                                 {down_at(3.f * r, 0.3f * r)}};
    const auto found = relative_estimates(*scene.scene, estimators(), 300, 1.0, photons, groups);
    for (std::size_t e = 0; e < found.size(); ++e)
        for (std::size_t g = 0; g < groups.size(); ++g) {
            SCOPED_TRACE(name_of(estimators()[e]));
            EXPECT_NEAR(found[e][g].mean(), 1.0, 0.005 + 4 * found[e][g].standard_error()) << g;
            EXPECT_LT(found[e][g].standard_error(), 0.016) << g;
        }
}

// Two layers with the same normal are 1e-4 of the scene's size (about 35) apart. On each layer, the photons of the
// other one and of both undersides do not count.
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
    const auto outside = relative_estimates(*scene.scene, estimators(), 60, 1.0, photons(1, 1000), {eyes});
    const auto between = relative_estimates(*scene.scene, estimators(), 60, 1.0, photons(1000, 1), {inner});
    for (std::size_t e = 0; e < outside.size(); ++e) {
        SCOPED_TRACE(name_of(estimators()[e]));
        EXPECT_NEAR(outside[e][0].mean(), 1.0, 0.005 + 4 * outside[e][0].standard_error());
        EXPECT_NEAR(between[e][0].mean(), 1.0, 0.005 + 4 * between[e][0].standard_error());
    }
}

// The cap of a sphere within the chord d has the area pi d^2, so nothing is cut, inside or outside, for radii up to
// nearly the sphere's own.
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
    std::vector<DensityEstimator> fixed;
    for (float radius : {0.1f, 0.3f, 0.6f})
        for (Kernel kernel : {Kernel::uniform, Kernel::cone})
            fixed.push_back({kernel, all_photons, radius, DiscArea::surface});
    const auto outside = relative_estimates(*scene.scene, fixed, 40, 1.0, photons(1.f),
                                            {{down_at(0, 0, 2.f), down_at(0.4f, 0.2f, 2.f)}});
    const auto inside = relative_estimates(*scene.scene, fixed, 40, 1.0, photons(-1.f),
                                           {{{Vec3::Zero(), -up}, {Vec3::Zero(), Vec3(0.6f, 0, -0.8f)}}});
    for (std::size_t e = 0; e < fixed.size(); ++e) {
        SCOPED_TRACE(testing::Message() << name_of(fixed[e]) << ' ' << fixed[e].max_radius);
        EXPECT_NEAR(outside[e][0].mean(), 1.0, 0.005 + 4 * outside[e][0].standard_error());
        EXPECT_NEAR(inside[e][0].mean(), 1.0, 0.005 + 4 * inside[e][0].standard_error());
    }
}

}  // namespace
}  // namespace gib::surface_disc_test
