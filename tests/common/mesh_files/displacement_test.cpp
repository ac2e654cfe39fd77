// Tests of displaced meshes: subdivision, heights, normals, and what a scene file may ask for.

#include "common/mesh_files/displacement.h"

#include "common/scene/scene.h"
#include "tests/support/mesh_area.h"
#include "tests/support/scene_errors.h"

#include <map>

namespace gib::test::displacement_test {
namespace {

/// The square [0, 1]^2 in z = 0 with its front towards +z; uv are x and y.
MeshData square() {
    MeshData mesh;
    mesh.positions = {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(1, 1, 0), Vec3d(0, 1, 0)};
    mesh.uvs = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// A ball of radius 2 about the origin whose vertices lie on it, with its normals.
MeshData ball() {
    MeshData mesh;
    mesh.positions = {Vec3d::UnitX(),  -Vec3d::UnitX(), Vec3d::UnitY(),
                      -Vec3d::UnitY(), Vec3d::UnitZ(),  -Vec3d::UnitZ()};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    EXPECT_TRUE(subdivide(mesh, 0.1));
    for (Vec3d& p : mesh.positions) {
        p.normalize();
        mesh.normals.push_back(p.cast<float>());
        p *= 2;
    }
    return mesh;
}

double longest_edge(const MeshData& mesh) {
    double longest = 0;
    for (const auto& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i)
            longest = std::max(longest, (mesh.positions[t[i]] - mesh.positions[t[(i + 1) % 3]]).norm());
    return longest;
}

/// The number of edges, by the places of their ends, that do not belong to two triangles in opposite directions.
int open_edges(const MeshData& mesh) {
    using Place = std::array<double, 3>;
    std::map<std::pair<Place, Place>, int> uses;
    const auto place = [&](std::uint32_t i) {
        const Vec3d& p = mesh.positions[i];
        return Place{p.x(), p.y(), p.z()};
    };
    for (const auto& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const Place a = place(t[i]), b = place(t[(i + 1) % 3]);
            uses[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    return static_cast<int>(std::count_if(uses.begin(), uses.end(), [](const auto& use) { return use.second != 0; }));
}

TEST(Subdivision, HalvesLongEdgesAndKeepsTheSurface) {
    for (const double longest : {2., 1., 0.3, 0.05}) {
        MeshData mesh = square();
        mesh.positions[2] = Vec3d(3, 1, 0);  // triangles with one, two and three long edges
        const double area = area_of(mesh);
        ASSERT_TRUE(subdivide(mesh, longest));
        EXPECT_LE(longest_edge(mesh), longest);
        EXPECT_GT(longest_edge(mesh), 0.4 * longest);
        EXPECT_NEAR(area_of(mesh), area, 1e-12);
        for (const auto& t : mesh.triangles) {
            const Vec3d a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
            EXPECT_GT((b - a).cross(c - a).z(), 0);
        }
    }
    const MeshData closed = ball();
    EXPECT_EQ(open_edges(closed), 0);
}

TEST(Subdivision, InterpolatesWhatVerticesHaveAndRepeatsWhatFacesHave) {
    MeshData mesh = square();
    mesh.attributes = {{"vertex_x", false, true, {}}, {"face_color", true, false, {Color(1, 0, 0), Color(0, 1, 0)}}};
    for (const Vec3d& p : mesh.positions)
        mesh.attributes[0].values.push_back(Color::Constant(static_cast<float>(p.x())));
    ASSERT_TRUE(subdivide(mesh, 0.1));
    ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    ASSERT_EQ(mesh.attributes[0].values.size(), mesh.positions.size());
    ASSERT_EQ(mesh.attributes[1].values.size(), mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        EXPECT_NEAR((mesh.uvs[i].cast<double>() - mesh.positions[i].head<2>()).norm(), 0, 1e-6);
        EXPECT_NEAR(double{mesh.attributes[0].values[i][0]}, mesh.positions[i].x(), 1e-6);
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& t = mesh.triangles[i];
        const Vec3d center = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
        EXPECT_EQ(mesh.attributes[1].values[i][0], center.x() > center.y() ? 1.f : 0.f) << i;
    }
}

TEST(Subdivision, RefusesTooManyTriangles) {
    // At an edge of 0.02 the area alone needs 5773 triangles. At 0.05 it needs 924, but halves of the square's edges
    // are at most 0.05 long in 2 * 32^2 triangles or more.
    for (const double longest : {0.02, 0.05}) {
        MeshData mesh = square();
        EXPECT_FALSE(subdivide(mesh, longest, 1000));
        EXPECT_LE(mesh.triangles.size(), 1000u);
    }
    MeshData mesh = square();
    EXPECT_TRUE(subdivide(mesh, 0.05, 4096));
}

TEST(Displacement, ALinearRampTiltsASquare) {
    MeshData mesh = square();
    ASSERT_TRUE(subdivide(mesh, 0.1));
    const double slope = 0.75;
    displace(
        mesh, [&](const Vec2& uv) { return slope * double{uv.x()}; }, 1);
    EXPECT_NEAR(area_of(mesh), std::sqrt(1 + slope * slope), 1e-6);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        EXPECT_NEAR(mesh.positions[i].z(), slope * mesh.positions[i].x(), 1e-6);
        EXPECT_LT((mesh.normals[i] - Vec3(-0.75f, 0, 1).normalized()).norm(), 1e-5f);
    }
}

TEST(Displacement, AConstantAddsToTheRadiusOfASphere) {
    for (const double direction : {1., -1.}) {
        MeshData mesh = ball();
        displace(
            mesh, [](const Vec2&) { return 0.25; }, direction);
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            EXPECT_NEAR(mesh.positions[i].norm(), 2 + 0.25 * direction, 1e-6);
            EXPECT_LT((mesh.normals[i] - mesh.positions[i].normalized().cast<float>()).norm(), 0.01f);
        }
    }
}

/// The square, whose two halves share no vertices.
MeshData square_in_two() {
    MeshData mesh = square();
    mesh.positions = {mesh.positions[0], mesh.positions[1], mesh.positions[2],
                      mesh.positions[0], mesh.positions[2], mesh.positions[3]};
    mesh.uvs = {mesh.uvs[0], mesh.uvs[1], mesh.uvs[2], mesh.uvs[0], mesh.uvs[2], mesh.uvs[3]};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    return mesh;
}

TEST(Displacement, ASeamOfAFlatSurfaceStaysSmooth) {
    MeshData mesh = square_in_two(), whole = square();
    const auto hill = [](const Vec2& uv) { return 0.2 * std::sin(5 * double{uv.x()}) * std::cos(4 * double{uv.y()}); };
    for (MeshData* m : {&mesh, &whole}) {
        ASSERT_TRUE(subdivide(*m, 0.1));
        displace(*m, hill, 1);
    }
    std::map<std::pair<double, double>, Vec3> normal_at;
    for (std::size_t i = 0; i < whole.positions.size(); ++i)
        normal_at[{whole.positions[i].x(), whole.positions[i].y()}] = whole.normals[i];
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        EXPECT_LT((mesh.normals[i] - normal_at.at({mesh.positions[i].x(), mesh.positions[i].y()})).norm(), 1e-5f);
}

/// The mesh that a scene's only shape becomes, with positions in double.
MeshData mesh_of(const LoadedScene& loaded) {
    const auto& mesh = std::get<Mesh>(loaded.scene->shapes()[0]);
    MeshData data;
    for (std::uint32_t i = 0; i + 1 < mesh.vertices.size(); ++i)
        data.positions.push_back(mesh.vertex(i).cast<double>());
    data.triangles = mesh.triangles;
    data.normals = mesh.normals;
    data.uvs = mesh.uvs;
    return data;
}

TEST(DisplacedShape, ACubeStaysClosedAndItsEdgesSharp) {
    const MeshData mesh = mesh_of(load(shape("cube", number("displacement", 0.1) + number("displacement_edge", 0.5))));
    EXPECT_EQ(open_edges(mesh), 0);
    EXPECT_LE(longest_edge(mesh), 0.5 * 1.5);
    int corners = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3d p = mesh.positions[i];
        // In the middle of a face a vertex moves by 0.1 along an axis, at a corner by as much along the diagonal.
        if (p.cwiseAbs().minCoeff() < 1e-6 && p.cwiseAbs().sum() < 1.2) {
            EXPECT_NEAR(p.norm(), 1.1, 1e-6);
        }
        if (p.cwiseAbs().minCoeff() > 1.02) {
            ++corners;
            EXPECT_NEAR(p.norm(), std::sqrt(3.) + 0.1, 1e-6);
            EXPECT_GT(mesh.normals[i].cwiseAbs().maxCoeff(), 0.9f);
        }
    }
    EXPECT_EQ(corners, 24);
}

/// A Radiance picture of two texels, black and white. Between their centres a bilinear filter makes a linear ramp.
const std::string ramp_picture =
    std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") + std::string(4, '\0') + "\x80\x80\x80\x81";

TEST(DisplacedShape, ATextureTiltsARectangle) {
    const TemporaryFolder folder;
    folder.write("ramp.hdr", ramp_picture);
    const std::string ramp = named("texture", "displacement", "bitmap", filename("ramp.hdr"), flag("raw"),
                                   text("wrap_mode", "clamp"), to_uv(scale(0.5, 1, 1), translate(0.25, 0, 0)));
    const auto displaced = [&](const std::string& more) {
        return mesh_of(load_in(folder, shape("rectangle", ramp, more)));
    };
    // The rectangle is 2 wide, so that a height of 1.5 u has the slope 0.75. The scene is centred.
    const MeshData mesh = displaced(number("displacement_scale", 1.5));
    EXPECT_GT(mesh.triangles.size(), 10000u);
    EXPECT_NEAR(area_of(mesh), 4 * 1.25, 1e-4);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        EXPECT_NEAR(mesh.positions[i].z(), 0.75 * mesh.positions[i].x(), 1e-5);
        EXPECT_LT((mesh.normals[i] - Vec3(-0.6f, 0, 0.8f)).norm(), 1e-3f);
    }
    const MeshData turned = displaced(number("displacement_scale", 1.5) + flag("flip_normals"));
    for (const Vec3d& p : turned.positions)
        EXPECT_NEAR(p.z(), -0.75 * p.x(), 1e-5);
}

TEST(DisplacedShape, TheMidlevelStaysInPlace) {
    const auto height = [](const std::string& body) {
        const auto loaded = load(shape("rectangle", body) + shape("sphere", center(0, 0, 9)));
        return mesh_of(loaded).positions[0].z() - double{std::get<Sphere>(loaded.scene->shapes()[1]).center.z()} + 9;
    };
    EXPECT_NEAR(
        height(number("displacement", 0.75) + number("displacement_midlevel", 0.5) + number("displacement_scale", 2)),
        0.5, 1e-6);
    EXPECT_NEAR(height(number("displacement", 0.25) + number("displacement_scale", -2)), -0.5, 1e-6);
}

TEST(DisplacedShape, FaceNormalsStayFacets) {
    const TemporaryFolder folder;
    folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (const bool facets : {true, false}) {
        const std::string mesh =
            shape("obj", filename("m.obj"), flag("face_normals", facets), number("displacement", 1));
        EXPECT_EQ(mesh_of(load_in(folder, mesh)).normals.empty(), facets);
    }
}

}  // namespace
}  // namespace gib::test::displacement_test
