// The division of surfaces into patches: charts, leaves, contacts and vertices.
#include "methods/radiosity/contacts.h"
#include "tests/methods/radiosity/fixtures.h"
#include "tests/support/scene_text.h"

#include <numbers>

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
    return {
        {"pyramid", pyramid, 16 * std::numbers::sqrt2, 4},
        {"trapezoid", trapezoid, 5, 1},
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
    else EXPECT_EQ(charts_.size(), mesh_.leaf_count()) << "pieces of curved shapes are patches";
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
        for (std::size_t k = 0; k < static_cast<std::size_t>(leaf.corner_count()); ++k) {
            p += weights[k] * mesh_.chart_of(leaf).position(uv_of(leaf.corners[k]));
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
    EXPECT_EQ(mesh.leaf_count(), 8u);
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

// A box stands on the floor. The leaves that its outline crosses are halved until they are as small as asked, and no
// others.
TEST(PatchContacts, AreHalvedAlongTheOutlineOfWhatStandsThere) {
    constexpr double least = 0.1;
    ScenePatches patches(shape("rectangle", grey) + shape("cube", to_world(scale(0.3), translate(0, 0, 0.3)), grey),
                         1.01);
    PatchMesh& mesh = patches.mesh;  // 2 x 2 on the floor
    const auto crossed = [&](const PatchNode& node) {
        Vec2d lower = Vec2d::Constant(2), upper = -lower;
        for (const Vec3d& corner : node.polygon.corners()) {
            lower = lower.cwiseMin(corner.head<2>());
            upper = upper.cwiseMax(corner.head<2>());
        }
        const bool meets = (lower.array() < 0.3).all() && (upper.array() > -0.3).all();
        return meets && !((lower.array() > -0.3).all() && (upper.array() < 0.3).all());
    };
    std::uint64_t rays = 0;
    halve_at_contacts(mesh, least, rays);
    EXPECT_GT(rays, 0u);
    int halved = 0;
    for (const PatchNode& node : mesh.nodes()) {
        if (node.is_cluster()) continue;
        const bool floor = mesh.chart_of(node).shape == 0;
        if (!floor) {
            EXPECT_TRUE(node.is_leaf());  // the box's faces are smaller than asked, and nothing stands on them
        } else if (node.is_leaf()) {
            EXPECT_TRUE(!crossed(node) || node.radius <= least);
        } else if (node.across + node.along >= 2) {
            EXPECT_TRUE(crossed(node));
            ++halved;
        }
    }
    EXPECT_GE(halved, 24);  // each quarter of the floor is halved at every size
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

/// A shape of few patches, one of which is halved nine times, always in one of the two halves made last, so that ever
/// smaller patches approach a corner. Its vertices have pseudo-random values; the value at a T-junction is the mean of the
/// two vertices that it is bound to.
struct HalvedIntoACorner : ScenePatches {
    explicit HalvedIntoACorner(const std::string& xml) : ScenePatches(xml, 1.01) {
        auto node = static_cast<std::uint32_t>(mesh.nodes().size() - 4);
        for (int k = 0; k < 9; ++k) {
            EXPECT_TRUE(mesh.nodes()[node].is_leaf());
            mesh.split(node);
            node = static_cast<std::uint32_t>(mesh.nodes().size() - (k % 4 == 0 ? 1 : 2));
        }
        vertices.emplace(mesh);
        EXPECT_FALSE(vertices->bound().empty());
        for (std::size_t i = 0; i < vertices->vertices().size(); ++i)
            values.push_back(static_cast<double>(mix64(i) % 1000));
        for (const auto& bound : vertices->bound())
            values[bound.vertex] = 0.5 * (values[bound.first] + values[bound.second]);
    }
    /// The interpolated value; none outside the leaf, where weights are cut off.
    std::optional<double> value_in(std::uint32_t leaf, const Vec2d& uv) const {
        const PatchNode& node = mesh.nodes()[leaf];
        const auto weights = mesh.weights(node, uv);
        double value = 0;
        Vec2d there = Vec2d::Zero();
        for (std::size_t k = 0; k < static_cast<std::size_t>(node.corner_count()); ++k) {
            value += weights[k] * values[vertices->of_leaf(leaf)[k]];
            there += weights[k] * uv_of(node.corners[k]);
        }
        return (there - uv).norm() > 1e-9 ? std::nullopt : std::optional(value);
    }

    std::optional<PatchVertices> vertices;
    std::vector<double> values;
};

// Values that are interpolated from both sides of an edge agree whatever the corners' values are, also where small
// patches meet a large one: they are compared at points of every edge that also belong to another leaf.
void expect_no_cracks(const std::string& xml) {
    const HalvedIntoACorner patches(xml);
    const auto& nodes = patches.mesh.nodes();
    int compared = 0;
    for (std::uint32_t a = 0; a < nodes.size(); ++a)
        for (std::size_t k = 0; nodes[a].is_leaf() && k < static_cast<std::size_t>(nodes[a].corner_count()); ++k)
            for (const double t : {0.0, 0.3, 0.5, 0.9}) {
                const auto& corners = nodes[a].corners;
                const Vec2d from = uv_of(corners[k]),
                            to = uv_of(corners[(k + 1) % static_cast<std::size_t>(nodes[a].corner_count())]);
                const Vec2d uv = from + t * (to - from);
                const auto here = patches.value_in(a, uv);
                ASSERT_TRUE(here);
                for (std::uint32_t b = 0; b < nodes.size(); ++b) {
                    const auto there = b != a && nodes[b].is_leaf() ? patches.value_in(b, uv) : std::nullopt;
                    if (!there) continue;
                    EXPECT_NEAR(*here, *there, 1e-6);
                    ++compared;
                }
            }
    EXPECT_GT(compared, 100);
}

TEST(PatchVertices, InterpolateWithoutCracks) { expect_no_cracks(shape("rectangle", grey)); }
TEST(PatchVertices, InterpolateWithoutCracksBetweenTriangles) {
    expect_no_cracks(obj_shape("one.obj", "v 0 0 0\nv 3 0 0\nv 0 2 0\nf 1 2 3\n"));
}

}  // namespace
}  // namespace gib::test::mesh_test
