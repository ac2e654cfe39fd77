// Tests of MilkShape 3D ASCII files: their meaning, and the place of what is wrong in them.

#include "common/mesh_files/mesh_ms3d.h"
#include "common/core/error.h"
#include "common/scene/scene.h"
#include "tests/support/input_error.h"
#include "tests/support/scene_text.h"
#include "tests/support/texture_fixtures.h"

#include <gmock/gmock.h>

namespace gib::test::mesh_ms3d_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// The model has two meshes (a square with one normal, and a folded one whose triangles share an edge but no normal),
/// two materials and a bone.
const std::string meshes =
    "// MilkShape 3D ASCII\n"  // line 1
    "\n"
    "Frames: 30\n"
    "Frame: 1\n"
    "\n"
    "Meshes: 2\n"
    "\"the floor\" 0 1\n"  // 7
    "4\n"
    "0 0 0 0 0 1 -1\n"  // 9
    "0 2 0 0 1 1 -1\n"
    "0 2 2 0 1 0 0\n"
    "0 0 2.0 0 0 0.0 -1\n"
    "1\n"  // 13
    "0.000000 0.000000 1.000000\n"
    "2\n"
    "0 0 1 2 0 0 0 1\n"  // 16
    "1 0 2 3 0 0 0 1\n"
    "\"roof\" 1 -1\n"  // 18
    "4\n"
    "0 0 0 0 0 0 -1\n"
    "0 1 0 0 1 0 -1\n"
    "0 0 1 0 0 1 -1\n"
    "0 1 1 5 1 1 -1\n"
    "2\n"
    "0 0 1\n"
    "0 0 2\n"
    "2\n"
    "0 0 1 2 0 0 0 1\n"
    "0 1 3 2 1 1 1 2\n";  // 29
const std::string materials =
    "\n"
    "Materials: 2\n"
    "\"red\"\n"  // 32
    "0.2 0.2 0.2 1\n"
    "0.8 0.1 0.2 1\n"  // 34
    "0 0 0 1\n"
    "0 0 0 1\n"
    "0\n"
    "1\n"
    "\"\"\n"
    "\"\"\n"
    "\"polished brass\"\n"  // 41
    "0.2 0.2 0.2 1\n"
    "0.5 0.4 0.3 1\n"
    "0.9 0.8 0.7 0.5\n"
    "0.1 0.2 0.3 0\n"
    "64.000000\n"  // 46
    "0.500000\n"
    "\".\\maps\\brass plate.bmp\"\n"
    "\"\"\n";
const std::string bones =
    "\n"
    "Bones: 1\n"
    "\"root\"\n"  // 52
    "\"\"\n"
    "0 0 1 2 0 0 0.5\n"
    "2\n"
    "1 0 0 0\n"
    "30 1 2 3\n"
    "1\n"
    "1 0 0 0\n"
    "GroupComments: 1\n"  // 60
    "0\n"
    "anything \" at // all\n"
    "MaterialComments: 0\n"
    "BoneComments: 0\n"
    "ModelComment: 1\n"
    "\n";

/// Writes the bitmap that the second material refers to.
void write_map(const TemporaryFolder& folder) {
    FileFormat bytes;
    bytes.type = OIIO::TypeDesc::UINT8;
    write_image(folder.write("maps/brass plate.bmp", ""), 2, 1, 3, {1, 0, 0, 0, 1, 0}, bytes);
}

std::string error_of(const std::string& text) {
    return input_error_of([&] { parse_ms3d(text, "m.txt"); });
}

TEST(Ms3dFile, ReadsMeshesAndMaterials) {
    const Ms3dModel model = parse_ms3d(meshes + materials + bones, "m.txt");
    ASSERT_EQ(model.groups.size(), 2u);
    const Ms3dGroup& floor = model.groups[0];
    EXPECT_EQ(floor.name, "the floor");
    EXPECT_EQ(floor.material, 1u);
    ASSERT_EQ(floor.mesh.triangles.size(), 2u);
    EXPECT_EQ(floor.mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
    ASSERT_EQ(floor.mesh.positions.size(), 4u);
    EXPECT_EQ(floor.mesh.positions[2], Vec3d(2, 2, 0));
    EXPECT_EQ(floor.mesh.normals[2], Vec3(0, 0, 1));
    EXPECT_EQ(floor.mesh.uvs[0], Vec2(0, 1));
    EXPECT_FALSE(model.groups[1].material);
    EXPECT_EQ(model.groups[1].mesh.positions.size(), 6u) << "corners with different normals share no vertex";
    ASSERT_EQ(model.materials.size(), 2u);
    const Ms3dMaterial& brass = model.materials[1];
    EXPECT_EQ(brass.name, "polished brass");
    EXPECT_EQ(brass.diffuse[1], 0.4f);
    EXPECT_EQ(brass.specular[2], 0.7f);
    EXPECT_EQ(brass.emissive[0], 0.1f);
    EXPECT_EQ(brass.shininess, 64.f);
    EXPECT_EQ(brass.transparency, 0.5f);
    EXPECT_EQ(brass.texture, ".\\maps\\brass plate.bmp");
    EXPECT_EQ(model.materials[0].texture, "");
}

TEST(Ms3dFile, ReadsCarriageReturnsCommentsAndNoLastLineEnd) {
    std::string text;
    for (const char c : meshes + materials + bones)
        text += c == '\n' ? std::string("\r\n// between\r\n\r\n") : std::string(1, c);
    const Ms3dModel model = parse_ms3d(text, "m.txt");
    EXPECT_EQ(model.groups.size(), 2u);
    EXPECT_EQ(model.materials[1].name, "polished brass");
    // A file without bones, and without the end of its last line.
    std::string boneless = meshes + materials;
    boneless.pop_back();
    EXPECT_EQ(parse_ms3d(boneless, "m.txt").materials.size(), 2u);
}

TEST(Ms3dFile, GroupsWithoutTrianglesAreLeftOut) {
    const std::string empty = "\"nothing\" 0 -1\n0\n0\n0\n";
    std::string text = meshes;
    text.replace(text.find("Meshes: 2\n"), 10, "Meshes: 3\n" + empty);
    EXPECT_EQ(parse_ms3d(text + materials + bones, "m.txt").groups.size(), 2u);
    EXPECT_THAT(error_of("Meshes: 1\n" + empty), StartsWith("m.txt:1:1: the model is empty"));
    EXPECT_THAT(error_of("Meshes: 0\n"), HasSubstr("the model is empty"));
}

TEST(Ms3dFile, EveryTruncationIsAnErrorUpToTheBones) {
    const std::string whole = meshes + materials;
    // Only the end of the last line may be missing.
    for (std::size_t size = 0; size + 1 < whole.size(); ++size)
        EXPECT_NE(error_of(whole.substr(0, size)), "no error") << size;
    EXPECT_THAT(error_of(whole.substr(0, whole.find("1 0 2 3 0"))), HasSubstr("truncated: the file ends"));
    EXPECT_THAT(error_of("Meshes: 2000000000\n"), StartsWith("m.txt:2:1: truncated"));
    EXPECT_THAT(error_of("Meshes: 1\n\"a\" 0 -1\n2000000000\n"), StartsWith("m.txt:4:1: truncated"));
}

/// The error of the model in which `to` replaces the first `from`.
std::string error_with(const std::string& from, const std::string& to) {
    std::string text = meshes + materials + bones;
    text.replace(text.find(from), from.size(), to);
    return error_of(text);
}

TEST(Ms3dFile, ErrorsNameThePlace) {
    EXPECT_THAT(error_of(""), StartsWith("m.txt:1:1: the model is empty"));
    EXPECT_THAT(error_of("ply\n"), StartsWith("m.txt:1:1: unknown word 'ply': expected Frames:"));
    EXPECT_THAT(error_with("Frames: 30", "Frames: x"), StartsWith("m.txt:3:9: bad number 'x'"));
    EXPECT_THAT(error_with("Frames: 30", "Frames: 30 1"), StartsWith("m.txt:3:12: too many words"));
    EXPECT_THAT(error_with("Meshes: 2", "Meshes: -2"), StartsWith("m.txt:6:9: a count cannot be -2"));
    EXPECT_THAT(error_with("Meshes: 2", "Meshes: 99999999999"), StartsWith("m.txt:6:9: a count cannot be"));
    EXPECT_THAT(error_with("Meshes: 2", "Meshes: 1"), StartsWith("m.txt:18:1: unknown word '\"roof\"'"));
    EXPECT_THAT(error_with("\"the floor\"", "floor"), StartsWith("m.txt:7:1: expected a name in quotes"));
    EXPECT_THAT(error_with("\"the floor\"", "\"the floor"), StartsWith("m.txt:7:1: the quote is not closed"));
    EXPECT_THAT(error_with("floor\" 0 1", "floor\" 0 2"),
                StartsWith("m.txt:7:15: material 2 is out of range: there are 2"));
    EXPECT_THAT(error_with("floor\" 0 1", "floor\" 0 -2"), StartsWith("m.txt:7:15: a material cannot be -2"));
    EXPECT_THAT(error_with("0 2 2 0 1 0 0", "0 2 2 0 1 0"), StartsWith("m.txt:11:12: an integer is missing"));
    EXPECT_THAT(error_with("0 2 2 0 1 0 0", "0 2 2 0 1 0 0 0"), StartsWith("m.txt:11:15: too many words"));
    EXPECT_THAT(error_with("0 2 2 0 1 0 0", "0 2 nan 0 1 0 0"), StartsWith("m.txt:11:5: a vertex is not finite"));
    EXPECT_THAT(error_with("0 2 2 0 1 0 0", "0 2 2 0 inf 0 0"),
                StartsWith("m.txt:11:9: a texture coordinate is not finite"));
    EXPECT_THAT(error_with("0.000000 0.000000 1.000000", "0 0 1e999"), StartsWith("m.txt:14:5: "));
    EXPECT_THAT(error_with("0 0 1 2 0 0 0 1", "0 0 1 4 0 0 0 1"),
                StartsWith("m.txt:16:7: vertex index 4 is out of range: there are 4"));
    EXPECT_THAT(error_with("0 0 1 2 0 0 0 1", "0 0 -1 2 0 0 0 1"),
                StartsWith("m.txt:16:5: vertex index -1 is out of range"));
    EXPECT_THAT(error_with("0 0 1 2 0 0 0 1", "0 0 1 2 0 1 0 1"),
                StartsWith("m.txt:16:11: normal index 1 is out of range: there are 1"));
    EXPECT_THAT(error_with("0 0 1 2 0 0 0 1", "0 0 1 2 0 0 0 1.5"), StartsWith("m.txt:16:15: bad number '1.5'"));
    EXPECT_THAT(error_with("0.8 0.1 0.2 1", "0.8 1.1 0.2 1"),
                StartsWith("m.txt:34:5: the diffuse colour must be between 0 and 1, not 1.1"));
    EXPECT_THAT(error_with("0.8 0.1 0.2 1", "0.8 0.1 0.2"), StartsWith("m.txt:34:12: a number is missing"));
    EXPECT_THAT(error_with("64.000000", "-1"),
                StartsWith("m.txt:46:1: the shininess must be between 0 and 100000000, not -1"));
    EXPECT_THAT(error_with("64.000000", "1e9"), StartsWith("m.txt:46:1: the shininess must be between 0 and"));
    EXPECT_THAT(error_with("0.500000", "1.5"),
                StartsWith("m.txt:47:1: the transparency must be between 0 and 1, not 1.5"));
}

TEST(Ms3dFile, ScenesTakeEveryGroupWithItsMaterial) {
    const TemporaryFolder folder;
    folder.write("m.txt", meshes + materials + bones);
    write_map(folder);
    const auto load = [&](const std::string& body) {
        return load_scene(folder.write("s.xml", scene_with(shape("ms3d", filename("m.txt"), body)))).scene;
    };
    const auto albedo = [](const Scene& scene, std::size_t shape, float u = 0) {
        const MaterialPoint point{Vec2(u, 0.5f), Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(), Frame(Vec3::UnitZ())};
        const Bsdf bsdf = scene.material_of_shape(shape).at(point);
        EXPECT_EQ(bsdf.pass_through(), scene.material_of_shape(shape).has_holes() ? 0.5f : 0.f);
        return Color(pi * bsdf.f_local(Vec3(0, 0, 1), Vec3(0.995f, 0, 0.1f)).diffuse);  // far from the highlight
    };
    const auto scene = load("");
    ASSERT_EQ(scene->shapes().size(), 2u);
    // The floor is half transparent. Its bitmap is red on the left and green on the right; the highlight takes 0.9 /
    // 1.9 and bounds the diffuse reflectance by the rest.
    EXPECT_NEAR(albedo(*scene, 0, 0.25f)[0], 1 - 0.9f / 1.9f, 1e-6f);
    EXPECT_EQ(albedo(*scene, 0, 0.25f)[1], 0.f);
    EXPECT_NEAR(albedo(*scene, 0, 0.75f)[1], 1 - 0.8f / 1.9f, 1e-6f);
    EXPECT_NEAR(albedo(*scene, 1)[1], 0.5f, 1e-6f);  // no material: the default
    const Mesh& floor = std::get<Mesh>(scene->shapes()[0]);
    EXPECT_EQ(floor.normals[0], Vec3(0, 0, 1));
    EXPECT_EQ(floor.uvs[0], Vec2(0, 1));
    EXPECT_FALSE(floor.flip_normals);
    EXPECT_GT(floor.normal_of(0).z(), 0);
    ASSERT_EQ(scene->lights().size(), 1u);  // the brass glows
    EXPECT_EQ(std::get<AreaLight>(scene->lights()[0]).radiance[2], 0.3f);
    const auto black = load(bsdf("diffuse", number("reflectance", 0)));
    EXPECT_EQ(albedo(*black, 0)[1], 0.f);
    EXPECT_EQ(albedo(*black, 1)[1], 0.f);
    EXPECT_EQ(black->materials().size(), 1u);
    const auto lamps = load(emitter("area"));
    EXPECT_EQ(lamps->lights().size(), 2u);
    const auto options =
        load(flag("face_normals") + flag("flip_normals") + flag("flip_tex_coords") + to_world(scale(2)));
    const Mesh& changed = std::get<Mesh>(options->shapes()[0]);
    EXPECT_TRUE(changed.normals.empty());
    EXPECT_TRUE(changed.flip_normals);
    EXPECT_EQ(changed.uvs[0], Vec2(0, 0));
    EXPECT_NEAR(area_of(options->shapes()[0]), 16, 1e-5);
    EXPECT_THROW(load(number("scale", 2)), InputError);
    EXPECT_THROW(load(integer("shape_index", 0)), InputError);
}

TEST(Ms3dFile, EmissiveMaterialsCannotBeInstanced) {
    const TemporaryFolder folder;
    folder.write("m.txt", meshes + materials + bones);
    write_map(folder);
    const std::string group = shape("shapegroup", shape("ms3d", filename("m.txt")));
    try {
        load_scene(folder.write("s.xml", scene_with(group)));
        ADD_FAILURE() << "no error";
    } catch (const InputError& e) {
        EXPECT_THAT(e.what(), HasSubstr("an emitter cannot stand in a shapegroup"));
    }
}

TEST(Ms3dFile, GroupsOfOneMaterialShareIt) {
    const TemporaryFolder folder;
    std::string text = meshes + materials + bones;
    text.replace(text.find("\"roof\" 1 -1"), 11, "\"roof\" 1 1");
    folder.write("m.txt", text);
    write_map(folder);
    const auto loaded = load_scene(folder.write("s.xml", scene_with(shape("ms3d", filename("m.txt")))));
    EXPECT_EQ(loaded.scene->materials().size(), 1u);
}

}  // namespace
}  // namespace gib::test::mesh_ms3d_test
