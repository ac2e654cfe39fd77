// Tests of the intersection of rays with all kinds of shapes, in packets and in any units, and of instances: a group seen
// through an affine map looks like the shape moved by the map, and costs next to no memory.

#include "common/sampling/sampler.h"
#include "common/sampling/warp.h"
#include "common/scene/effects.h"
#include "common/scene/scene.h"
#include "common/shapes/accelerator.h"
#include "tests/support/random.h"
#include "tests/support/scene_builder.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fstream>

namespace gib::test::instance_test {
namespace {

/// A mesh, every other kind of shape, and instances of both around and beside each other.
LoadedScene every_shape(double size = 1) {
    const std::string resize = scale(size), tilt = "<rotate x='1' y='0.3' angle='70'/>";
    const std::string group =
        with_id("shape", "shapegroup", "g", shape("sphere"), shape("cube", to_world(translate(4, 0, 0))));
    return load(shape("cube", to_world(resize)) + shape("sphere", to_world(translate(4, 0, 0), resize)) +
                shape("disk", to_world(tilt, translate(0, 3, 0), resize)) +
                shape("cylinder", point("p0", -3, 0, -2), point("p1", -3, 0, 2), radius(0.7), to_world(resize)) +
                group + shape("instance", reference("g"), to_world(scale(0.5, 1.5, 1), translate(0, 0, 5), resize)) +
                shape("instance", reference("g"), to_world(rotate('z', 30), translate(-2, -5, 0), resize)));
}

// Packets of every size, of neighbouring rays and of rays in all directions, find what single rays find. Embree's
// kernels for one ray and for eight round differently: t by some ulps of the ray's length, u and v by that over the
// triangle's size and over the cosine of a slanting hit. Single rays that lead away from the box of
// a mesh with a sphere beside it do not reach Embree.
TEST(Accelerator, PacketsFindWhatSingleRaysFind) {
    for (const LoadedScene& loaded :
         {every_shape(), load(shape("cube") + shape("sphere", to_world(translate(4, 0, 0))))}) {
        const auto& scene = *loaded.scene;
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
                EXPECT_EQ(accelerator.occluded(rays[i]), alone.has_value());
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
        if (!scene.instances().empty()) {
            EXPECT_GT(hits_of_instances, 1000);
        }
        EXPECT_GT(misses, 1000);
    }
}

/// A closed surface r(theta, phi) around the origin, as an OBJ file with uv and smooth
/// normals; an ellipsoid if `convex`.
std::string blob(int rings, bool convex) {
    std::string obj;
    const auto place = [&](int i, int k) {
        const double theta = std::numbers::pi * i / rings, phi = std::numbers::pi * k / rings;
        const double r = convex ? 1 : 1 + 0.3 * std::sin(3 * theta) * std::cos(2 * phi);
        return Vec3d(r * std::sin(theta) * std::cos(phi), r * std::sin(theta) * std::sin(phi),
                     0.7 * r * std::cos(theta));
    };
    for (int i = 0; i <= rings; ++i)
        for (int k = 0; k <= 2 * rings; ++k) {
            const Vec3d p = place(i, k % (2 * rings));
            obj += fmt::format("v {} {} {}\nvt {} {}\nvn {} {} {}\n", p.x(), p.y(), p.z(), 0.5 * k / rings,
                               i / (rings + 0.5), p.x(), p.y(), p.z());
        }
    const int row = 2 * rings + 1;
    for (int i = 0; i < rings; ++i)
        for (int k = 0; k < 2 * rings; ++k) {
            const int a = i * row + k + 1, b = a + row;
            const auto face = [&](int x, int y, int z) {
                obj += fmt::format("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", x, y, z);
            };
            if (i > 0) face(a, b, a + 1);
            if (i < rings - 1) face(a + 1, b, b + 1);
        }
    return obj;
}

std::string matrix(const Mat4d& m) {
    std::string text;
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
            text += fmt::format("{} ", m(i, k));
    return to_world("<matrix value='", text, "'/>");
}

/// A random affine map that turns, stretches by up to 100 : 1, shears, perhaps mirrors, and moves.
Mat4d any_affine(Random& random, double reach) {
    Mat4d m = Mat4d::Identity();
    const auto turn = [&] {
        return Eigen::AngleAxisd(6 * double{random.next()}, random.direction().cast<double>().normalized())
            .toRotationMatrix();
    };
    const auto stretch = [&] { return std::pow(10, 2 * double{random.next()} - 1); };
    m.topLeftCorner<3, 3>() = turn() * Vec3d(stretch(), stretch(), stretch()).asDiagonal() * turn();
    if (random.next() < 0.5f) m.topLeftCorner<3, 3>() *= -1;
    m.topRightCorner<3, 1>() = reach * random.direction().cast<double>();
    return m;
}

std::string file_shape(const std::string& name, const std::string& body = "") {
    return shape("obj", filename(name), body);
}
std::string instance_of(const std::string& shapes, const std::string& placed) {
    return shape("instance", placed, shape("shapegroup", shapes));
}
/// Two balls in opposite corners, which keep the centre of the scene at the file's origin whatever stands between.
std::string corners(double reach) {
    return shape("sphere", center(-reach, -reach, -reach)) + shape("sphere", center(reach, reach, reach));
}

/// A random ray that starts outside of the bounds and is directed into them.
Ray towards(const Bounds& bounds, Random& random) {
    const Vec3 o = bounds.center() + bounds.diagonal() * random.direction();
    const Vec3 extent = 0.5f * (bounds.upper - bounds.lower);
    const Vec3 target =
        bounds.center() +
        extent.cwiseProduct(Vec3(random.next_2d().x(), random.next(), random.next()) * 2.f - Vec3::Ones());
    return {o, (target - o).normalized()};
}

struct Comparison {
    int hits = 0, differences = 0;
};

/// Expects the same surface where both scenes have the same hit, and returns that hit of the instance.
std::optional<SurfaceHit> expect_same_surface(const gib::Scene& moved, const gib::Scene& instanced, const Ray& ray,
                                              Comparison& count) {
    const auto a = moved.intersect(ray), b = instanced.intersect(ray);
    const bool same = a.has_value() == b.has_value() && (!a || a->primitive == b->primitive);
    if (!same) ++count.differences;
    if (!same || !a) return std::nullopt;
    ++count.hits;
    const float slant = std::abs(a->ng.dot(ray.d));
    if (slant < 0.02f) return std::nullopt;  // the point of a grazing ray is uncertain
    EXPECT_LT((a->p - b->p).norm(), 2e-5f * moved.diagonal() / slant);
    EXPECT_LT((a->ng - b->ng).norm(), 1e-3f);
    EXPECT_LT((a->uv - b->uv).norm(), 2e-3f / slant);
    const SurfaceDerivatives da = moved.derivatives_at(*a), db = instanced.derivatives_at(*b);
    EXPECT_LT((da.dp_du - db.dp_du).norm(), 1e-3f * da.dp_du.norm());
    EXPECT_LT((da.dp_dv - db.dp_dv).norm(), 1e-3f * da.dp_dv.norm());
    return b;
}

/// An instance interpolates shading normals in the group and carries them by the inverse transpose. A
/// mesh that was moved itself interpolates the unit normals of the scene, which gives other normals
/// under a stretch (in Mitsuba too).
TEST(Instance, IsTheMovedMesh) {
    const TemporaryFolder folder;
    const std::string file = folder.write("m.obj", blob(12, false)), balls = corners(90);
    const auto unmoved = load(file_shape(file) + balls);
    Random random(1);
    Comparison count;
    for (int scene = 0; scene < 40; ++scene) {
        const Mat4d to_world = any_affine(random, 30), to_group = to_world.inverse();
        const auto moved = load(file_shape(file, matrix(to_world)) + balls);
        const auto instanced = load(instance_of(file_shape(file), matrix(to_world)) + balls);
        const Bounds bounds = bounds_of(moved.scene->shapes()[0]);
        for (int i = 0; i < 500; ++i) {
            const Ray ray = towards(bounds, random);
            const auto hit = expect_same_surface(*moved.scene, *instanced.scene, ray, count);
            if (!hit || hit->instance == no_instance) continue;
            const Vec3d o = (to_group * ray.o.cast<double>().homogeneous()).head<3>();
            const Vec3d d = to_group.topLeftCorner<3, 3>() * ray.d.cast<double>();
            const auto in_group = unmoved.scene->intersect({o.cast<float>(), d.cast<float>()});
            if (!in_group || in_group->primitive != hit->primitive) continue;
            if (hit->delta_only || in_group->delta_only) continue;  // the frame is about the geometric normal
            const Vec3d ns = to_group.topLeftCorner<3, 3>().transpose() * in_group->ns.cast<double>();
            EXPECT_LT((hit->ns - ns.normalized().cast<float>()).norm(), 3e-3f);
        }
    }
    EXPECT_GT(count.hits, 8'000);
    EXPECT_LT(count.differences, count.hits / 100);  // rays at edges
}

TEST(Instance, IsTheMovedSphereDiskAndCylinder) {
    Random random(2);
    for (const std::string type : {"sphere", "disk", "cylinder"})
        for (int scene = 0; scene < 10; ++scene) {
            Mat4d m = Mat4d::Identity();
            m.topLeftCorner<3, 3>() =
                3 * Eigen::AngleAxisd(double{random.next()}, random.direction().cast<double>().normalized())
                        .toRotationMatrix();
            m.topRightCorner<3, 1>() = 20 * random.direction().cast<double>();
            const auto moved = load(shape(type, matrix(m)) + corners(90));
            const auto instanced = load(instance_of(shape(type), matrix(m)) + corners(90));
            Comparison count;
            for (int i = 0; i < 500; ++i)
                expect_same_surface(*moved.scene, *instanced.scene,
                                    towards(bounds_of(moved.scene->shapes()[0]), random), count);
            EXPECT_GT(count.hits, 50) << type;
            EXPECT_LE(count.differences, 3) << type;
        }
}

TEST(Instance, ShowsTheRightShapeOfTheRightGroup) {
    const auto ball = [](double x, const std::string& material) {
        return shape("sphere", center(x, 0, 0), reference(material));
    };
    std::string bsdfs;
    for (int i = 0; i < 5; ++i)
        bsdfs += with_id("bsdf", "diffuse", "b" + std::to_string(i), number("reflectance", 0.1 * i));
    const auto instance = [](const std::string& group, double y) {
        return shape("instance", reference(group), to_world(translate(0, y, 0)));
    };
    // Instances may precede the group that they show, and a group may have no instance.
    const auto loaded =
        load(bsdfs + instance("h", 10) + ball(0, "b0") + instance("g", 20) +
             with_id("shape", "shapegroup", "g", ball(0, "b1"), ball(5, "b2")) +
             with_id("shape", "shapegroup", "unseen", ball(0, "b1")) +
             with_id("shape", "shapegroup", "h", ball(0, "b3"), ball(5, "b4")) + instance("h", 30) + ball(5, "b1"));
    const auto& scene = *loaded.scene;
    EXPECT_EQ(scene.shapes().size(), 6u);
    EXPECT_EQ(scene.instances().size(), 3u);
    const auto reflectance = [&](float x, float y) {
        // The scene reaches from -1 to 6 in x and from -1 to 31 in y; loading moves its centre to the origin.
        const auto hit = scene.intersect({Vec3(x - 2.5f, y - 15.f, 9), Vec3(0, 0, -1)});
        return hit ? hit->bsdf->coefficients_local(Vec3(0, 0, 1)).diffuse[0] : -1.f;
    };
    for (const auto& [y, left, right] :
         {std::tuple(0.f, 0.f, 0.1f), {10.f, 0.3f, 0.4f}, {20.f, 0.1f, 0.2f}, {30.f, 0.3f, 0.4f}}) {
        EXPECT_FLOAT_EQ(reflectance(0, y), left);
        EXPECT_FLOAT_EQ(reflectance(5, y), right);
    }
    EXPECT_TRUE(scene.occluded({Vec3(-2.5f, 15.f, 9), Vec3(0, 0, -1)}));
    EXPECT_FALSE(scene.occluded({Vec3(0, 15.f, 9), Vec3(0, 0, -1)}));
    EXPECT_LT((scene.bounds().upper - Vec3(3.5f, 16, 1)).norm(), 1e-4f);
}

/// Rays that leave a closed convex surface miss it, and rays that enter it meet its far side.
TEST(Instance, RaysThatLeaveItDoNotMeetItAgain) {
    const TemporaryFolder folder;
    const std::string file = folder.write("m.obj", blob(9, true));
    Random random(3);
    long leaving = 0, entering = 0, again = 0, lost = 0, near = 0;
    for (int scene = 0; scene < 80; ++scene) {
        const double reach = std::pow(10, 4 * double{random.next()} - 1);
        const std::string body = scene % 2 ? shape("sphere") : file_shape(file, flag("face_normals"));
        const auto loaded = load(instance_of(body, matrix(any_affine(random, reach))) + corners(2 * reach + 50));
        const Bounds bounds = transformed(loaded.scene->instances()[0], bounds_of(loaded.scene->shapes()[2]));
        for (int i = 0; i < 500; ++i) {
            const auto hit = loaded.scene->intersect(towards(bounds, random));
            if (!hit || hit->instance == no_instance) continue;
            const Vec3 w = random.direction();
            // The rounding of its direction may put a ray on either side of a surface that it is nearly parallel to.
            if (std::abs(w.dot(hit->ng)) < 1e-4f) continue;
            const auto next = loaded.scene->intersect(hit->spawn_ray(w));
            const bool instance_again = next && next->instance != no_instance;
            if (w.dot(hit->ng) > 0) {
                ++leaving;
                again += instance_again;
            } else {
                ++entering;
                lost += !instance_again;
                // The ray must not meet the face that it starts on, which alone it would meet from outside.
                near += instance_again && next->ng.dot(w) < 0;
            }
        }
    }
    EXPECT_GT(leaving, 5'000);
    EXPECT_GT(entering, 5'000);
    EXPECT_EQ(again, 0);
    EXPECT_EQ(near, 0);
    // A ray may slip out where the body is thinner than the offset.
    EXPECT_LT(static_cast<double>(lost), 0.002 * static_cast<double>(entering));
}

/// Whatever the map, the offset origin of a ray lies on the ray's side of the triangle that it leaves, in the group
/// as in the scene.
TEST(Instance, OffsetsTakeRaysToTheirSide) {
    const TemporaryFolder folder;
    const auto loaded = load(file_shape(folder.write("m.obj", blob(6, false))));
    const Shape& shape = loaded.scene->shapes()[0];
    const auto& mesh = std::get<Mesh>(shape);
    Random random(4);
    double nearest = 1;
    for (int i = 0; i < 100'000; ++i) {
        const auto instance = make_instance(0, any_affine(random, std::pow(10, 6 * double{random.next()} - 2)));
        ASSERT_TRUE(instance);
        const auto triangle = static_cast<std::uint32_t>(random.next() * static_cast<float>(mesh.triangles.size()));
        const Vec2 b = square_to_triangle(random.next_2d());
        const SurfaceGeometry s = carried_to_scene(*instance, surface_at(shape, triangle, b.x(), b.y(), Vec3::Zero()));
        Vec3d v[3];
        for (std::size_t k = 0; k < 3; ++k)
            v[k] = mesh.vertex(mesh.triangles[triangle][k]).cast<double>();
        const Vec3d n = (v[1] - v[0]).cross(v[2] - v[0]);
        for (const float side : {1.f, -1.f}) {
            const Vec3 w = side * s.ng;
            const Vec3d o = carried_to_group(*instance, {offset_origin(s, w), w}).o.cast<double>();
            // The distance is in units of the offset, of which rounding errors may use up to a half.
            const double map = (instance->inverse.transpose() * n.normalized()).norm();
            const double distance = static_cast<double>(side) * (o - v[0]).dot(n.normalized()) / map;
            nearest = std::min(nearest, distance / double{s.offset});
        }
    }
    EXPECT_GT(nearest, 0.4);
}

std::size_t resident_bytes() {
    std::ifstream file("/proc/self/statm");
    std::size_t pages = 0, resident = 0;
    file >> pages >> resident;
    return resident * 4096;
}

TEST(Instance, ManyInstancesTakeMemoryThatDoesNotGrowWithTheMesh) {
    constexpr std::size_t count = 100'000;
    Random random(5);
    std::vector<Mat4d> places;
    for (std::size_t i = 0; i < count; ++i)
        places.push_back(any_affine(random, 500));
    const TemporaryFolder folder;
    const auto growth = [&](int rings) {
        const auto loaded = load(file_shape(folder.write("m.obj", blob(rings, false))));
        const std::size_t before = resident_bytes();
        SceneParts parts;
        parts.groups = {{{loaded.scene->shapes()[0], 0, std::nullopt}}};
        for (const Mat4d& place : places)
            parts.instances.push_back(*make_instance(0, place));
        parts.materials = loaded.scene->materials();
        parts.sensor = loaded.scene->sensor();
        const gib::Scene scene(std::move(parts));
        EXPECT_EQ(scene.instances().size(), count);
        const Vec3 p = places[count / 2].topRightCorner<3, 1>().cast<float>();
        EXPECT_TRUE(scene.intersect({2.f * p, -p}));
        return resident_bytes() - before;
    };
    growth(4);                                                // for allocations that happen only once
    const std::size_t small = growth(4), large = growth(40);  // 48 and 6240 triangles
    // If instances were flattened, the indices of the large mesh alone would take 7.5 GB.
    EXPECT_LT(large, small + (std::size_t{100} << 20)) << small << " " << large;
    EXPECT_LT(large, std::size_t{600} << 20);
    RecordProperty("bytes_per_instance", static_cast<int>(large / count));
}

}  // namespace
}  // namespace gib::test::instance_test
