// Tests of MilkShape 3D ASCII files: their meaning, and the place of what is wrong in them.

#include "common/mesh_files/mesh_ms3d.h"
#include "common/core/error.h"
#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"
#include "tests/support/texture_fixtures.h"

namespace gib::test::mesh_ms3d_test {
namespace {

/// The model has two meshes (a square with one normal, and a folded one whose triangles share an edge but no normal),
/// two materials and a bone.
const std::string meshes =
    "// MilkShape 3D ASCII\n\nFrames: 30\nFrame: 1\n\nMeshes: 2\n"         // lines 1 to 6
    "\"the floor\" 0 1\n4\n"                                               // 7
    "0 0 0 0 0 1 -1\n0 2 0 0 1 1 -1\n0 2 2 0 1 0 0\n0 0 2.0 0 0 0.0 -1\n"  // 9
    "1\n0.000000 0.000000 1.000000\n"                                      // 13
    "2\n0 0 1 2 0 0 0 1\n1 0 2 3 0 0 0 1\n"                                // 15
    "\"roof\" 1 -1\n4\n"                                                   // 18
    "0 0 0 0 0 0 -1\n0 1 0 0 1 0 -1\n0 0 1 0 0 1 -1\n0 1 1 5 1 1 -1\n"     // 20
    "2\n0 0 1\n0 0 2\n"                                                    // 24
    "2\n0 0 1 2 0 0 0 1\n0 1 3 2 1 1 1 2\n";                               // 27
const std::string materials =
    "\nMaterials: 2\n"                                                                    // 30
    "\"red\"\n0.2 0.2 0.2 1\n0.8 0.1 0.2 1\n0 0 0 1\n0 0 0 1\n"                           // 32
    "0\n1\n\"\"\n\"\"\n"                                                                  // 37
    "\"polished brass\"\n0.2 0.2 0.2 1\n0.5 0.4 0.3 1\n0.9 0.8 0.7 0.5\n0.1 0.2 0.3 0\n"  // 41
    "64.000000\n0.500000\n\".\\maps\\brass plate.bmp\"\n\"\"\n";                          // 46
const std::string bones =
    "\nBones: 1\n\"root\"\n\"\"\n0 0 1 2 0 0 0.5\n2\n1 0 0 0\n30 1 2 3\n1\n1 0 0 0\n"                         // 50
    "GroupComments: 1\n0\nanything \" at // all\nMaterialComments: 0\nBoneComments: 0\nModelComment: 1\n\n";  // 60

/// Writes the model and the bitmap that its second material refers to.
void write_model(const TemporaryFolder& folder, const std::string& model) {
    folder.write("m.txt", model);
    const FileFormat bytes{OIIO::TypeDesc::UINT8, 0, {}, {}};
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
    expect_errors({{whole.substr(0, whole.find("1 0 2 3 0")), "", "truncated: the file ends"},
                   {"Meshes: 2000000000\n", "2:1", "truncated"},
                   {"Meshes: 1\n\"a\" 0 -1\n2000000000\n", "4:1", "truncated"}},
                  error_of, "m.txt");
}

/// The model in which `to` replaces the first `from`.
std::string with(const std::string& from, const std::string& to) {
    std::string text = meshes + materials + bones;
    return text.replace(text.find(from), from.size(), to);
}

TEST(Ms3dFile, ErrorsNameThePlace) {
    expect_errors({{"", "1:1", "the model is empty"}, {"ply\n", "1:1", "unknown word 'ply': expected Frames:"}},
                  error_of, "m.txt");
    const std::array<std::string, 4> rows[] = {
        {"Frames: 30", "Frames: x", "3:9", "bad number 'x'"},
        {"Meshes: 2", "Meshes: -2", "6:9", "a count cannot be -2"},
        {"Meshes: 2", "Meshes: 1", "18:1", "unknown word '\"roof\"'"},
        {"\"the floor\"", "floor", "7:1", "expected a name in quotes"},
        {"\"the floor\"", "\"the floor", "7:1", "the quote is not closed"},
        {"floor\" 0 1", "floor\" 0 2", "7:15", "material 2 is out of range: there are 2"},
        {"0 2 2 0 1 0 0", "0 2 2 0 1 0", "11:12", "an integer is missing"},
        {"0 2 2 0 1 0 0", "0 2 nan 0 1 0 0", "11:5", "a vertex is not finite"},
        {"0.000000 0.000000 1.000000", "0 0 1e999", "14:5", ""},
        {"0 0 1 2 0 0 0 1", "0 0 1 4 0 0 0 1", "16:7", "vertex index 4 is out of range: there are 4"},
        {"0 0 1 2 0 0 0 1", "0 0 1 2 0 1 0 1", "16:11", "normal index 1 is out of range: there are 1"},
        {"0.8 0.1 0.2 1", "0.8 1.1 0.2 1", "34:5", "the diffuse colour must be between 0 and 1, not 1.1"},
        {"64.000000", "-1", "46:1", "the shininess must be between 0 and 100000000, not -1"},
        {"0.500000", "1.5", "47:1", "the transparency must be between 0 and 1, not 1.5"}};
    for (const auto& [from, to, place, message] : rows)
        expect_errors({{with(from, to), place, message}}, error_of, "m.txt");
}

TEST(Ms3dFile, ScenesTakeEveryGroupWithItsMaterial) {
    const TemporaryFolder folder;
    write_model(folder, meshes + materials + bones);
    const auto load = [&](const std::string& body) {
        return load_in(folder, shape("ms3d", filename("m.txt"), body)).scene;
    };
    const auto albedo = [](const gib::Scene& scene, std::size_t shape, float u = 0) {
        const MaterialPoint at{Vec2(u, 0.5f), Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(), Frame(Vec3::UnitZ())};
        const Bsdf bsdf = scene.material_of_shape(shape).at(at);
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
    write_model(folder, meshes + materials + bones);
    EXPECT_THAT(input_error_of([&] { load_in(folder, shape("shapegroup", shape("ms3d", filename("m.txt")))); }),
                HasSubstr("an emitter cannot stand in a shapegroup"));
}

TEST(Ms3dFile, GroupsOfOneMaterialShareIt) {
    const TemporaryFolder folder;
    write_model(folder, with("\"roof\" 1 -1", "\"roof\" 1 1"));
    EXPECT_EQ(load_in(folder, shape("ms3d", filename("m.txt"))).scene->materials().size(), 1u);
}

}  // namespace
}  // namespace gib::test::mesh_ms3d_test
