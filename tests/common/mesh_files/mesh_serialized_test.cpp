// Tests of Mitsuba's serialized meshes: their meaning, and that no kind of damage goes unnoticed.

#include "common/core/error.h"
#include "common/mesh_files/mesh_data.h"
#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"

#include <zlib.h>

namespace gib::test::mesh_serialized_test {
namespace {

template <typename T>
void append(std::string& bytes, T value) {
    static_assert(std::endian::native == std::endian::little);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string compressed(const std::string& raw) {
    std::string out(compressBound(raw.size()), '\0');
    uLongf size = out.size();
    EXPECT_EQ(
        compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(raw.data()), raw.size()),
        Z_OK);
    out.resize(size);
    return out;
}

/// The square [0, side]^2 in two triangles, with everything that a mesh may have.
struct Square {
    int version = 4;
    std::uint32_t flags = 0x1000;
    double side = 2;
    std::uint64_t vertices = 4, triangles = 2;
    std::uint32_t last_index = 3;
    double bad_coordinate = 0;  ///< z of the last vertex
    std::string extra = "";     ///< at the end of the compressed data

    std::string raw() const {
        std::string bytes;
        append(bytes, flags);
        if (version == 4) bytes += std::string("square\0", 7);
        append(bytes, vertices);
        append(bytes, triangles);
        const auto number = [&](double x) {
            if (flags & 0x2000) append(bytes, x);
            else append(bytes, static_cast<float>(x));
        };
        const double corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        for (const auto& c : corners) {
            number(side * c[0]);
            number(side * c[1]);
            number(&c == &corners[3] ? bad_coordinate : 0);
        }
        if (flags & 0x1)
            for (int i = 0; i < 4; ++i)
                for (const double x : {0., 0.6, 0.8})
                    number(x);
        if (flags & 0x2)
            for (const auto& c : corners) {
                number(c[0] / 4);
                number(c[1]);
            }
        if (flags & 0x8)
            for (int i = 0; i < 12; ++i)
                number(0.5);
        for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, last_index})
            append(bytes, i);
        return bytes + extra;
    }
    /// The compressed mesh with its uncompressed header.
    std::string stream() const {
        std::string bytes;
        append<std::uint16_t>(bytes, 0x041c);
        append(bytes, static_cast<std::uint16_t>(version));
        return bytes + compressed(raw());
    }
};

std::string file_of(const std::vector<Square>& meshes) {
    std::string bytes;
    std::vector<std::uint64_t> offsets;
    for (const auto& mesh : meshes) {
        offsets.push_back(bytes.size());
        bytes += mesh.stream();
    }
    for (const std::uint64_t offset : offsets) {
        if (meshes[0].version == 4) append(bytes, offset);
        else append(bytes, static_cast<std::uint32_t>(offset));
    }
    append(bytes, static_cast<std::uint32_t>(meshes.size()));
    return bytes;
}

std::string error_of(const std::string& content, int index = 0) {
    return input_error_of([&] { parse_serialized(content, "m.serialized", index); });
}

TEST(SerializedMesh, BothVersionsAndPrecisionsMeanTheSame) {
    for (const int version : {3, 4})
        for (const std::uint32_t precision : {0x1000u, 0x2000u, 0u}) {
            Square square{version, precision | 0x1 | 0x2 | 0x8};
            const SerializedMesh mesh = parse_serialized(file_of({square}), "m.serialized", 0);
            EXPECT_FALSE(mesh.face_normals);
            ASSERT_EQ(mesh.data.positions.size(), 4u);
            EXPECT_EQ(mesh.data.positions[2], Vec3d(2, 2, 0));
            EXPECT_EQ(mesh.data.normals[1], Vec3(0, 0.6f, 0.8f));
            EXPECT_EQ(mesh.data.uvs[2], Vec2(0.25f, 1));
            ASSERT_EQ(mesh.data.triangles.size(), 2u);
            EXPECT_EQ(mesh.data.triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
        }
    const SerializedMesh bare = parse_serialized(file_of({Square{4, 0x1010}}), "m.serialized", 0);
    EXPECT_TRUE(bare.face_normals);
    EXPECT_TRUE(bare.data.normals.empty());
    EXPECT_TRUE(bare.data.uvs.empty());
}

/// Every flipped bit is noticed, except for a few bits of the deflate stream without a meaning (padding, codes that
/// do not occur).
TEST(SerializedMesh, NoFlippedBitOfTheCompressedDataChangesTheMesh) {
    const std::string whole = Square{4, 0x1003}.stream();
    const MeshData right = parse_serialized(whole, "m", 0).data;
    std::size_t accepted = 0;
    for (std::size_t bit = 32; bit < 8 * whole.size(); ++bit) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        try {
            const MeshData mesh = parse_serialized(damaged, "m", 0).data;
            ++accepted;
            EXPECT_EQ(mesh.positions, right.positions) << bit;
            EXPECT_EQ(mesh.normals, right.normals) << bit;
            EXPECT_EQ(mesh.uvs, right.uvs) << bit;
            EXPECT_EQ(mesh.triangles, right.triangles) << bit;
        } catch (const InputError&) {
        }
    }
    EXPECT_LT(accepted, whole.size() / 2);
}

TEST(SerializedMesh, ErrorsSayWhatIsWrong) {
    EXPECT_THAT(error_of(""), StartsWith("m.serialized:1:1: truncated"));
    EXPECT_THAT(error_of("ply\nformat"), StartsWith("m.serialized:1:1: not a serialized mesh"));
    // Counts that the data cannot fill must be refused before memory is taken.
    const std::string less = "less data than its header says";
    for (const auto& [square, message] :
         {std::pair(Square{.version = 5}, std::string("version 5 of the serialized format")),
          {Square{.last_index = 4}, "vertex index 4 of triangle 1 is out of range: there are 4 vertices"},
          {Square{.bad_coordinate = std::nan("")}, "the position of vertex 3 is not finite"},
          {Square{.triangles = 0}, "the mesh is empty"},
          {Square{.extra = "x"}, "more data than its header says"},
          {Square{.triangles = 1ull << 60}, less},
          {Square{.triangles = ~0ull}, less},
          {Square{.vertices = 0xffffffffull}, less}})
        EXPECT_THAT(error_of(file_of({square})), HasSubstr(message));
    const std::string two = file_of({Square(), Square()});
    const auto with = [&](std::size_t at, const std::string& bytes) {
        return std::string(two).replace(at, bytes.size(), bytes);
    };
    EXPECT_THAT(error_of(with(4, "y")), HasSubstr("bad compressed data"));
    EXPECT_THAT(error_of(with(two.size() - 4, "\xff\xff\xff\x7f"), 1),
                HasSubstr("a dictionary of 2147483647 meshes does not fit"));
    EXPECT_THAT(error_of(with(two.size() - 12, std::string(8, '\xff')), 1),
                HasSubstr("there is no mesh at byte 18446744073709551615"));
    EXPECT_THAT(error_of(file_of({Square{4}, Square{3}}), 1), HasSubstr("different versions"));
}

TEST(SerializedMesh, ScenesTakeItWithItsNormals) {
    const TemporaryFolder folder;
    folder.write("m.serialized", file_of({Square{4, 0x1000}, Square{4, 0x1003}, Square{4, 0x1011}}));
    const auto load = [&](const std::string& body) {
        return load_in(folder, shape("serialized", filename("m.serialized"), body));
    };
    const auto mesh = [&](const std::string& body) { return std::get<Mesh>(load(body).scene->shapes()[0]); };
    const auto index = [](int i) { return integer("shape_index", i); };
    EXPECT_EQ(mesh("").normals.at(0), Vec3(0, 0, 1));  // computed
    EXPECT_LT((mesh(index(1)).normals.at(0) - Vec3(0, 0.6f, 0.8f)).norm(), 1e-6f);
    EXPECT_EQ(mesh(index(1)).uvs.at(2), Vec2(0.25f, 1));  // as stored
    EXPECT_TRUE(mesh(index(2)).normals.empty());
    EXPECT_TRUE(mesh(index(1) + flag("face_normals")).normals.empty());
    EXPECT_TRUE(mesh(flag("flip_normals")).flip_normals);
    const auto error = [&](const std::string& body) { return input_error_of([&] { load(body); }); };
    EXPECT_THAT(error(index(-1)), HasSubstr("'shape_index' must be between 0 and"));
    EXPECT_THAT(error(index(7)), StartsWith((folder / "m.serialized") + ":1:1: shape_index 7 is out of range"));
    EXPECT_THAT(error(flag("flip_tex_coords")),
                HasSubstr("shape 'serialized' does not take a parameter 'flip_tex_coords'"));
    EXPECT_THAT(error(number("shape_index", 1)), HasSubstr("'shape_index' cannot be a <float>"));
}

}  // namespace
}  // namespace gib::test::mesh_serialized_test
