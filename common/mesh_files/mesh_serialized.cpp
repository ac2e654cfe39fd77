// Reads files in Mitsuba's `serialized` format: meshes with a short header each, compressed by zlib, and a dictionary
// of the places where they start.

#include "common/core/binary.h"
#include "common/core/reject.h"
#include "common/mesh_files/mesh_data.h"

#include <zlib.h>
#include <algorithm>
#include <memory>

namespace gib {

namespace {

constexpr std::uint16_t magic = 0x041c;

enum Flag : std::uint32_t {
    has_normals = 0x0001,
    has_uvs = 0x0002,
    has_colors = 0x0008,
    face_normals = 0x0010,
    double_precision = 0x2000
};

template <typename... Args>
[[noreturn]] void fail(const std::string& file, fmt::format_string<Args...> message, Args&&... args) {
    reject(SourceLocation{file}, message, std::forward<Args>(args)...);
}

/// Unpacks the zlib stream at the start of `compressed`, and checks its checksum.
std::string inflated(std::string_view compressed, const std::string& file) {
    z_stream stream{};
    if (inflateInit(&stream) != Z_OK) throw RunError("zlib could not start");
    const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
    std::string data;
    std::vector<char> block(std::size_t{1} << 20);
    for (int result = Z_OK; result != Z_STREAM_END;) {
        if (stream.avail_in == 0 && stream.avail_out > 0) {
            if (compressed.empty()) fail(file, "truncated: the file ends inside its compressed data");
            const std::size_t n = std::min(compressed.size(), std::size_t{1} << 30);  // zlib counts with 32 bits
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
            stream.avail_in = static_cast<uInt>(n);
            compressed.remove_prefix(n);
        }
        stream.next_out = reinterpret_cast<Bytef*>(block.data());
        stream.avail_out = static_cast<uInt>(block.size());
        result = inflate(&stream, Z_NO_FLUSH);
        if (result == Z_MEM_ERROR) throw RunError("out of memory");
        if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
            fail(file, "bad compressed data{}{}", stream.msg ? ": " : "", stream.msg ? stream.msg : "");
        data.append(block.data(), block.size() - stream.avail_out);
    }
    return data;
}

/// Reads the unpacked data of a mesh from its start to its end.
struct MeshBytes {
    const std::string& file;
    std::string_view rest;

    const char* take(std::uint64_t count, std::size_t size) {
        if (count > rest.size() / size) fail(file, "truncated: the mesh has less data than its header says");
        const char* first = rest.data();
        rest.remove_prefix(count * size);
        return first;
    }
    template <typename T>
    T next() {
        return load<T>(take(1, sizeof(T)));
    }
    /// Reads vectors of N finite numbers in either precision and passes each to `add`. `in_float`: whether they must
    /// fit into float.
    template <int N, bool in_float, typename Add>
    void vectors(std::uint64_t count, bool doubles, const char* what, const Add& add) {
        const std::size_t size = doubles ? sizeof(double) : sizeof(float);
        const char* at = take(count, N * size);
        for (std::uint64_t i = 0; i < count; ++i) {
            Eigen::Matrix<double, N, 1> v;
            for (int k = 0; k < N; ++k, at += size)
                v[k] = doubles ? load<double>(at) : static_cast<double>(load<float>(at));
            if (!v.array().isFinite().all()) fail(file, "the {} of vertex {} is not finite", what, i);
            if (in_float && !std::all_of(v.begin(), v.end(), fits_float))
                fail(file, "the {} of vertex {} is too large", what, i);
            add(v);
        }
    }
};

MeshData read_mesh(MeshBytes& bytes, std::uint32_t flags) {
    const auto vertices = bytes.next<std::uint64_t>(), triangles = bytes.next<std::uint64_t>();
    if (triangles == 0) fail(bytes.file, "the mesh is empty: it has no faces");
    const bool doubles = flags & double_precision;
    MeshData mesh;
    bytes.vectors<3, false>(vertices, doubles, "position", [&](const Vec3d& p) { mesh.positions.push_back(p); });
    if (flags & has_normals)
        bytes.vectors<3, true>(vertices, doubles, "normal",
                               [&](const Vec3d& n) { mesh.normals.push_back(Vec3(n.cast<float>())); });
    if (flags & has_uvs)
        bytes.vectors<2, true>(vertices, doubles, "texture coordinate",
                               [&](const Vec2d& uv) { mesh.uvs.push_back(Vec2(uv.cast<float>())); });
    if (flags & has_colors) bytes.vectors<3, false>(vertices, doubles, "colour", [](const Vec3d&) {});
    const char* at = bytes.take(triangles, 12);
    for (std::uint64_t i = 0; i < triangles; ++i) {
        auto& triangle = mesh.triangles.emplace_back();
        for (std::uint32_t& index : triangle) {
            index = load<std::uint32_t>(at);
            at += sizeof(index);
            if (index >= vertices)
                fail(bytes.file, "vertex index {} of triangle {} is out of range: there are {} vertices", index, i,
                     vertices);
        }
    }
    return mesh;
}

/// Checks the four bytes that stand before the compressed data of a mesh and returns its version.
std::uint16_t version_at(std::string_view content, std::uint64_t offset, const std::string& file) {
    if (offset > content.size() || content.size() - offset < 4)
        fail(file, "truncated: there is no mesh at byte {}", offset);
    const char* header = content.data() + offset;
    if (load<std::uint16_t>(header) != magic)
        fail(file, "not a serialized mesh: byte {} does not start with 0x041C", offset);
    const auto version = load<std::uint16_t>(header + 2);
    if (version != 3 && version != 4)
        fail(file, "version {} of the serialized format is not supported: only 3 and 4", version);
    return version;
}

/// The byte at which mesh number `index` starts, from the dictionary at the end of the file. The first mesh
/// needs no dictionary.
std::uint64_t offset_of(std::string_view content, int index, std::uint16_t version, const std::string& file) {
    if (index == 0) return 0;
    const std::uint64_t entry = version == 4 ? 8 : 4, size = content.size();
    const std::uint64_t count = load<std::uint32_t>(content.data() + size - 4);
    if (static_cast<std::uint64_t>(index) >= count)
        fail(file, "shape_index {} is out of range: there are {} meshes", index, count);
    if (count * entry > size - 4) fail(file, "damaged: a dictionary of {} meshes does not fit into the file", count);
    const char* place = content.data() + size - 4 - entry * (count - static_cast<std::uint64_t>(index));
    return version == 4 ? load<std::uint64_t>(place) : load<std::uint32_t>(place);
}

}  // namespace

SerializedMesh parse_serialized(std::string_view content, const std::string& file, int index) {
    const std::uint16_t version = version_at(content, 0, file);
    const std::uint64_t offset = offset_of(content, index, version, file);
    if (version_at(content, offset, file) != version) fail(file, "damaged: its meshes have different versions");
    const std::string data = inflated(content.substr(offset + 4), file);
    MeshBytes bytes{file, data};
    const auto flags = bytes.next<std::uint32_t>();
    if (version == 4)
        while (bytes.next<char>() != '\0') {
        }  // the mesh's name
    SerializedMesh mesh{read_mesh(bytes, flags), (flags & face_normals) != 0};
    if (!bytes.rest.empty()) fail(file, "the mesh has more data than its header says");
    return mesh;
}

}  // namespace gib
