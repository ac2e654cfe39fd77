// The part of a disc that lies on the surface (area=surface) at edges, walls, corners, layers and on spheres. And the grid of
// places around which a scene is flat: what it says is true, and look-ups that use it find the same light.
#include "methods/parts/density/surface_disc.h"

#include "methods/parts/density/flat_regions.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/methods/parts/density/density_fixtures.h"
#include "tests/support/scene_text.h"

#include <limits>

namespace gib::test::surface_disc_test {
namespace {

const Vec3 up(0, 0, 1);
const std::string floor_square = white("rectangle");

/// About nearest of the n photons over [-1, 1]^2 lie within the radius r.
constexpr std::size_t n = 20000, nearest = 100;
const float r = 2.f * std::sqrt(static_cast<float>(nearest) / (pi * static_cast<float>(n)));

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
    return {{Kernel::uniform, nearest, 0.5f, area},
            {Kernel::cone, nearest, 0.5f, area},
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
    Groups groups;
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
        const LoadedScene scene =
            scene_of_shapes(floor_square + white("rectangle", rotate('y', 90) + scale(1, 4, 1) +
                                                                  rotate('z', static_cast<double>(turn * 180.f / pi))));
        const auto photons = [&](std::uint64_t seed) { return bright_beyond(0.f, turn, seed); };
        const std::array distances = {0.02f, 0.3f, 0.5f, 0.7f, 0.95f};
        Groups groups;
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
    const LoadedScene scene = scene_of_shapes(white("rectangle", translate(1, 1, 0)) +
                                              white("rectangle", rotate('y', 90) + translate(0, 1, 1)) +
                                              white("rectangle", rotate('x', -90) + translate(1, 0, 1)));
    const Vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);
    const auto photons = [&](std::uint64_t seed) {
        std::vector<Photon> all;
        spread(all, n, Vec3::Zero(), x, y, up, 4.f, seed);
        spread(all, n, Vec3::Zero(), y, z, Vec3(1, 0, 0), 400.f, seed + 100000);
        spread(all, n, Vec3::Zero(), x, z, Vec3(0, 1, 0), 4000.f, seed + 200000);
        return all;
    };
    const Groups groups = {{down_at(0.05f * r, 0.05f * r)},
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
    const LoadedScene scene = scene_of_shapes(floor_square + white("rectangle", translate(0, 0, -3.5e-3)));
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
    const LoadedScene scene = scene_of_shapes(white("sphere"));
    const auto photons = [](float side) {
        return [side](std::uint64_t seed) {
            std::vector<Photon> all;
            for (std::size_t i = 0; i < n; ++i) {
                const Vec2 u = Sampler(PointSet::independent, seed, i, 0).get_2d(0);
                const float z = 1.f - 2.f * u.x(), s = std::sqrt(std::max(1.f - z * z, 0.f));
                const Vec3 p(s * std::cos(2.f * pi * u.y()), s * std::sin(2.f * pi * u.y()), z);
                all.push_back(photon_at(p, side * p, 4.f * pi / n));
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

/// The square [-1, 1]^2 in z = 0 and a wall across it at x = 0.5.
const std::string floor_and_wall = white("rectangle") + white("rectangle", rotate('y', 90) + translate(0.5, 0, 0));

LoadedScene seen_in_parallel(const std::string& shapes) {
    return Scene(element("sensor", "orthographic", box_film(4)), shapes).load();
}

/// Asks about points of the floor where `distance(x, y)` is that to the nearest end or obstacle.
template <typename Distance, typename Ask>
void for_floor(const LoadedScene& loaded, const Distance& distance, const Ask& ask) {
    const FlatRegions regions(*loaded.scene, 32);
    for (float x = -0.98f; x < 1.f; x += 0.0317f)
        for (float y = -0.98f; y < 1.f; y += 0.0317f) {
            const auto hit = loaded.scene->intersect(down_at(x, y));
            ASSERT_TRUE(hit);
            const float d = distance(x, y);
            ask(regions, *hit, d);
        }
}

// The grid has voxels of 1/16 and may be too careful by three of them; it looks 6 voxels far.
TEST(FlatRegions, EndAtWallsAndWhereTheSurfaceEnds) {
    constexpr float voxel = 1.f / 16;
    int flat = 0;
    for_floor(
        seen_in_parallel(floor_and_wall),
        [](float x, float y) {
            return std::min({std::abs(x - 0.5f), 1.f - std::abs(x), 1.f - std::abs(y)});
        },
        [&](const FlatRegions& regions, const SurfaceHit& hit, float d) {
            EXPECT_FALSE(regions.flat_around(hit, 1.001f * d)) << hit.p.transpose();
            const float surely = std::min(d - 3.1f * voxel, 5.9f * voxel);
            if (!(surely > 0.f)) return;
            EXPECT_TRUE(regions.flat_around(hit, surely)) << hit.p.transpose();
            ++flat;
        });
    EXPECT_GT(flat, 500);
}

// Distances of the grid are in the maximum norm, and a sphere counts as its box.
TEST(FlatRegions, KnowWhereNoSurfaceIsNear) {
    constexpr float radius = 0.3f, voxel = 1.f / 16;
    const Vec3 middle(-0.3f, 0.f, 0.7f);
    const LoadedScene loaded =
        seen_in_parallel(floor_and_wall + white("sphere", scale(radius) + translate(-0.3, 0, 0.7)));
    const FlatRegions regions(*loaded.scene, 32);
    int empty = 0;
    for (float x = -0.98f; x < 1.f; x += 0.0917f)
        for (float y = -0.98f; y < 1.f; y += 0.0917f)
            for (float z = -0.98f; z < 1.f; z += 0.0917f) {
                const Vec3 p(x, y, z);
                const float wall = std::abs(x - 0.5f);
                const float surface = std::min({std::abs(z), wall, std::abs((p - middle).norm() - radius)});
                EXPECT_FALSE(regions.empty_around(p, 1.001f * surface)) << p.transpose();
                const float in_grid = std::min({std::abs(z), wall, (p - middle).cwiseAbs().maxCoeff() - radius});
                const float surely = std::min(in_grid - 2.1f * voxel, 4.9f * voxel);
                if (!(surely > 0.f)) continue;
                EXPECT_TRUE(regions.empty_around(p, surely)) << p.transpose();
                ++empty;
            }
    EXPECT_GT(empty, 500);
}

// Two floors in one mesh, the same triangles twice: each edge at their end belongs to two triangles.
TEST(FlatRegions, EndWhereASurfaceThatIsThereTwiceEnds) {
    const TemporaryFolder folder;
    const std::string file = folder.write("twice.obj",
                                          "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
                                          "f 1 2 3\nf 1 3 4\nf 1 2 3\nf 1 3 4\n");
    const LoadedScene loaded =
        seen_in_parallel(shape("obj", text("filename", file), flag("face_normals"), diffuse(0.5)));
    for_floor(
        loaded, [](float x, float y) { return std::min(1.f - std::abs(x), 1.f - std::abs(y)); },
        [](const FlatRegions& regions, const SurfaceHit& hit, float d) {
            EXPECT_FALSE(regions.flat_around(hit, 1.001f * d)) << hit.p.transpose();
        });
}

// Rays would have found nothing where the grid says that there is nothing, so that no bit changes.
TEST(FlatRegions, ChangeNoLookUpAndSaveMostOfItsRays) {
    const LoadedScene loaded = shipped_scene("cornell-box.xml", {{}, std::pair{32, 32}});
    const gib::Scene& scene = *loaded.scene;
    auto walk = trace_photons(scene, PhotonMapKind::global, 200000, std::numeric_limits<int>::max(), 1);
    const PhotonMap map(walk.photons, walk.unit);
    const FlatRegions regions(scene, FlatRegions::resolution_for(200000));
    for (const std::size_t count : {std::size_t{50}, all_photons}) {
        DensityEstimator with{Kernel::uniform, count, 0.01f * scene.diagonal(), DiscArea::surface};
        const DensityEstimator without = with;
        with.flat = &regions;
        RayQueries rays(scene), probed(scene);
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) {
                const Ray eye = scene.sensor().generate_ray(x, y, Vec2(0.5f, 0.5f));
                const auto hit = scene.intersect(eye);
                if (!hit) continue;
                const Sampler u(PointSet::independent, 1, static_cast<std::uint64_t>(32 * y + x), 0);
                const Reflected a = with.reflected_radiance(map, rays, *hit, -eye.d, EyePath{100}, u, 0);
                const Reflected b = without.reflected_radiance(map, probed, *hit, -eye.d, EyePath{100}, u, 0);
                ASSERT_TRUE((a.between_surfaces == b.between_surfaces).all()) << x << ' ' << y;
                ASSERT_EQ(a.near_obstacle, b.near_obstacle);
            }
        EXPECT_LT(3 * rays.count(), 2 * probed.count());
    }
}

// A look-up near a second sheet says so, whether it takes the nearest photons or all: who uses it elsewhere has to look.
TEST(SurfaceDisc, ReportsAnotherLayer) {
    const Ray eye = down_at(0, 0, 0.5f);
    for (const bool is_double : {false, true}) {
        const LoadedScene scene =
            scene_of_shapes(floor_square + (is_double ? white("rectangle", translate(0, 0, -0.01)) : ""));
        std::vector<Photon> photons;
        spread(photons, n, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), up, 4.f, 1);
        if (is_double) spread(photons, n, Vec3(-1, -1, -0.01f), Vec3(2, 0, 0), Vec3(0, 2, 0), up, 4.f, 2);
        const PhotonMap map(photons, 1);
        const auto hit = scene.scene->intersect(eye);
        ASSERT_TRUE(hit);
        for (const DensityEstimator& e : estimators()) {
            RayQueries rays(*scene.scene);
            const Sampler u(PointSet::independent, 1, 0, 0);
            EXPECT_EQ(e.reflected_radiance(map, rays, *hit, up, EyePath{100}, u, 0).near_obstacle, is_double)
                << name_of(e);
        }
    }
}

// The boundary of fog along a wall is no obstacle and no other layer, and does not cover the wall; a sheet there is both.
TEST(SurfaceDisc, SeesThroughTheBoundariesOfMedia) {
    for (const bool is_sheet : {false, true}) {
        const LoadedScene scene = scene_of_shapes(
            white("rectangle", scale(5)) +
            shape("rectangle", to_world(scale(5), translate(0, 0, 0.001)), is_sheet ? diffuse(1.0) : bsdf("null")));
        RayQueries rays(*scene.scene);
        const auto hit = scene.scene->intersect(down_at(0.3f, 0.2f, 0.0005f));
        SurfaceDisc disc(*hit, Vec3::UnitZ(), Vec2(0.3f, 0.6f));
        EXPECT_EQ(disc.find_obstacles(rays, 1.f, 1.f), is_sheet);
        disc.find_layers(rays, 1.f);
        EXPECT_EQ(disc.in_layer(Vec3(0, 0, 0.01f)), !is_sheet);
        if (is_sheet) continue;
        EXPECT_EQ(disc.covered(rays, Kernel::uniform, 1.f), 1.f);
    }
}

}  // namespace
}  // namespace gib::test::surface_disc_test
