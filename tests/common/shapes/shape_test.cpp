// Tests of shapes: their texture coordinates, and the derivatives of their points by these.

#include "common/shapes/shape.h"
#include "common/sampling/sampler.h"
#include "common/scene/scene.h"
#include "common/shapes/few_spheres.h"
#include "tests/support/random.h"
#include "tests/support/scene_builder.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

namespace gib::test::shape_test {
namespace {

Shape shape_of(const std::string& xml) { return load(xml).scene->shapes()[0]; }

const std::string turned = to_world(scale(3), "<rotate x='1' y='2' z='-0.5' angle='50'/>", translate(1, -2, 5));
const std::string mirrored = to_world(scale(-2, 2, 2), "<rotate x='1' y='-1' z='0.5' angle='70'/>");
const std::string flipped = flag("flip_normals");

/// A point of a shape, and another one at a distance of `h` in a random direction on the
/// surface, on the same triangle.
struct Neighbours {
    std::uint32_t primitive = 0;
    SurfaceGeometry a, b;
};

Neighbours neighbours_on(const Shape& s, Random& random, float h) {
    Neighbours n;
    if (const auto* mesh = std::get_if<Mesh>(&s)) {
        const auto count = static_cast<float>(mesh->triangles.size());
        n.primitive = static_cast<std::uint32_t>(random.next() * count);
        // All three weights of `at` are 2 h or more, so that a step stays on the triangle.
        const Vec2 at = (1.f - 6.f * h) * square_to_triangle(random.next_2d()) + Vec2::Constant(2.f * h);
        const Vec2 step = h * square_to_disk(random.next_2d());
        n.a = surface_at(s, n.primitive, at.x(), at.y(), Vec3::Zero());
        n.b = surface_at(s, n.primitive, at.x() + step.x(), at.y() + step.y(), Vec3::Zero());
        return n;
    }
    const Bounds bounds = bounds_of(s);
    n.a = surface_at(s, 0, 0, 0, bounds.center() + 0.4f * bounds.diagonal() * random.direction());
    n.b = surface_at(s, 0, 0, 0, n.a.p + h * bounds.diagonal() * random.direction());
    return n;
}

/// Largest |dp - (dp_du du + dp_dv dv)| / |dp| over random neighbours.
double worst_difference(const Shape& s, std::uint64_t seed) {
    Random random(seed);
    double worst = 0;
    for (int i = 0; i < 2000; ++i) {
        const Neighbours n = neighbours_on(s, random, 2e-3f);
        const Vec2 duv = n.b.uv - n.a.uv;
        // The angle wraps around, and has no finite differences near a pole.
        if (!std::holds_alternative<Mesh>(s) && duv.cwiseAbs().maxCoeff() > 0.01f) continue;
        // With derivatives in the middle of the two points, the error is of second order.
        SurfaceGeometry middle = n.a;
        middle.uv = 0.5f * (n.a.uv + n.b.uv);
        middle.ng = (n.a.ng + n.b.ng).normalized();
        const SurfaceDerivatives d = derivatives_at(s, n.primitive, middle);
        const Vec3 dp = n.b.p - n.a.p;
        const double length = double{dp.norm()};
        if (length < 2e-4 * static_cast<double>(bounds_of(s).diagonal())) continue;  // too short for float's digits
        worst = std::max(worst, static_cast<double>((dp - duv.x() * d.dp_du - duv.y() * d.dp_dv).norm()) / length);
    }
    return worst;
}

TEST(SurfaceParametrisation, DerivativesAreThoseOfThePoint) {
    const TemporaryFolder folder;
    folder.write("m.obj",
                 "v 0 0 0\nv 2 0 1\nv 0 1 0\nv 1 2 -1\nvt 0.2 0.3\nvt 0.9 -0.4\nvt 3 1\nvt 0 7\n"
                 "f 1/1 2/2 3/3\nf 4/4 3/1 2/3\n");
    const std::string file = filename(folder / "m.obj");
    std::uint64_t seed = 1;
    for (const std::string& placed : {std::string(), turned, mirrored, turned + flipped}) {
        for (const std::string type : {"sphere", "disk", "cylinder", "rectangle", "cube"})
            EXPECT_LT(worst_difference(shape_of(shape(type, placed)), seed++), 0.01) << type << placed;
        EXPECT_LT(worst_difference(shape_of(shape("obj", file + placed)), seed++), 0.01) << placed;
    }
    EXPECT_LT(worst_difference(shape_of(shape("disk", to_world(scale(4, 0.5, 1)))), seed++), 0.01);
}

void expect_uv(const Shape& s, const Vec3& p, const Vec2& uv) {
    EXPECT_LT((surface_at(s, 0, 0, 0, p).uv - uv).norm(), 1e-6f) << p.transpose();
}

TEST(SurfaceParametrisation, SpheresHaveLongitudeAndLatitudeInTheirOwnAxes) {
    const Shape plain = shape_of(shape("sphere"));
    expect_uv(plain, Vec3(1, 0, 0), Vec2(0, 0.5f));
    expect_uv(plain, Vec3(0, 1, 0), Vec2(0.25f, 0.5f));
    expect_uv(plain, Vec3(-1, 1e-6f, 0), Vec2(0.5f, 0.5f));
    expect_uv(plain, Vec3(0, -1, 1), Vec2(0.75f, 0.25f));
    expect_uv(plain, Vec3(0, 0, 1), Vec2(0, 0));
    expect_uv(plain, Vec3(0, 0, -1), Vec2(0, 1));
    // The rotation takes x to y and y to -x.
    const Shape quarter = shape_of(shape("sphere", to_world(scale(2), rotate('z', 90))));
    expect_uv(quarter, Vec3(0, 2, 0), Vec2(0, 0.5f));
    expect_uv(quarter, Vec3(-2, 0, 0), Vec2(0.25f, 0.5f));
    const Shape mirror = shape_of(shape("sphere", to_world(scale(1, -1, 1))));
    expect_uv(mirror, Vec3(0, 1, 0), Vec2(0.75f, 0.5f));
    expect_uv(mirror, Vec3(1, 0, 0), Vec2(0, 0.5f));
}

TEST(SurfaceParametrisation, SpheresKeepTheirDigitsNearThePoles) {
    const Shape s = shape_of(shape("sphere"));
    EXPECT_NEAR(surface_at(s, 0, 0, 0, Vec3(1e-5f, 0, 1)).uv.y(), 1e-5 / std::numbers::pi, 1e-11);
}

TEST(SurfaceParametrisation, DisksHaveRadiusAndAngle) {
    const Shape s = shape_of(shape("disk", to_world(scale(4, 2, 1)) + flipped));
    expect_uv(s, Vec3(4, 0, 0), Vec2(1, 0));
    expect_uv(s, Vec3(0, 1, 0), Vec2(0.5f, 0.25f));
    expect_uv(s, Vec3(-2, 0, 0), Vec2(0.5f, 0.5f));
    expect_uv(s, Vec3(0, -2, 0), Vec2(1, 0.75f));
    expect_uv(s, Vec3(0, 0, 0), Vec2(0, 0));
}

/// Expects tangents that are not degenerate, and are at right angles to each other and to the normal.
void expect_basis(const SurfaceGeometry& at, const SurfaceDerivatives& d) {
    const Vec3 u = d.dp_du.normalized(), v = d.dp_dv.normalized();
    EXPECT_NEAR(u.norm(), 1, 1e-5);
    EXPECT_NEAR(v.norm(), 1, 1e-5);
    EXPECT_NEAR(u.dot(v), 0, 1e-5);
    EXPECT_NEAR(u.dot(at.ng), 0, 1e-5);
    EXPECT_NEAR(v.dot(at.ng), 0, 1e-5);
}

TEST(SurfaceParametrisation, CylindersHaveTheAngleAndTheHeight) {
    const Shape s = shape_of(shape("cylinder", point("p0", 0, 0, -2) + point("p1", 0, 0, 2) + radius(3) + flipped));
    expect_uv(s, Vec3(3, 0, -2), Vec2(0, 0));
    expect_uv(s, Vec3(0, 3, 1), Vec2(0.25f, 0.75f));
    expect_uv(s, Vec3(0, -3, 2), Vec2(0.75f, 1));
    const Shape mirror = shape_of(shape("cylinder", to_world(scale(1, -1, 4))));
    expect_uv(mirror, Vec3(0, 1, 1), Vec2(0.75f, 0.75f));
}

TEST(SurfaceParametrisation, SampledPointsHaveTheUvOfTheirPlace) {
    Random random(9);
    for (const std::string type : {"sphere", "disk", "cylinder", "rectangle", "cube"}) {
        const Shape s = shape_of(shape(type, turned));
        const AreaSampler surface(s);
        for (int i = 0; i < 500; ++i) {
            const Vec2 u = random.next_2d();
            const SurfacePoint plain = surface.sample(s, u);
            const SurfaceGeometry at = surface.sample_geometry(s, u);
            EXPECT_LT((at.p - plain.p).norm(), 1e-5f) << type;
            EXPECT_LT((at.ng - plain.ng).norm(), 1e-5f) << type;
            if (!std::holds_alternative<Mesh>(s)) {
                EXPECT_EQ(at.uv, surface_at(s, 0, 0, 0, plain.p).uv) << type;
            } else {
                // On one of the triangles, a step along the derivatives from a corner to the uv leads to the point.
                const auto& mesh = std::get<Mesh>(s);
                double nearest = 1;
                for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
                    const SurfaceGeometry corner = surface_at(s, k, 0, 0, Vec3::Zero());
                    const SurfaceDerivatives d = derivatives_at(s, k, corner);
                    const Vec2 step = at.uv - corner.uv;
                    const Vec3 reached = corner.p + step.x() * d.dp_du + step.y() * d.dp_dv;
                    nearest = std::min(nearest, static_cast<double>((reached - at.p).norm()));
                }
                EXPECT_LT(nearest, 1e-4) << type;
            }
        }
    }
}

TEST(SurfaceParametrisation, IsDefinedWhereTheAngleIsNot) {
    for (const std::string& placed : {std::string(), turned}) {
        const Shape sphere = shape_of(shape("sphere", placed)), disk = shape_of(shape("disk", placed));
        const auto& s = std::get<Sphere>(sphere);
        for (const float side : {1.f, -1.f}) {
            const SurfaceGeometry pole = surface_at(sphere, 0, 0, 0, s.center + side * s.axes.col(2));
            expect_basis(pole, derivatives_at(sphere, 0, pole));
        }
        const SurfaceGeometry center = surface_at(disk, 0, 0, 0, std::get<Disk>(disk).center);
        expect_basis(center, derivatives_at(disk, 0, center));
    }
}

/// The uv where a ray along -z from above (x, y) hits the mesh file m.`type` with `body` in its element.
Vec2 uv_from_above(const TemporaryFolder& folder, const std::string& type, const std::string& body, float x, float y) {
    const std::string name = folder / ("m." + type);
    const auto loaded = load(shape(type, filename(name) + body));
    const auto hit = loaded.scene->intersect({Vec3(x, y, 5) - loaded.scene->bounds().center(), Vec3(0, 0, -1)});
    // The ray starts at the file's (x, y, 5); the origin of the loaded scene is the centre of its bounds.
    EXPECT_TRUE(hit) << type << body;
    return hit ? hit->uv : Vec2(-1, -1);
}

TEST(SurfaceParametrisation, MeshFilesAreFlippedAsMitsubaFlipsThem) {
    const TemporaryFolder folder;
    // The meshes are symmetric around the origin, so that loading does not move them.
    folder.write("m.obj",
                 "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    folder.write(
        "m.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
        "-1 -1 0 0 0\n1 -1 0 1 0\n1 1 0 1 1\n-1 1 0 0 1\n4 0 1 2 3\n");
    const Vec2 as_stored(0.75f, 0.25f), turned_over(0.75f, 0.75f);
    for (const auto& [type, body, uv] : {std::tuple("obj", std::string(), turned_over),
                                         {"obj", flag("flip_tex_coords"), turned_over},
                                         {"obj", flag("flip_tex_coords", false), as_stored},
                                         {"ply", std::string(), as_stored},
                                         {"ply", flag("flip_tex_coords"), turned_over}})
        EXPECT_LT((uv_from_above(folder, type, body, 0.5f, -0.5f) - uv).norm(), 1e-6f) << type << body;
}

/// As in Mitsuba, meshes are smooth unless face_normals is set, even if the file has no normals.
TEST(MeshNormals, FollowTheOptionsInEveryFormat) {
    const TemporaryFolder folder;
    const std::string points[] = {"-1 -1 0", "1 -1 0", "1 1 1", "-1 1 0"};
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string faces = "element face 2\nproperty list uchar int vertex_index\nend_header\n";
    std::string obj, obj_normals,
        ply = header + faces,
        ply_normals = header + "property float nx\nproperty float ny\nproperty float nz\n" + faces;
    for (const auto& p : points) {
        obj += "v " + p + "\n";
        obj_normals += "v " + p + "\nvn 0 3 4\n";
        ply += p + "\n";
        ply_normals += p + " 0 3 4\n";
    }
    folder.write("bare.obj", obj + "f 1 2 3\nf 1 3 4\n");
    folder.write("full.obj", obj_normals + "f 1//1 2//2 3//3\nf 1//1 3//3 4//4\n");
    folder.write("bare.ply", ply + "3 0 1 2\n3 0 2 3\n");
    folder.write("full.ply", ply_normals + "3 0 1 2\n3 0 2 3\n");
    for (const std::string type : {"obj", "ply"}) {
        const auto mesh = [&](const std::string& name, const std::string& body) {
            const std::string path = folder / (name + "." + type);
            return std::get<Mesh>(shape_of(shape(type, filename(path) + body)));
        };
        const std::string faceted = flag("face_normals");
        const Mesh bare = mesh("bare", ""), full = mesh("full", "");
        ASSERT_EQ(bare.normals.size(), 4u) << type;
        EXPECT_LT((bare.normals[1] - bare.normal_of(0).normalized().cast<float>()).norm(), 1e-6f) << type;
        EXPECT_GT((bare.normals[0] - bare.normal_of(0).normalized().cast<float>()).norm(), 0.1f) << type;
        ASSERT_EQ(full.normals.size(), 4u) << type;
        EXPECT_LT((full.normals[3] - Vec3(0, 0.6f, 0.8f)).norm(), 1e-6f) << type;
        EXPECT_TRUE(mesh("bare", faceted).normals.empty()) << type;
        EXPECT_TRUE(mesh("full", faceted).normals.empty()) << type;
        // flip_normals turns both the geometric and the shading normal.
        const Shape turned_over = mesh("full", flipped);
        const SurfaceGeometry at = surface_at(turned_over, 0, 0.3f, 0.3f, Vec3::Zero());
        EXPECT_LT(at.ng.z(), 0.f) << type;
        EXPECT_LT((at.ns + Vec3(0, 0.6f, 0.8f)).norm(), 1e-6f) << type;
    }
}

TEST(SurfaceParametrisation, MeshesWithoutUvHaveBarycentricOnesAndABasisOfTheNormal) {
    const TemporaryFolder folder;
    const std::string triangle = "v -1 -1 0\nv 1 -1 0\nv -1 1 0\nv 1 1 0\n";
    for (const std::string faces : {"f 1 2 3\n", "vn 0 0 1\nf 1//1 2//1 3//1\n"}) {
        folder.write("m.obj", triangle + faces);
        const Vec2 expected(0.25f, 0.1f), plain = uv_from_above(folder, "obj", "", -0.5f, -0.8f);
        EXPECT_LT((plain - expected).norm(), 1e-6f) << faces;
        // A mirror moves the corners but keeps their order.
        const Vec2 mirror = uv_from_above(folder, "obj", to_world(scale(-1, 1, 1)), 0.5f, -0.8f);
        EXPECT_LT((mirror - expected).norm(), 1e-6f) << faces;
    }
    // If the uv lie on a line they span no area either, and give no basis.
    folder.write("m.obj", triangle + "vt 0 0\nvt 1 1\nvt 2 2\nf 1/1 2/2 3/3\n");
    const std::string file = filename(folder / "m.obj");
    for (const std::string& body : {turned, turned + flipped}) {
        const Shape s = shape_of(shape("obj", file + body));
        const SurfaceGeometry at = surface_at(s, 0, 0.2f, 0.2f, Vec3::Zero());
        const SurfaceDerivatives d = derivatives_at(s, 0, at);
        const Frame expected(body == turned ? at.ng : Vec3(-at.ng));
        EXPECT_EQ(d.dp_du, expected.s);
        EXPECT_EQ(d.dp_dv, expected.t);
    }
}

// The data that a large mesh prepares for its points, on memory pages of its own, does not change the points.
TEST(Mesh, ItsPointsAreTheSameBeforeAndAfterItIsPrepared) {
    constexpr std::size_t triangles = 300'000;  // 19 MB of facets
    Random random(11);
    Mesh mesh;
    mesh.flip_normals = true;
    for (std::size_t i = 0; i < 3 * triangles + 1; ++i)  // the last one is the padding
        mesh.vertices.push_back({random.next(), random.next(), 100.f + random.next()});
    for (std::uint32_t i = 0; i < triangles; ++i)
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    Mesh prepared = mesh;
    prepared.prepare();
    ASSERT_EQ(prepared.facets.size(), triangles);
    for (std::size_t i = 0; i < triangles; i += 7) {
        const Vec2 b = square_to_triangle(random.next_2d());
        const SurfacePoint a = mesh.point_at(i, b.x(), b.y()), c = prepared.point_at(i, b.x(), b.y());
        ASSERT_EQ(a.p, c.p);
        ASSERT_EQ(a.ng, c.ng);
        ASSERT_EQ(a.offset, c.offset);
        const auto corner = [&](std::size_t k) { return mesh.vertex(mesh.triangles[i][k]).cast<double>().eval(); };
        const Vec3d n = (corner(2) - corner(0)).cross(corner(1) - corner(0));
        const Vec3d expected = corner(0) + b.x() * (corner(1) - corner(0)) + b.y() * (corner(2) - corner(0));
        const double weights[3] = {1. - b.x() - b.y(), b.x(), b.y()};
        bool at_an_edge = false;  // points are kept off edges
        for (std::size_t k = 0; k < 3; ++k)
            at_an_edge |= weights[k] * n.norm() / (corner((k + 2) % 3) - corner((k + 1) % 3)).norm() < 5e-5;
        if (at_an_edge) continue;
        ASSERT_LT((expected - a.p.cast<double>()).norm(), 4e-5) << "ulps of 100 in three sums";
        ASSERT_GT(n.dot(a.ng.cast<double>()), 0.999 * n.norm());
    }
}

/// Tests the area and the normal of a triangle with exactly these vertices times `scale`, a power of two. The
/// triangle must be one whose area in float is wrong.
void expect_area_and_normal(const std::array<Vec3, 3>& vertices, float scale) {
    Mesh mesh;
    for (const Vec3& v : vertices)
        mesh.vertices.push_back({scale * v.x(), scale * v.y(), scale * v.z()});
    mesh.triangles = {{0, 1, 2}};
    const auto edge = [&](std::uint32_t i) { return Vec3(mesh.vertex(i) - mesh.vertex(0)); };
    const auto exact_edge = [&](std::uint32_t i) -> Eigen::Matrix<long double, 3, 1> {
        return mesh.vertex(i).cast<long double>() - mesh.vertex(0).cast<long double>();
    };
    const Eigen::Matrix<long double, 3, 1> n = exact_edge(1).cross(exact_edge(2));
    const auto area = static_cast<double>(0.5L * n.norm());
    const auto float_area = static_cast<double>(0.5f * edge(1).cross(edge(2)).norm());
    ASSERT_GT(std::abs(float_area - area), 0.01 * area) << "not hard";
    EXPECT_NEAR(area_of(mesh), area, 1e-12 * area) << vertices[0].transpose() << " * " << scale;
    const Vec3d expected = (n / n.norm()).cast<double>(), ng = mesh.point_at(0, 0.f, 0.f).ng.cast<double>();
    EXPECT_LT((ng - expected).norm(), 1e-6) << vertices[0].transpose() << " * " << scale;
}

// These triangles have a longest edge squared over twice the area of 1e6, 1e7 and 1e9.
TEST(Mesh, NeedlesHaveTheAreaAndTheNormalOfTheirVertices) {
    for (const float scale : {1.f, 0x1p-22f, 0x1p-80f}) {
        expect_area_and_normal(
            {Vec3(6796150, 288062, -8056890), Vec3(6471759, -325822, -6986163), Vec3(6514206, -245494, -7126272)},
            scale);
        expect_area_and_normal(
            {Vec3(-4865363, 8118331, 8122465), Vec3(-2966817, 9979794, 9868643), Vec3(-4107220, 8861666, 8819763)},
            scale);
        expect_area_and_normal(
            {Vec3(-884643, -6107212, -2083301), Vec3(-1033212, -4443210, -4432164), Vec3(-967921, -5174482, -3399919)},
            scale);
    }
}

// These triangles have a longest edge squared over twice the area of 1e6 and 1e9. The differences of their vertices
// have 25 bits; rounded to float, they would be the edges of another triangle.
TEST(Mesh, NeedlesHaveTheAreaOfTheirVerticesWhereEdgesAreNoFloats) {
    for (const float scale : {1.f, 0x1p-22f}) {
        expect_area_and_normal(
            {Vec3(14564178, 14608682, -9608634), Vec3(8576722, -2786135, -361932), Vec3(9480508, -160503, -1757674)},
            scale);
        expect_area_and_normal(
            {Vec3(14541176, -2630986, 16574943), Vec3(-6707071, 15811223, 938772), Vec3(5502191, 5214313, 9923330)},
            scale);
    }
}

// Far from the origin, the points of a small sphere round to its centre.
TEST(Spheres, HaveANormalWhereTheirRadiusIsLost) {
    const Vec3 center(37, 20, 5);
    const SurfaceGeometry at = surface_at_analytic(Shape(Sphere{center, 1e-8f}), center);
    EXPECT_NEAR(at.ng.norm(), 1.f, 1e-6f);
}

/// The first hit of a ray with each sphere alone, and whether there is any: what FewSpheres finds with all at once. Half of the rays
/// start on a sphere, and half lead to its rim, where rounding decides.
TEST(FewSpheres, FindWhatEachSphereFindsAlone) {
    for (const float unit : {1e-20f, 1e-12f, 1e-3f, 1.f, 1e6f, 1e15f}) {
        Random random(7);
        std::array<Sphere, FewSpheres::most> spheres;
        FewSpheres together;
        for (std::uint32_t i = 0; i < spheres.size(); ++i) {
            spheres[i] = {.center = unit * 3.f * random.direction(),
                          .radius = unit * std::exp2(-2.f * static_cast<float>(i))};
            together.add(spheres[i], 10 + i);
        }
        int hits = 0;
        for (std::size_t n = 0; n < 40000; ++n) {
            const Sphere &from = spheres[n % 8], &to = spheres[n / 8 % 8];
            const SurfacePoint start = surface_at_analytic(from, from.center + unit * random.direction(), false);
            const Vec3 w = random.direction();
            const Vec3 o = n % 2 == 0 ? offset_origin(start, w) : Vec3(5.f * unit * random.direction());
            const Vec3 towards = to.center - o, across = towards.cross(w).normalized();
            const float sine = to.radius / towards.norm();
            const Vec3 rim = to.center + to.radius * (std::sqrt(std::max(1.f - sine * sine, 0.f)) * across -
                                                      sine * towards.normalized());
            const Ray ray{.o = o, .d = n % 4 < 2 ? w : Vec3(rim - o), .t_max = n % 3 == 0 ? 1.f : infinity};
            Ray rest = ray;
            std::uint32_t first = FewSpheres::none;
            for (std::uint32_t i = 0; i < spheres.size(); ++i)
                if (const auto t = intersect(spheres[i], rest)) {
                    rest.t_max = *t;
                    first = 10 + i;
                }
            float t_max = ray.t_max;
            ASSERT_EQ(together.intersect(ray, t_max), first) << unit << ' ' << n;
            ASSERT_EQ(t_max, rest.t_max);
            ASSERT_EQ(together.occluded(ray), first != FewSpheres::none);
            if (first != FewSpheres::none) ++hits;
        }
        EXPECT_GT(hits, 10000);
    }
}

}  // namespace
}  // namespace gib::test::shape_test
