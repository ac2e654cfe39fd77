// Attributes of meshes, which the texture `mesh_attribute` takes from its shape's mesh, and materials of OBJ files: as
// in Mitsuba 0.6, a shape may have a bsdf for each. The texture `rawconstant` and merged shapes are tested here, too.

#include "common/mesh_files/mesh_data.h"
#include "common/mesh_files/ply_attributes.h"
#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"

namespace gib::test::mesh_attribute_test {
namespace {

using Names = std::vector<std::string>;

/// The attributes of an element with these properties, as `name: properties`.
Names found(const std::string& element, const Names& properties) {
    Names lines;
    for (const PlyAttribute& attribute : ply_attributes(element, properties)) {
        std::string line = attribute.name + ":";
        for (const std::size_t i : attribute.properties)
            line += " " + std::to_string(i);
        lines.push_back(line);
    }
    return lines;
}

TEST(PlyAttributes, AreNamedAsInMitsuba) {
    EXPECT_EQ(found("vertex", {"", "", "", "red", "green", "blue", "alpha"}), Names{"vertex_color: 3 4 5"});
    EXPECT_EQ(found("face", {"b", "g", "r"}), Names{"face_color: 2 1 0"});
    EXPECT_EQ(found("vertex", {"red", "green"}), Names{});
    EXPECT_EQ(found("face", {"tint_r", "tint_g", "tint_b", "tint_a"}), Names{"face_tint: 0 1 2"});
    EXPECT_EQ(found("vertex", {"a_x", "a_y", "a_z", "b_0", "b_1", "b_2", "c_1", "c_2", "c_3"}),
              (Names{"vertex_a: 0 1 2", "vertex_b: 3 4 5", "vertex_c: 6 7 8"}));
    EXPECT_EQ(found("vertex", {"heat_x", "rest", "wear_1"}), (Names{"vertex_heat: 0", "vertex_wear: 2"}));
    // Two numbers, four that are no colour, a list or what lies between other properties are no attributes.
    EXPECT_EQ(found("vertex", {"p_x", "p_y", "q_x", "q_y", "q_z", "q_w"}), Names{});
    EXPECT_EQ(found("vertex", {"m_x", "", "m_y", "m_z"}), Names{"vertex_m: 0"});
}

/// The square [0, 1]^2 in z = 0 as one face, with colours at its vertices and of its face.
const std::string painted_square =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float red\nproperty float green\nproperty float blue\nproperty float heat_x\n"
    "element face 1\nproperty list uchar int vertex_indices\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    "0 0 0 0 0 0.5 0.25\n1 0 0 1 0 0.5 0.25\n1 1 0 1 1 0.5 0.75\n0 1 0 0 1 0.5 0.75\n4 0 1 2 3 255 128 0\n";

TEST(PlyAttributes, AreReadForVerticesAndForEveryTriangleOfAFace) {
    const MeshData mesh = parse_ply(painted_square, "m.ply");
    ASSERT_EQ(mesh.attributes.size(), 3u);
    EXPECT_EQ(mesh.attributes[0].name, "vertex_color");
    ASSERT_EQ(mesh.attributes[0].values.size(), 4u);
    EXPECT_TRUE((mesh.attributes[0].values[2] == Color(1, 1, 0.5f)).all());
    EXPECT_EQ(mesh.attributes[1].name, "vertex_heat");
    EXPECT_TRUE(mesh.attributes[1].grey);
    EXPECT_TRUE((mesh.attributes[1].values[3] == Color::Constant(0.75f)).all());
    EXPECT_EQ(mesh.attributes[2].name, "face_color");
    ASSERT_EQ(mesh.attributes[2].values.size(), 2u);
    // The byte 128 stands for ((128 / 255 + 0.055) / 1.055)^2.4 = 0.215861 in sRGB.
    for (const Color& color : mesh.attributes[2].values)
        EXPECT_LT((color - Color(1, 0.215861f, 0)).abs().maxCoeff(), 1e-6f);
}

TEST(PlyAttributes, MustBeFinite) {
    const std::string bad =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
        "z\nproperty double heat_x\nelement face 1\nproperty list uchar int vertex_indices\n"
        "end_header\n0 0 0 1e39\n1 0 0 0\n0 1 0 0\n3 0 1 2\n";
    EXPECT_THAT(input_error_of([&] { parse_ply(bad, "m.ply"); }),
                HasSubstr("m.ply:11:7: the attribute 'heat_x' is too large or not finite"));
}

std::string attribute(const std::string& parameter, const std::string& name, const std::string& more = "") {
    return named("texture", parameter, "mesh_attribute", text("name", name), more);
}
std::string painted(const std::string& name, const std::string& more = "") {
    return bsdf("diffuse", attribute("reflectance", name, more));
}

class MeshAttributeTextures : public ::testing::Test {
protected:
    MeshAttributeTextures() {
        folder_.write("square.ply", painted_square);
        // The same square with red for green and green for red.
        std::string other = painted_square;
        other.replace(other.find("float red"), 9, "float gre");
        other.replace(other.find("float green"), 11, "float red");
        other.replace(other.find("float gre\n"), 10, "float green\n");
        folder_.write("other.ply", other);
    }

    static std::string square(const std::string& body, const std::string& file = "square.ply") {
        return shape("ply", filename(file), flag("face_normals"), body);
    }
    LoadedScene load(const std::string& body) const { return load_in(folder_, body); }
    std::string error_of(const std::string& body) const { return scene_error(body, folder_ / "s.xml"); }
    /// The hit of a ray along -z at (x, y) of the file.
    static SurfaceHit hit_at(const LoadedScene& loaded, float x, float y, const Vec3& center = Vec3(0.5f, 0.5f, 0)) {
        auto hit = loaded.scene->intersect({Vec3(x, y, 5) - center, Vec3(0, 0, -1)});
        EXPECT_TRUE(hit.has_value());
        return *hit;
    }
    static Color reflectance_at(const LoadedScene& loaded, float x, float y, const Vec3& center = Vec3(0.5f, 0.5f, 0)) {
        return hit_at(loaded, x, y, center).bsdf->ideal_diffuse_reflectance(1).value_or(Color::Constant(-1));
    }

    TemporaryFolder folder_;
};

void expect_color(const Color& actual, const Color& expected, const char* what) {
    EXPECT_LT((actual - expected).abs().maxCoeff(), 2e-6f) << what << ": " << actual.transpose();
}

TEST_F(MeshAttributeTextures, VertexColorsAreInterpolated) {
    const auto loaded = load(square(painted("vertex_color")));
    const auto scaled = load(square(painted("vertex_color", number("scale", 0.5))));
    const auto heat = load(square(painted("vertex_heat")));
    // On this square red is x and green is y, on both triangles.
    for (const auto& [x, y] : {std::pair(0.1f, 0.3f), std::pair(0.8f, 0.3f), std::pair(0.95f, 0.9f)}) {
        expect_color(reflectance_at(loaded, x, y), Color(x, y, 0.5f), "color");
        expect_color(reflectance_at(scaled, x, y), Color(x, y, 0.5f) / 2, "scaled");
        expect_color(reflectance_at(heat, x, y), Color::Constant(0.25f + 0.5f * y), "heat");
    }
}

TEST_F(MeshAttributeTextures, FaceColorsAreConstantOnAFace) {
    const auto loaded = load(square(painted("face_color")));
    for (const auto& [x, y] : {std::pair(0.9f, 0.1f), std::pair(0.1f, 0.9f)})
        expect_color(reflectance_at(loaded, x, y), Color(1, 0.215861f, 0), "face");
}

TEST_F(MeshAttributeTextures, ASharedBsdfTakesTheAttributeOfEachMesh) {
    const std::string away = to_world(translate(2, 0, 0));
    const auto loaded = load(with_id("bsdf", "diffuse", "paint", attribute("reflectance", "vertex_color")) +
                             square(reference("paint")) + square(reference("paint") + away, "other.ply"));
    const Vec3 center(1.5f, 0.5f, 0);
    expect_color(reflectance_at(loaded, 0.25f, 0.75f, center), Color(0.25f, 0.75f, 0.5f), "first");
    expect_color(reflectance_at(loaded, 2.25f, 0.75f, center), Color(0.75f, 0.25f, 0.5f), "second");
    EXPECT_EQ(loaded.scene->materials().size(), 2u);
}

TEST_F(MeshAttributeTextures, InstancesShowTheAttributesOfTheirGroup) {
    const auto loaded = load(with_id("shape", "shapegroup", "g", square(painted("vertex_color"))) +
                             shape("instance", reference("g"), to_world(scale(2))));
    expect_color(reflectance_at(loaded, 0.5f, 1.5f, Vec3(1, 1, 0)), Color(0.25f, 0.75f, 0.5f), "instance");
}

TEST_F(MeshAttributeTextures, LampsEmitTheAttribute) {
    const auto loaded = load(square(emitter("area", attribute("radiance", "vertex_color", number("scale", 8)))));
    expect_color(hit_at(loaded, 0.25f, 0.75f).Le(Vec3::UnitZ()) / 8, Color(0.25f, 0.75f, 0.5f), "hit");
    // The mean radiance is (4, 4, 4) over an area of 1; the power is pi times that.
    const Colord power = loaded.scene->emitted_power();
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(power[c], 4 * std::numbers::pi, 1e-3 * 4 * std::numbers::pi);
    // The radiance of a sampled point is that of its place.
    for (const auto& [u, v] : {std::pair(0.2f, 0.6f), std::pair(0.7f, 0.1f), std::pair(0.9f, 0.9f)}) {
        const Vec3 p(0, 0, 2);
        const auto sample = loaded.scene->sample_light(p, 0.5f, Vec2(u, v));
        ASSERT_TRUE(sample);
        const Vec3 q = p + sample->distance * sample->wi + Vec3(0.5f, 0.5f, 0);
        expect_color(sample->Le / 8, Color(q.x(), q.y(), 0.5f), "sample");
        const EmissionSample start = loaded.scene->sample_emission(0.5f, Vec2(u, v), Vec2(0.3f, 0.4f));
        const Vec3 o = start.ray.o + Vec3(0.5f, 0.5f, 0);
        expect_color((start.power / (8 * std::numbers::pi)).cast<float>(), Color(o.x(), o.y(), 0.5f), "emission");
    }
}

TEST_F(MeshAttributeTextures, ARawConstantIsOneOrThreeNumbers) {
    const auto raw = [](const std::string& value) {
        return bsdf("diffuse", named("texture", "reflectance", "rawconstant", value));
    };
    const auto colour = [&](const std::string& value) { return reflectance_at(load(square(raw(value))), 0.5f, 0.4f); };
    expect_color(colour(number("value", 0.25)), Color::Constant(0.25f), "float");
    expect_color(colour(vector("value", 0.25, 0.5, 1)), Color(0.25f, 0.5f, 1), "vector");
    EXPECT_THAT(error_of(square(raw(""))), HasSubstr("value"));
    EXPECT_THAT(error_of(square(raw(vector("value", 0.25, 0.5, 2)))),
                HasSubstr("'reflectance' must be between 0 and 1, but its texture has 2"));
}

/// A bsdf for the material of this name; without a name, for all materials without a bsdf of their own.
std::string grey(const std::string& name, double reflectance) {
    const std::string value = number("reflectance", reflectance);
    return name.empty() ? bsdf("diffuse", value) : named("bsdf", name, "diffuse", value);
}

using ::testing::ElementsAre;

class ObjMaterials : public ::testing::Test {
protected:
    ObjMaterials() {
        // Three unit squares beside each other in the plane z = 0: Wood_A, glass and Wood_A.
        folder_.write("m.obj",
                      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 3 1 0\n"
                      "usemtl Wood_A\nf 1 2 6 5\nusemtl glass\nf 2 3 7 6\nusemtl Wood_A\nf 3 4 8 7\n");
    }
    LoadedScene load(const std::string& bsdfs, const std::string& version = "3.0.0",
                     const std::string& more = "") const {
        return parse_scene("<scene version='" + version + "'>\n" + sensor_xml + more +
                               shape("obj", filename("m.obj"), bsdfs) + "</scene>",
                           folder_ / "s.xml");
    }
    /// The reflectance of the square whose middle is at x.
    static float at(const LoadedScene& loaded, float x) {
        const auto hit = loaded.scene->intersect(Ray{Vec3(x - 1.5f, 0, 1), -Vec3::UnitZ()});  // the scene is recentred
        return hit ? hit->bsdf->coefficients_local(Vec3(0, 0, 1)).diffuse[0] : -1.f;
    }
    static std::vector<float> squares(const LoadedScene& loaded) {
        return {at(loaded, 0.5f), at(loaded, 1.5f), at(loaded, 2.5f)};
    }
    TemporaryFolder folder_;
};

TEST_F(ObjMaterials, HaveTheBsdfOfTheirName) {
    const LoadedScene scene = load(grey("glass", 0.1) + grey("Wood_A", 0.2));
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(squares(scene), (std::vector{0.2f, 0.1f, 0.2f}));
}

TEST_F(ObjMaterials, OfOlderScenesMayHaveCapitals) {
    EXPECT_EQ(squares(load(grey("", 0.4) + grey("Wood_A", 0.2), "0.6.0")), (std::vector{0.2f, 0.4f, 0.2f}));
    EXPECT_EQ(squares(load(grey("glass", 0.1) + grey("Wood_A", 0.2), "0.6.0")), (std::vector{0.2f, 0.1f, 0.2f}));
}

TEST_F(ObjMaterials, TakeReferences) {
    const std::string shared = with_id("bsdf", "diffuse", "a", number("reflectance", 0.3));
    EXPECT_EQ(squares(load(reference("Wood_A", "a") + grey("glass", 0.1), "0.6.0", shared)),
              (std::vector{0.3f, 0.1f, 0.3f}));
}

TEST_F(ObjMaterials, WithoutABsdfOfTheirNameHaveTheOneWithoutAName) {
    EXPECT_EQ(squares(load(grey("", 0.4) + grey("glass", 0.1))), (std::vector{0.4f, 0.1f, 0.4f}));
}

TEST_F(ObjMaterials, WithoutAnyBsdfAreGreyWithAWarning) {
    const LoadedScene scene = load(grey("glass", 0.1));
    EXPECT_EQ(squares(scene), (std::vector{0.5f, 0.1f, 0.5f}));
    EXPECT_THAT(scene.warnings,
                ElementsAre(HasSubstr("s.xml:3:1: the material 'Wood_A' of the OBJ file has no bsdf here")));
}

TEST_F(ObjMaterials, OfABsdfThatNoFaceHasAreWarnedOf) {
    const LoadedScene scene = load(grey("", 0.4) + grey("iron", 0.1));
    EXPECT_EQ(squares(scene), (std::vector{0.4f, 0.4f, 0.4f}));
    EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("no face of the OBJ file has the material 'iron'")));
}

TEST_F(ObjMaterials, DoNotMatterToOneBsdfWithAnotherName) {
    const LoadedScene scene = load(grey("bsdf", 0.6));
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.scene->shapes().size(), 1u);
    EXPECT_EQ(squares(scene), (std::vector{0.6f, 0.6f, 0.6f}));
}

TEST(MergedShapes, AreThoseInTheMerge) {
    const auto loaded = test::load(shape("merge", shape("cube"), shape("rectangle", bsdf("null"))));
    EXPECT_EQ(loaded.scene->shapes().size(), 2u);
    expect_errors({{shape("merge", "\n", shape("merge")), "3:1", "a merge cannot hold a shape 'merge'"}});
}

}  // namespace
}  // namespace gib::test::mesh_attribute_test
