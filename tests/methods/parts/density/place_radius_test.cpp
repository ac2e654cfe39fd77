// The radius of look-ups by place: no larger than the body there, the same from both sides, and unbounded on large surfaces.
#include "methods/parts/density/place_radius.h"

#include "tests/methods/parts/density/density_fixtures.h"

namespace gib::test::place_radius_test {
namespace {

/// The radius at what the ray meets, if that on large surfaces is 1.
float radius_at(const LoadedScene& scene, const Ray& ray) {
    RayQueries rays(*scene.scene);
    const auto hit = scene.scene->intersect(ray);
    return share_of_radius_at(rays, *hit, -ray.d, 1.f);
}

// The normal of a sphere has turned by acos(0.9) at the distance 0.436 R from the axis. Halving stops between half of it and it.
TEST(PlaceRadius, OfASphereIsItsSize) {
    for (const double R : {2.0, 0.7, 0.2, 0.05, 0.004}) {
        const std::string step = translate(0.3, 0.2, 0);
        const LoadedScene scene = scene_of_shapes(shape("sphere", radius(R), to_world(step), diffuse(1.0)));
        for (const float x : {0.f, 0.4f, 0.8f}) {
            const float r = radius_at(scene, down_at(0.3f + x * static_cast<float>(R), 0.2f, 5.f));
            EXPECT_LE(double{r}, std::min(1., 0.436 * R)) << R << ' ' << x;
            EXPECT_GT(double{r}, std::min(0.999, 0.2179 * R)) << R << ' ' << x;
        }
    }
}

// A square of side 2 a: the centre's disc may reach to the corners at most; on an edge half of the directions stay on it.
TEST(PlaceRadius, OfASquareIsItsSizeAlsoAtItsEdges) {
    for (const double a : {0.5, 0.06, 0.003}) {
        const LoadedScene scene = scene_of_shapes(white("rectangle", scale(a)));
        const auto side = static_cast<float>(a);
        for (const Vec2& at : {Vec2(0, 0), Vec2(0.3f, -0.4f), Vec2(0.999f, 0), Vec2(0, -0.999f)}) {
            const float r = radius_at(scene, down_at(side * at.x(), side * at.y()));
            EXPECT_LE(double{r}, 2 * std::sqrt(2.) * a) << a << at.transpose();
            EXPECT_GT(double{r}, 0.4999 * a) << a << at.transpose();
        }
    }
}

// Close to a straight edge four of eight directions stay on the surface, and a fifth only if it runs along the edge. Four
// have to be enough, because the part of the disc beyond the edge is known (SurfaceDisc::covered()).
TEST(PlaceRadius, IsUnboundedAtAStraightEdge) {
    for (const double turned : {0., 10., 22.5, 40.}) {
        const LoadedScene scene = scene_of_shapes(white("rectangle", scale(5) + rotate('z', turned)));
        const float angle = static_cast<float>(turned) * pi / 180.f, c = std::cos(angle), s = std::sin(angle);
        const Vec2 p(4.999f * c - 0.3f * s, 4.999f * s + 0.3f * c);
        EXPECT_EQ(radius_at(scene, down_at(p.x(), p.y())), 1.f) << turned;
    }
}

// Half a unit off the diagonal of a square, the disc lies in one triangle, and no probe is needed.
TEST(PlaceRadius, OfALargeTriangleTakesNoRays) {
    const LoadedScene scene = scene_of_shapes(white("rectangle", scale(5)));
    for (const float off_diagonal : {0.5f, 1.5f}) {
        RayQueries rays(*scene.scene);
        const Ray ray = down_at(off_diagonal * std::sqrt(2.f), 0.f);
        EXPECT_EQ(share_of_radius_at(rays, *scene.scene->intersect(ray), -ray.d, 1.f), 1.f);
        EXPECT_EQ(rays.count() == 0, off_diagonal > 1.f);
    }
}

}  // namespace
}  // namespace gib::test::place_radius_test
