// Tests of the intersection of rays with all kinds of shapes, in packets and in any units.

#include "common/shapes/accelerator.h"
#include "common/scene/scene.h"

#include "common/sampling/sampler.h"
#include "common/sampling/warp.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

namespace gib::test::accelerator_test {
namespace {

/// A mesh, every other kind of shape, and instances of both around and beside each other.
LoadedScene every_shape(const std::string& scale = "1") {
    const std::string resize = "<scale value='" + scale + "'/></transform>";
    const std::string move = "<transform name='to_world'><translate x='4'/>" + resize;
    const std::string tilt = "<transform name='to_world'><rotate x='1' y='0.3' angle='70'/><translate y='3'/>" + resize;
    return load("<shape type='cube'><transform name='to_world'>" + resize + "</shape><shape type='sphere'>" + move +
                "</shape><shape type='disk'>" + tilt +
                "</shape><shape type='cylinder'><point name='p0' x='-3' y='0' z='-2'/><point "
                "name='p1' x='-3' y='0' "
                "z='2'/><float name='radius' value='0.7'/><transform name='to_world'>" +
                resize + "</shape>" +
                "<shape type='shapegroup' id='g'><shape type='sphere'/><shape type='cube'><transform "
                "name='to_world'><translate x='4'/></transform>" +
                "</shape></shape><shape type='instance'><ref id='g'/><transform name='to_world'><scale "
                "x='0.5' y='1.5'/><translate z='5'/>" +
                resize +
                "</shape><shape type='instance'><ref "
                "id='g'/><transform name='to_world'><rotate z='1' angle='30'/><translate y='-5' "
                "x='-2'/>" +
                resize + "</shape>");
}

// Packets of every size, of neighbouring rays and of rays in all directions, find what single rays find. Embree's
// kernels for one ray and for eight round differently: t by some ulps of the ray's length, u and v by that over the
// triangle's size and over the cosine of a slanting hit.
TEST(Accelerator, PacketsFindWhatSingleRaysFind) {
    const LoadedScene loaded = every_shape();
    const Scene& scene = *loaded.scene;
    const Accelerator& accelerator = scene.accelerator();
    std::array<Ray, Accelerator::packet_size> rays;
    std::array<std::optional<Intersection>, Accelerator::packet_size> found;
    std::vector<int> hits_of_shape(scene.shapes().size());
    int hits_of_instances = 0, misses = 0;
    for (std::uint64_t packet = 0; packet < 8000; ++packet) {
        const std::size_t count = 1 + packet % rays.size();
        const bool coherent = packet % 3 == 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Sampler own(PointSet::independent, 1, packet, static_cast<std::uint32_t>(i + 1));
            const Sampler& u = coherent ? Sampler(PointSet::independent, 1, packet, 0) : own;
            const Vec3 from = scene.diagonal() * square_to_sphere(u.get_2d(0));
            const Vec3 at = 0.3f * scene.diagonal() * square_to_sphere(u.get_2d(1)) * u.get_1d(2);
            const Vec3 aside = 0.01f * square_to_sphere(own.get_2d(3));
            rays[i] = {from, (at + aside - from).normalized(), 0.f, packet % 5 == 0 ? scene.diagonal() : infinity};
        }
        accelerator.intersect(std::span(rays).first(count), found);
        for (std::size_t i = 0; i < count; ++i) {
            const auto alone = accelerator.intersect(rays[i]);
            ASSERT_EQ(found[i].has_value(), alone.has_value()) << packet << ' ' << i;
            misses += !alone;
            if (!alone) continue;
            EXPECT_EQ(found[i]->shape, alone->shape);
            EXPECT_EQ(found[i]->primitive, alone->primitive);
            EXPECT_EQ(found[i]->instance, alone->instance);
            EXPECT_NEAR(found[i]->t, alone->t, 1e-6f * scene.diagonal());
            EXPECT_NEAR(found[i]->u, alone->u, 1e-4f);
            EXPECT_NEAR(found[i]->v, alone->v, 1e-4f);
            ++hits_of_shape[alone->shape];
            hits_of_instances += alone->instance != no_instance;
        }
    }
    for (int hits : hits_of_shape)
        EXPECT_GT(hits, 100);
    EXPECT_GT(hits_of_instances, 1000);
    EXPECT_GT(misses, 1000);
}

// A ray meets a scaled scene at the scaled point. Powers of two change no digit; a scale of 1e-10 leaves a
// determinant of 1e-20, which Embree takes for zero.
TEST(Accelerator, FindsTheSameInAnyUnits) {
    const LoadedScene loaded = every_shape();
    const Scene& scene = *loaded.scene;
    for (const auto& [text, scale] : {std::pair("1e-10", 1e-10f), std::pair("1e-6", 1e-6f), std::pair("1e-3", 1e-3f),
                                      std::pair("1e6", 1e6f), std::pair("1e10", 1e10f)}) {
        const LoadedScene loaded_resized = every_shape(text);
        const Scene& resized = *loaded_resized.scene;
        std::vector<int> hits_of_shape(scene.shapes().size());
        int differing = 0;
        for (std::uint64_t i = 0; i < 20000; ++i) {
            const Sampler u(PointSet::independent, 2, i, 0);
            const Vec3 from = scene.diagonal() * square_to_sphere(u.get_2d(0));
            const Vec3 at = 0.3f * scene.diagonal() * square_to_sphere(u.get_2d(1)) * u.get_1d(2);
            const Ray ray{from, (at - from).normalized()};
            const auto expected = scene.accelerator().intersect(ray);
            const auto found = resized.accelerator().intersect({scale * ray.o, ray.d});
            // The scaled coordinates are rounded, so a ray may pass an edge on its other side.
            if (found.has_value() != expected.has_value() ||
                (found && (found->shape != expected->shape || found->primitive != expected->primitive))) {
                ++differing;
                continue;
            }
            if (!found) continue;
            EXPECT_NEAR(found->t / scale, expected->t, 2e-5f * scene.diagonal()) << text;
            EXPECT_NEAR(found->u, expected->u, 1e-3f) << text;
            EXPECT_NEAR(found->v, expected->v, 1e-3f) << text;
            EXPECT_EQ(resized.accelerator().occluded({scale * ray.o, ray.d}), true) << text;
            ++hits_of_shape[expected->shape];
        }
        EXPECT_LE(differing, 4) << text;
        for (int hits : hits_of_shape)
            EXPECT_GT(hits, 100) << text;
    }
}

}  // namespace
}  // namespace gib::test::accelerator_test
