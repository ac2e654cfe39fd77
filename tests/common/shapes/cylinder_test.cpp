// Tests of the cylinder: rays meet it where the formula says, its sampled points are uniform, and it can be a lamp.

#include "common/sampling/sampler.h"
#include "common/scene/scene.h"
#include "tests/support/moments.h"
#include "tests/support/random.h"
#include "tests/support/scene_builder.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

namespace gib::test::cylinder_test {
namespace {

/// A random cylinder at any place and of any size; it may be much longer than wide or much wider than long.
Cylinder any_cylinder(Random& random) {
    const auto magnitude = [&] { return std::pow(10.f, 4.f * random.next() - 2.f); };
    const Frame frame(random.direction());
    const float length = magnitude();
    return {magnitude() * random.direction(), length * frame.n, frame.s, frame.t, magnitude(), random.next() < 0.5f};
}

/// The distance of p from the axis, in double.
double distance_from_axis(const Cylinder& c, const Vec3& p) {
    const Vec3d axis = c.axis.cast<double>().normalized(), d = p.cast<double>() - c.base.cast<double>();
    return (d - d.dot(axis) * axis).norm();
}

/// The first root of the textbook's quadratic that lies on the cylinder, in long double.
std::optional<long double> textbook_hit(const Cylinder& c, const Ray& ray) {
    using V = Eigen::Matrix<long double, 3, 1>;
    const V axis = c.axis.cast<long double>(), o = ray.o.cast<long double>() - c.base.cast<long double>();
    const V d = ray.d.cast<long double>();
    const V across_o = o.cross(axis) / axis.norm(), across_d = d.cross(axis) / axis.norm();
    const long double a = across_d.squaredNorm(), b = across_o.dot(across_d);
    const long double radius = static_cast<long double>(c.radius), rest = across_o.squaredNorm() - radius * radius;
    const long double discriminant = b * b - a * rest;
    if (discriminant < 0) return std::nullopt;
    for (const int sign : {-1, 1}) {
        const long double t = (-b + sign * std::sqrt(discriminant)) / a;
        const long double v = (o + t * d).dot(axis) / axis.squaredNorm();
        if (t > static_cast<long double>(ray.t_min) && t < static_cast<long double>(ray.t_max) && v >= 0 && v <= 1)
            return t;
    }
    return std::nullopt;
}

TEST(Cylinder, RaysMeetItWhereTheFormulaSays) {
    Random random(1);
    int hits = 0;
    for (int i = 0; i < 100'000; ++i) {
        const Cylinder c = any_cylinder(random);
        const float size = c.axis.norm() + c.radius;
        const Vec3 target = c.base + random.next() * c.axis + 1.2f * c.radius * random.direction();
        const Vec3 o = target + size * 2.f * random.next() * random.direction();
        Ray ray{o, (target - o).normalized() * (0.5f + random.next())};
        if (random.next() < 0.3f) ray.t_max = 3.f * size * random.next();
        if (random.next() < 0.3f) ray.t_min = size * random.next();
        const auto expected = textbook_hit(c, ray);
        const auto found = intersect(c, ray);
        // A ray at the rim or a grazing ray may hit or miss by rounding.
        if (expected.has_value() != found.has_value()) {
            Cylinder wider = c, narrower = c;
            wider.radius *= 1 + 1e-6f;
            narrower.radius *= 1 - 1e-6f;
            EXPECT_NE(textbook_hit(wider, ray).has_value(), textbook_hit(narrower, ray).has_value());
            continue;
        }
        if (!found) continue;
        ++hits;
        const auto distance = static_cast<double>(*expected);
        EXPECT_NEAR(double{*found}, distance, 1e-6 * distance);
    }
    EXPECT_GT(hits, 20'000);
}

TEST(Cylinder, RaysAlongItsAxisMissIt) {
    const Cylinder c{Vec3::Zero(), Vec3(0, 0, 2), Vec3::UnitX(), Vec3::UnitY(), 1};
    EXPECT_FALSE(intersect(c, {Vec3(0.5f, 0, -1), Vec3::UnitZ()}));
    EXPECT_FALSE(intersect(c, {Vec3(1, 0, -1), Vec3::UnitZ()}));
    EXPECT_FALSE(intersect(c, {Vec3(2, 0, -1), Vec3::UnitZ()}));
    // This ray passes the open end and meets the wall from inside.
    const auto t = intersect(c, {Vec3(0, 0, -1), Vec3(1, 0, 2)});
    ASSERT_TRUE(t);
    EXPECT_FLOAT_EQ(*t, 1);
    EXPECT_FALSE(intersect(c, {Vec3(0, 0, -1), Vec3(1, 0, 4)}));
}

TEST(Cylinder, RaysThatLeaveItDoNotMeetTheSamePointAgain) {
    Random random(2);
    for (int i = 0; i < 100'000; ++i) {
        const Cylinder c = any_cylinder(random);
        const SurfacePoint q = AreaSampler(c).sample(c, random.next_2d());
        // Both a sampled point (q) and a point as rays find it (s) are tested.
        const SurfaceGeometry s = surface_at(c, 0, 0, 0, q.p + 0.1f * c.radius * random.direction());
        for (const SurfacePoint& from : {q, static_cast<const SurfacePoint&>(s)}) {
            EXPECT_NEAR(from.ng.norm(), 1, 1e-6);
            EXPECT_LE(std::abs(distance_from_axis(c, from.p) - double{c.radius}), 0.5 * double{from.offset});
            const Vec3 outward = c.flip_normals ? Vec3(-from.ng) : from.ng;
            const Vec3 w = random.direction();
            const float cosine = w.dot(outward);
            const auto t = intersect(c, {offset_origin(from, w), w});
            if (cosine >= 0) {
                EXPECT_FALSE(t) << cosine;
            } else if (t) {
                // The ray meets the far wall: the chord is 2 R cos(w, normal) / sin^2(w, axis).
                const float across2 = 1.f - sqr(w.dot(c.axis) / c.axis.norm());
                const float chord = -2.f * c.radius * cosine / across2;
                EXPECT_NEAR(*t, chord, 1e-3f * chord + 4.f * from.offset / std::abs(cosine));
                EXPECT_GT(*t, 0.25f * chord);
            }
        }
    }
}

TEST(Cylinder, BoundsTouchIt) {
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const Cylinder c = any_cylinder(random);
        const AreaSampler surface(c);
        Bounds points;
        for (int k = 0; k < 4000; ++k)
            points.add(surface.sample(c, random.next_2d()).p);
        const Bounds bounds = bounds_of(c);
        const float size = bounds.diagonal();
        for (int k = 0; k < 3; ++k) {
            EXPECT_LT(bounds.lower[k], points.lower[k] + 1e-5f * size);
            EXPECT_GT(bounds.upper[k], points.upper[k] - 1e-5f * size);
            EXPECT_GT(bounds.lower[k], points.lower[k] - 0.03f * size);
            EXPECT_LT(bounds.upper[k], points.upper[k] + 0.03f * size);
        }
    }
}

}  // namespace
}  // namespace gib::test::cylinder_test
