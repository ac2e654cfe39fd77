// Tests of OBJ and PLY files: their meaning, and the place of what is wrong in them.

#include "common/core/error.h"
#include "common/mesh_files/mesh_data.h"
#include "common/mesh_files/mesh_materials.h"
#include "tests/support/mesh_area.h"
#include "tests/support/scene_errors.h"

#include <bit>

namespace gib::test::mesh_file_test {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::string obj_error(const std::string& text) {
    return input_error_of([&] { parse_obj(text, "m.obj"); });
}
std::string ply_error(const std::string& text) {
    return input_error_of([&] { parse_ply(text, "m.ply"); });
}

TEST(ObjFile, FansPolygonsAndSharesVertices) {
    const MeshData mesh = parse_obj("# a square\no square\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n", "m.obj");
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
    EXPECT_EQ(mesh.triangles[1], (Triangle{0, 2, 3}));
    EXPECT_DOUBLE_EQ(area_of(mesh), 4);
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.uvs.empty());
}

TEST(ObjFile, ReadsEveryFormOfACorner) {
    const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.75\nvn 0 0 2\n";
    const MeshData all = parse_obj(head + "f 1/1/1 2/1/1 3/1/1\n", "m.obj");
    EXPECT_EQ(all.uvs[0], Vec2(0.25f, 0.75f));
    EXPECT_EQ(all.normals[2], Vec3(0, 0, 2));
    EXPECT_TRUE(parse_obj(head + "f 1/1 2/1 3/1\n", "m.obj").normals.empty());
    EXPECT_TRUE(parse_obj(head + "f 1//1 2//1 3//1\n", "m.obj").uvs.empty());
    const MeshData relative = parse_obj(head + "f -3 -2 -1\n", "m.obj");
    EXPECT_EQ(relative.positions[0], Vec3d(0, 0, 0));
    EXPECT_EQ(relative.positions[2], Vec3d(0, 1, 0));
}

TEST(ObjFile, SplitsAVertexWithTwoNormals) {
    const MeshData mesh = parse_obj(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n", "m.obj");
    EXPECT_EQ(mesh.positions.size(), 6u);
    EXPECT_EQ(mesh.normals[mesh.triangles[0][0]], Vec3(0, 0, 1));
    EXPECT_EQ(mesh.normals[mesh.triangles[1][0]], Vec3(1, 0, 0));
}

/// An OBJ file of `count` normals and, `times` over, `count` triangles. Triangle i has normal i at its first corner,
/// which is one vertex for all or a vertex of its own.
std::string many_normals(std::uint32_t count, bool one_vertex, int times = 1) {
    std::string text, faces;
    for (std::uint32_t i = 1; i <= count; ++i) {
        const std::string n = std::to_string(i);
        text += "v 0 " + std::string(one_vertex ? "0" : n) + " 0\nvn 0 " + n + " 1\n";
        faces += "f " + (one_vertex ? "1" : n) + "//" + n + " 2//1 3//1\n";
    }
    for (int i = 0; i < times; ++i)
        text += faces;
    return text;
}

// These are more normals at a vertex than the first few, beyond which the reader stores them in another way.
TEST(ObjFile, SplitsAVertexWithManyNormals) {
    constexpr std::uint32_t count = 1000;
    const MeshData mesh = parse_obj(many_normals(count, true, 2), "m.obj");
    EXPECT_EQ(mesh.positions.size(), count + 2);
    ASSERT_EQ(mesh.triangles.size(), 2 * count);
    for (std::uint32_t i = 0; i < 2 * count; ++i) {
        const std::uint32_t first = mesh.triangles[i][0];
        EXPECT_EQ(mesh.normals[first], Vec3(0, static_cast<float>(i % count + 1), 1)) << i;
        EXPECT_EQ(mesh.positions[first], Vec3d(0, 0, 0)) << i;
        EXPECT_EQ(mesh.triangles[i], mesh.triangles[i % count]) << i;
    }
}

TEST(ObjFile, ReadsCarriageReturnsAndNoLastLineEnd) {
    EXPECT_EQ(parse_obj("v 0 0 0\r\nv +1 0 0\r\nv 0 1e0 0\r\nf 1 2 3", "m.obj").triangles.size(), 1u);
}

TEST(ObjFile, SkipsAByteOrderMark) {
    const MeshData mesh = parse_obj("\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 7\nf 1 2 3\n", "m.obj");
    EXPECT_TRUE(mesh.warnings.messages().empty());
    EXPECT_EQ(mesh.positions[0], Vec3d(0, 0, 0));
    EXPECT_DOUBLE_EQ(area_of(mesh), 0.5);
}

TEST(ObjFile, WarnsOnceOfAnUnknownWord) {
    const MeshData mesh = parse_obj(
        "mtllib a.mtl\no a\ng a b\ns 1\nusemtl red\nl 1 2\nv 0 0 0\n  V 1 0 0\nV 1 0 1\nv 1 0 0\nv 0 1 0\n"
        "\xEF\xBB\xBFv 1 1 1\nf 1 2 3\n",
        "m.obj");
    ASSERT_EQ(mesh.warnings.messages().size(), 2u);
    EXPECT_EQ(mesh.warnings.messages()[0], "m.obj:8:3: unknown word 'V': lines that start with it are passed over");
    EXPECT_THAT(mesh.warnings.messages()[1], StartsWith("m.obj:12:1: unknown word"));
}

TEST(ObjFile, AWarningAboutAFileOfTwoShapesComesOnce) {
    const TemporaryFolder folder;
    const std::string obj = folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nW 1\nf 1 2 3\n");
    const std::string mesh = shape("obj", filename("m.obj"));
    EXPECT_EQ(load_in(folder, mesh + mesh).warnings,
              std::vector{obj + ":4:1: unknown word 'W': lines that start with it are passed over"});
}

TEST(ObjFile, TakesACornerWhoseTextureCoordinateIsMissingAfterItsSlash) {
    const MeshData mesh = parse_obj("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1/ 2/ 3/ 4/\n", "m.obj");
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_TRUE(mesh.uvs.empty());
    EXPECT_DOUBLE_EQ(area_of(mesh), 4);
}

TEST(ObjFile, JoinsLinesAfterABackslash) {
    for (const std::string end : {"\n", "\r\n"}) {
        std::string text;
        for (const char* line : {"# a comment ends with its line \\", "v 0 0 0", "v 2 \\", "0 0", "v 2 2 0", "l 1 2 \\",
                                 "3", "v 0 2 0", "f 1 2\\", "3 \\", " 4"})
            text += line + end;
        const MeshData mesh = parse_obj(text, "m.obj");
        EXPECT_TRUE(mesh.warnings.messages().empty());
        EXPECT_EQ(mesh.positions.size(), 4u);
        EXPECT_DOUBLE_EQ(area_of(mesh), 4);
    }
}

TEST(ObjFile, IsPartedByItsMaterials) {
    const MeshData mesh = parse_obj(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 5\nvt 0.5 1\nvn 0 0 1\nf 5 1 2\nusemtl red wall\nf 1/1/1 2/1/1 "
        "3/1/1\nusemtl blue\nf 1 2 4\nusemtl red wall \nf 1 3 4 2\n",
        "m.obj");
    const auto parts = parted_by_material(mesh);
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_EQ(parts[0].material, "");
    EXPECT_EQ(parts[1].material, "red wall");
    EXPECT_EQ(parts[2].material, "blue");
    EXPECT_EQ(parts[0].mesh.triangles.size(), 1u);
    EXPECT_EQ(parts[0].mesh.positions[0], Vec3d(0, 0, 5));
    ASSERT_EQ(parts[1].mesh.triangles.size(), 3u);
    EXPECT_EQ(parts[1].mesh.positions.size(), 7u);  // three with a normal and four without
    EXPECT_EQ(parts[1].mesh.uvs[0], Vec2(0.5f, 1));
    EXPECT_EQ(parts[1].mesh.normals[2], Vec3(0, 0, 1));
    EXPECT_EQ(parts[2].mesh.triangles[0], (Triangle{0, 1, 2}));
    EXPECT_EQ(parts[2].mesh.positions[2], Vec3d(0, 1, 0));
}

TEST(ObjFile, ErrorsNameThePlace) {
    expect_errors({{"v 0 0\nf 1 1 1\n", "1:6", "a number is missing"},
                   {"v 0 0 0\nv 0 x 0\n", "2:5", "bad number 'x'"},
                   {"v 0 nan 0\n", "1:5", "a vertex is not finite"},
                   {"v 0 0 0\nf 1 1 2\n", "2:7", "vertex index 2 is out of range"},
                   {"v 0 0 0\nf 1/1 1 1\n", "2:5", "texture coordinate index 1 is out of range"},
                   {"v 0 0 0\nf 1 1\n", "3:1", "the mesh is empty"},
                   {"v 0 0 0\nvn 0 0 1\nf 1// 1 1// 1\n", "3:6", "a normal index is missing"},
                   {"v 0 0 0\nf 1 \\\n 1 x\n", "3:4", "bad number 'x'"},
                   {"v 0 0 0\nf 1 1 1//\r\n", "2:10", "a normal index is missing"},
                   {"", "1:1", "the mesh is empty"}},
                  obj_error, "m.obj");
}

const std::string square_header =
    "element vertex 4\nproperty float x\nproperty uchar red\nproperty double y\nproperty float z\n"
    "element edge 1\nproperty list uchar int ends\n"
    "element face 1\nproperty list uchar uint vertex_indices\nproperty short tag\nend_header\n";

template <typename T>
void append(std::string& bytes, T value, bool big) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
    if (big != (std::endian::native == std::endian::big)) raw = std::string(raw.rbegin(), raw.rend());
    bytes += raw;
}

/// The square [0, 3]^2 with an unknown property between the known ones.
std::string binary_square(bool big) {
    std::string ply =
        std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\ncomment c\n" + square_header;
    for (const auto& [x, y] : {std::pair(0.f, 0.), std::pair(3.f, 0.), std::pair(3.f, 3.), std::pair(0.f, 3.)}) {
        append(ply, x, big);
        append<std::uint8_t>(ply, 200, big);
        append(ply, y, big);
        append(ply, 1.f, big);
    }
    append<std::uint8_t>(ply, 2, big);
    append<std::int32_t>(ply, 0, big);
    append<std::int32_t>(ply, 1, big);
    append<std::uint8_t>(ply, 4, big);
    for (std::uint32_t i = 0; i < 4; ++i)
        append(ply, i, big);
    append<std::int16_t>(ply, -1, big);
    return ply;
}

TEST(PlyFile, AllFormatsMeanTheSame) {
    const std::string ascii =
        "ply\nformat ascii 1.0\n" + square_header + "0 200 0 1\n3 200 0 1\n3 200 3 1 0 200 3 1\n2 0 1\n4 0 1 2 3 -1\n";
    for (const std::string& ply : {ascii, binary_square(false), binary_square(true)}) {
        const MeshData mesh = parse_ply(ply, "m.ply");
        ASSERT_EQ(mesh.positions.size(), 4u);
        ASSERT_EQ(mesh.triangles.size(), 2u);
        EXPECT_EQ(mesh.positions[2], Vec3d(3, 3, 1));
        EXPECT_EQ(mesh.triangles[1], (Triangle{0, 2, 3}));
        EXPECT_DOUBLE_EQ(area_of(mesh), 9);
    }
}

TEST(PlyFile, ReadsNormalsAndTextureCoordinates) {
    const MeshData mesh = parse_ply(
        "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
        "property float nx\r\nproperty float ny\r\nproperty float nz\r\nproperty float s\r\nproperty float t\r\n"
        "element face 1\r\nproperty list uchar int vertex_index\r\nend_header\r\n"
        "0 0 0 0 0 1 0 0\r\n1 0 0 0 0 1 1 0\r\n0 1 0 0 1 0 0 0.5\r\n3 0 1 2\r\n",
        "m.ply");
    EXPECT_EQ(mesh.normals[2], Vec3(0, 1, 0));
    EXPECT_EQ(mesh.uvs[2], Vec2(0, 0.5f));
}

TEST(PlyFile, TruncatedFilesAreErrorsAtEveryLength) {
    const std::string whole = binary_square(false);
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_THROW(parse_ply(whole.substr(0, size), "m.ply"), InputError) << size;
    EXPECT_THAT(ply_error(whole.substr(0, whole.size() - 3)),
                StartsWith("m.ply:14:1: truncated: the file ends at byte " + std::to_string(whole.size() - 3)));
    EXPECT_THAT(ply_error(whole + "x"), StartsWith("m.ply:14:1: more data than the PLY header says"));
}

TEST(PlyFile, AHugeCountReservesNoMemory) {
    EXPECT_THAT(
        ply_error("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\nproperty float x\nproperty "
                  "float y\nproperty float z\nend_header\n"),
        StartsWith("m.ply:7:1: truncated"));
}

TEST(MeshFiles, FacesOfFewerThanThreeCornersAreLeftOutWithAWarning) {
    const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
    const MeshData obj = parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\nf 3\n", "m.obj"),
                   ply = parse_ply(
                       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                       "float z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n" +
                           corners + "2 0 1\n3 0 1 2\n0\n",
                       "m.ply");
    for (const MeshData* mesh : {&obj, &ply}) {
        EXPECT_EQ(mesh->triangles, (std::vector<Triangle>{{0, 1, 2}}));
        ASSERT_EQ(mesh->warnings.messages().size(), 1u);
        EXPECT_THAT(mesh->warnings.messages()[0],
                    HasSubstr("faces of fewer than three corners are left out, the first here"));
    }
    EXPECT_THAT(obj.warnings.messages()[0], StartsWith("m.obj:4:"));
}

TEST(PlyFile, ErrorsNameThePlace) {
    const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz +
                             "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    expect_errors({{"play\n", "1:1", "not a PLY file"},
                   {"ply\nformat text 1.0\n", "2:8", "unknown PLY format 'text'"},
                   {"ply\nformat ascii 1.0\nelement vertex 3\nproperty half x\n", "", "unknown PLY type 'half'"},
                   {"ply\nformat ascii 1.0\nelement vertex 3\n", "", "there is no 'end_header'"},
                   {"ply\nelement vertex 0\n" + xyz + "end_header\n", "6:1", "the PLY header has no"},
                   {"ply\nformat ascii 1.0\nelement vertex 0\n" + xyz + "end_header\n", "", "the mesh is empty"},
                   {head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "13:7", "vertex index 3 is out of range"},
                   {head + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "11:3", "vertex 1 is not finite"},
                   {head + "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "14:1", "truncated"}},
                  ply_error, "m.ply");
}

TEST(MeshNormals, AreWeightedWithTheAngleAtTheVertex) {
    // The corner of a box whose side x = 0 is split into two triangles, unlike the other sides. Each side has the
    // weight of its right angle.
    MeshData mesh =
        parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 1 1\nf 1 3 2\nf 1 2 4\nf 1 4 5\nf 1 5 3\n", "m.obj");
    compute_normals(mesh);
    EXPECT_LT((mesh.normals[0] - Vec3(-1, -1, -1).normalized()).norm(), 1e-6f);
}

TEST(MeshNormals, OnlyThoseThatAreMissingAreComputed) {
    MeshData mesh = parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2 3\n", "m.obj");
    compute_normals(mesh);
    EXPECT_EQ(mesh.normals[0], Vec3(1, 0, 0));
    EXPECT_LT((mesh.normals[1] - Vec3(0, 0, 1)).norm(), 1e-6f);
}

}  // namespace
}  // namespace gib::test::mesh_file_test
