// The division of surfaces into patches: charts, leaves and corners.
#include "methods/radiosity/corners.h"
#include "tests/methods/radiosity/fixtures.h"
#include "tests/support/scene_text.h"

#include <functional>
#include <numbers>
#include <set>

namespace gib::test::mesh_test {
namespace {

constexpr double pi = std::numbers::pi;

/// Turns about (1, 2, 3) and moves.
const std::string tilt = "<rotate x='1' y='2' z='3' angle='40'/>" + translate(0.3, -2, 5);
const std::string grey = one_sided("0.5");

struct NamedShape {
    std::string name, xml;
    double area;
    std::size_t charts;  ///< 0: as many as the size of patches asks for
};
void PrintTo(const NamedShape& shape, std::ostream* out) { *out << shape.name; }

std::string tilted(const std::string& type, const std::string& steps) {
    return shape(type, to_world(steps, tilt), grey);
}

/// A mesh with the vertices and faces of the OBJ text `obj`; its file exists until the program ends.
std::string obj_shape(const std::string& name, const std::string& obj, const std::string& steps = "") {
    static const TemporaryFolder folder;
    return shape("obj", to_world(steps, tilt), text("filename", folder.write(name, obj)), grey);
}

std::string group_of(const std::string& type) {
    return "<shape type='shapegroup' id='g'>" + shape(type, grey) + "</shape>";
}
const std::string instance_of_group = shape("instance", reference("g"), to_world(scale(2), tilt));

std::vector<NamedShape> shapes() {
    // Four triangles around a point, no two of them in one plane.
    const std::string pyramid =
        obj_shape("pyramid.obj",
                  "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n", scale(2));
    // One quadrilateral of two triangles, which is no parallelogram.
    const std::string trapezoid =
        obj_shape("trapezoid.obj", "v -2 -1 0\nv 2 -1 0\nv 0.5 1 0\nv -0.5 1 0\nf 1 2 3\nf 1 3 4\n");
    const std::string irregular =
        obj_shape("irregular.obj", "v -2 -1 0\nv 2 -2 0\nv 1 1 0\nv -1 0 0\nf 1 2 3\nf 1 3 4\n");
    return {
        {"pyramid", pyramid, 16 * std::numbers::sqrt2, 4},
        {"trapezoid", trapezoid, 5, 1},
        {"irregular", irregular, 6, 1},
        {"rectangle", tilted("rectangle", scale(3, 0.5, 1)), 6, 1},
        {"cube", tilted("cube", scale(1, 2, 3)), 8 * (2 + 3 + 6), 6},
        {"sphere", tilted("sphere", scale(2)), 16 * pi, 0},
        {"disk", tilted("disk", scale(2)), 4 * pi, 0},
        {"cylinder", tilted("cylinder", scale(2)), 2 * pi * 2 * 2, 0},
        {"instance", group_of("rectangle") + instance_of_group, 16, 1},
    };
}

class EveryShapeInPatches : public testing::TestWithParam<NamedShape> {
protected:
    const ScenePatches patches_{GetParam().xml, 0.4};
    const Charts& charts_ = patches_.charts;
    const PatchMesh& mesh_ = patches_.mesh;
};
INSTANTIATE_TEST_SUITE_P(Shapes, EveryShapeInPatches, testing::ValuesIn(shapes()),
                         [](const auto& test) { return test.param.name; });

TEST_P(EveryShapeInPatches, HasAsManyChartsAsItHasFaces) {
    if (GetParam().charts > 0) EXPECT_EQ(charts_.size(), GetParam().charts);
    else EXPECT_EQ(charts_.size(), mesh_.leaves().size()) << "pieces of curved shapes are patches";
}

TEST_P(EveryShapeInPatches, CoversItOnce) {
    double area = 0;
    for (const PatchNode& node : mesh_.nodes())
        if (node.is_leaf()) area += node.area;
    EXPECT_NEAR(area / GetParam().area, 1, 1e-5);
}

TEST_P(EveryShapeInPatches, HasNoLongerEdgesThanAsked) {
    std::size_t leaves = 0;
    for (const PatchNode& node : mesh_.nodes()) {
        if (!node.is_leaf()) continue;
        ++leaves;
        const auto corners = node.polygon.corners();
        for (std::size_t i = 0; i < corners.size(); ++i)
            EXPECT_LT((corners[(i + 1) % corners.size()] - corners[i]).norm(), 0.4 * 1.03)
                << "pieces are scaled to the area of the shape";
    }
    EXPECT_GT(static_cast<double>(leaves), GetParam().area / (0.4 * 0.4));
    EXPECT_LT(static_cast<double>(leaves), 12 * GetParam().area / (0.4 * 0.4));
}

TEST_P(EveryShapeInPatches, FollowTheirEstimatedNumber) {
    const double estimated = PatchMesh::estimated_patches(charts_, 0.4);
    EXPECT_GT(static_cast<double>(mesh_.leaves().size()), 0.45 * estimated);
    EXPECT_LT(static_cast<double>(mesh_.leaves().size()), 2.1 * estimated);
}

// Uniform numbers give a mean of points that is the centroid of the polygon.
TEST_P(EveryShapeInPatches, HasEvenPoints) {
    for (const PatchSide& side : mesh_.sides()) {
        if (charts_[side.chart].curved) continue;
        const PatchNode& root = mesh_.nodes()[side.root];
        const auto corners = root.polygon.corners();
        Vec3d centroid = Vec3d::Zero(), mean = Vec3d::Zero();
        for (std::size_t i = 2; i < corners.size(); ++i)
            centroid += (corners[0] + corners[i - 1] + corners[i]) / 3 *
                        (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]).norm() / (2 * root.area);
        constexpr std::uint32_t points = 4096;
        for (std::uint32_t i = 0; i < points; ++i)
            mean += mesh_.point_on(root, Sampler(PointSet::sobol, 1, 0, i).get_2d(0).cast<double>()).p.cast<double>() /
                    points;
        EXPECT_LT((mean - centroid).norm(), 2e-3 * root.radius);
    }
}

TEST_P(EveryShapeInPatches, FindsThePlaceOfEveryPoint) {
    for (std::uint32_t i = 0; i < 200; ++i) {
        const Sampler u(PointSet::sobol, 3, 0, i);
        const PatchNode& root = mesh_.nodes()[mesh_.sides()[i % mesh_.sides().size()].root];
        const SurfaceHit hit = mesh_.point_on(root, u.get_2d(0).cast<double>());
        const auto place = mesh_.locate(hit, hit.ng);
        ASSERT_TRUE(place);
        const PatchNode& leaf = mesh_.nodes()[place->leaf];
        EXPECT_TRUE(leaf.is_leaf());
        const auto weights = mesh_.weights(leaf, place->uv);
        Vec3d p = Vec3d::Zero();
        double sum = 0;
        for (std::size_t k = 0; k < leaf.corner_count(); ++k) {
            p += weights[k] * mesh_.chart_of(leaf).position(leaf.corners[k]);
            sum += weights[k];
        }
        EXPECT_NEAR(sum, 1, 1e-9);
        // The chord of an arc of 20 degrees is at most 1.5 % of the radius away from the arc.
        EXPECT_LT((p - hit.p.cast<double>()).norm(), 0.04) << i;
        EXPECT_FALSE(mesh_.locate(hit, -hit.ng)) << "the back of a one-sided material has no patch";
    }
}

TEST_P(EveryShapeInPatches, TurnsItsPolygonsToItsFront) {
    for (const PatchNode& node : mesh_.nodes()) {
        if (node.is_cluster()) continue;
        const SurfaceHit hit = mesh_.point_on(node, Vec2d::Constant(0.5));
        EXPECT_GT(node.polygon.normal.dot(hit.ng.cast<double>()), 0.95);
    }
}

TEST(PatchMesh, GivesTwoSidedMaterialsPatchesOnBothSides) {
    const ScenePatches patches(shape("rectangle", diffuse(0.5)), 1.01);
    const PatchMesh& mesh = patches.mesh;
    ASSERT_EQ(mesh.sides().size(), 2u);
    EXPECT_EQ(mesh.leaves().size(), 8u);
    EXPECT_LT(mesh.nodes()[mesh.sides()[0].root].polygon.normal.dot(mesh.nodes()[mesh.sides()[1].root].polygon.normal),
              -0.999);
}

TEST(PatchMesh, MakesNoneOfSpecularSurfaces) {
    const ScenePatches patches(shape("sphere", bsdf("conductor")) + shape("rectangle", grey), 1);
    EXPECT_EQ(patches.mesh.sides().size(), 1u);
}

// A triangle is halved at its longest edge again and again, so that no part is a narrower needle than the whole.
TEST(PatchMesh, HalvesTrianglesIntoNoNarrowerOnes) {
    const ScenePatches patches(obj_shape("triangle.obj", "v 0 0 0\nv 5 0 0\nv 0 1 0\nf 1 2 3\n"), 0.1);
    for (const PatchNode& node : patches.mesh.nodes()) {
        if (!node.is_leaf()) continue;
        double longest2 = 0;
        for (std::size_t i = 0; i < 3; ++i)
            longest2 =
                std::max(longest2, (node.polygon.vertices[(i + 1) % 3] - node.polygon.vertices[i]).squaredNorm());
        EXPECT_GT(node.area, 0.99 * 2.5 / 26 * longest2);  // ratio of the whole: area 2.5, longest edge^2 26
    }
}

TEST(PatchMesh, FindsPlacesOnInstancedSpheres) {
    const ScenePatches patches(group_of("sphere") + instance_of_group, 0.4);
    const auto& [loaded, charts, mesh] = patches;
    ASSERT_EQ(mesh.sides().size(), charts.size());
    for (std::uint32_t i = 0; i < 60; ++i) {
        const Sampler u(PointSet::sobol, 3, 0, i);
        const SurfaceHit hit =
            mesh.point_on(mesh.nodes()[mesh.sides()[i % charts.size()].root], u.get_2d(0).cast<double>());
        const auto place = mesh.locate(hit, hit.ng);
        ASSERT_TRUE(place);
        const Chart& chart = mesh.chart_of(mesh.nodes()[place->leaf]);
        EXPECT_LT((charts.surface_at(chart, place->uv).p - hit.p).norm(), 1e-4f) << i;
    }
}

/// The patches of a shape and what their corners make of the values value(centre) of the leaves.
struct ShapeWithCorners : ScenePatches {
    PatchCorners corners;
    ShapeWithCorners(const std::string& xml, double size) : ScenePatches(xml, size), corners(mesh) {}

    std::vector<Colord> values(const std::function<double(const Vec3d&)>& value) const {
        PatchColors of_leaves(mesh.nodes().size(), Colord::Zero());
        std::vector<double> areas(mesh.nodes().size());
        for (const std::uint32_t leaf : mesh.leaves()) {
            of_leaves[leaf] = Colord::Constant(value(mesh.nodes()[leaf].center));
            areas[leaf] = mesh.nodes()[leaf].area;
        }
        return corners.values(of_leaves, areas);
    }
};

TEST(PatchCorners, AreSharedOverSmoothSurfacesOnly) {
    // Each face of the cube is divided into 4 x 4 patches.
    EXPECT_EQ(ShapeWithCorners(shape("cube", grey), 0.51).corners.size(), 6u * 5 * 5);
    // Both triangles of a plane that is no quadrilateral, and pieces of a sphere: V - E + F = 2, where E and F of the
    // pieces count by their corners; the poles are corners of all pieces around them.
    const ShapeWithCorners sphere(shape("sphere", grey), 0.51);
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const std::uint32_t leaf : sphere.mesh.leaves()) {
        const auto corners = sphere.corners.in_turn(leaf);
        for (std::size_t k = 0; k < 4; ++k)
            if (const std::uint32_t a = corners[k], b = corners[(k + 1) % 4]; a != b) edges.insert(std::minmax(a, b));
    }
    EXPECT_EQ(sphere.corners.size() + sphere.mesh.leaves().size(), edges.size() + 2);
}

TEST(PatchCorners, ShowALinearFieldAndKeepItsMean) {
    for (const std::string& xml : {shape("rectangle", grey), obj_shape("two.obj",
                                                                       "v -1 -1 0\nv 3 -1 0\nv 1 2 0\nv 1 9 0\n"
                                                                       "f 1 2 3\n")}) {
        const ShapeWithCorners patches(xml, 0.3);
        const auto field = [](const Vec3d& p) { return 2 + 0.3 * p.x() - 0.2 * p.y(); };
        const auto values = patches.values(field);
        double mean = 0, truth = 0, worst = 0;
        for (const std::uint32_t i : patches.mesh.leaves()) {
            const PatchNode& leaf = patches.mesh.nodes()[i];
            for (std::size_t k = 0; k < leaf.corner_count(); ++k)
                mean += leaf.area / static_cast<double>(leaf.corner_count()) * values[patches.corners.of_leaf(i)[k]][0];
            truth += leaf.area * field(leaf.center);
        }
        for (std::size_t i = 0; i < values.size(); ++i)
            worst = std::max(worst, std::abs(values[i][0] - field(patches.corners.places()[i].cast<double>())));
        EXPECT_NEAR(mean / truth, 1, 1e-3);
        EXPECT_LT(worst, 0.25 * 0.3 * std::hypot(0.3, 0.2)) << "a quarter of the change over a patch, at an edge";
    }
}

}  // namespace
}  // namespace gib::test::mesh_test
