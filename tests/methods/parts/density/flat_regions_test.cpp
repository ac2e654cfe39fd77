// The grid of places around which a scene is flat: what it says is true, and look-ups that use it find the same light.
#include "methods/parts/density/flat_regions.h"

#include "methods/parts/photons/photon_walk.h"
#include "tests/methods/parts/density/density_fixtures.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace gib::flat_regions_test {
namespace {

using test::down_at;
using test::white;

/// The square [-1, 1]^2 in z = 0 and a wall across it at x = 0.5.
const std::string floor_and_wall =
    white("rectangle", "") + white("rectangle", "<rotate y='1' angle='90'/><translate x='0.5'/>");

LoadedScene scene_with(const std::string& shapes) {
    return test::scene_of(test::scene_xml("<sensor type='orthographic'>" + test::box_film(4) + "</sensor>" + shapes));
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
        scene_with(floor_and_wall),
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

// Two floors in one mesh, the same triangles twice: each edge at their end belongs to two triangles.
TEST(FlatRegions, EndWhereASurfaceThatIsThereTwiceEnds) {
    const test::TemporaryFolder folder;
    folder.write("twice.obj",
                 "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
                 "f 1 2 3\nf 1 3 4\nf 1 2 3\nf 1 3 4\n");
    const std::string xml =
        test::scene_xml("<sensor type='orthographic'>" + test::box_film(4) +
                        "</sensor><shape type='obj'><string name='filename' value='twice.obj'/>" +
                        "<boolean name='face_normals' value='true'/>" + test::diffuse(0.5) + "</shape>");
    const LoadedScene loaded = load_scene(folder.write("twice.xml", xml));
    for_floor(
        loaded, [](float x, float y) { return std::min(1.f - std::abs(x), 1.f - std::abs(y)); },
        [](const FlatRegions& regions, const SurfaceHit& hit, float d) {
            EXPECT_FALSE(regions.flat_around(hit, 1.001f * d)) << hit.p.transpose();
        });
}

TEST(FlatRegions, EndUnderASphere) {
    const LoadedScene loaded =
        scene_with(white("rectangle", "") + white("sphere", "<scale value='0.5'/><translate z='0.55'/>") +
                   white("sphere", "<scale value='0.5'/><translate z='-0.55'/>"));
    const FlatRegions regions(*loaded.scene, 32);
    const auto hit = loaded.scene->intersect(down_at(0.02f, 0.02f, 0.04f));
    ASSERT_TRUE(hit);
    EXPECT_FALSE(regions.flat_around(*hit, 0.06f));
}

// Rays would have found nothing where the grid says that there is nothing, so that no bit changes.
TEST(FlatRegions, ChangeNoLookUpAndSaveMostOfItsRays) {
    const LoadedScene loaded = test::shipped_scene("cornell-box.xml", {{}, std::pair{32, 32}});
    const Scene& scene = *loaded.scene;
    auto walk = trace_photons(scene, PhotonMapKind::global, 200000, std::numeric_limits<int>::max(), 1);
    const PhotonMap map(walk.photons, walk.unit);
    const FlatRegions regions(scene, FlatRegions::resolution_for(200000));
    for (const std::size_t k : {std::size_t{50}, all_photons}) {
        DensityEstimator with{Kernel::uniform, k, 0.01f * scene.diagonal(), DiscArea::surface};
        const DensityEstimator without = with;
        with.flat_regions = &regions;
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

}  // namespace
}  // namespace gib::flat_regions_test
