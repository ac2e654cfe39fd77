// Reads files in Mitsuba's `serialized` format: meshes with a short header each, compressed by zlib, and a dictionary
// of the places where they start.

#include "common/core/binary.h"
#include "common/core/reject.h"
#include "common/mesh_files/mesh_data.h"

#include <zlib.h>
#include <algorithm>

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

/// Unpacks a zlib stream piece by piece, so that the claims of a header never decide how much memory is taken.
class Inflater {
public:
    Inflater(std::string_view compressed, const std::string& file) : rest_(compressed), file_(file) {
        if (inflateInit(&stream_) != Z_OK) throw RunError("zlib could not start");
    }
    ~Inflater() { inflateEnd(&stream_); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    void read(char* target, std::size_t bytes) {
        while (bytes > 0) {
            const std::size_t n = unpack(target, bytes);
            if (n == 0) fail(file_, "truncated: the mesh has less data than its header says");
            target += n;
            bytes -= n;
        }
    }
    template <typename T>
    T read() {
        char bytes[sizeof(T)];
        read(bytes, sizeof bytes);
        return load<T>(bytes);
    }
    /// Checks that the stream ends here, with the right checksum.
    void finish() {
        char extra;
        if (unpack(&extra, 1) != 0) fail(file_, "the mesh has more data than its header says");
    }

private:
    /// Fills up to `bytes` bytes and returns how many; 0 at the end of the stream.
    std::size_t unpack(char* target, std::size_t bytes) {
        constexpr std::size_t block = std::size_t{1} << 30;  // zlib counts with 32 bits
        stream_.next_out = reinterpret_cast<Bytef*>(target);
        stream_.avail_out = static_cast<uInt>(std::min(bytes, block));
        const uInt wanted = stream_.avail_out;
        while (!ended_ && stream_.avail_out == wanted) {
            if (stream_.avail_in == 0) {
                if (rest_.empty()) fail(file_, "truncated: the file ends inside its compressed data");
                const std::size_t n = std::min(rest_.size(), block);
                stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest_.data()));
                stream_.avail_in = static_cast<uInt>(n);
                rest_.remove_prefix(n);
            }
            const int result = inflate(&stream_, Z_NO_FLUSH);
            if (result == Z_MEM_ERROR) throw RunError("out of memory");
            if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
                fail(file_, "bad compressed data{}{}", stream_.msg ? ": " : "", stream_.msg ? stream_.msg : "");
            ended_ = result == Z_STREAM_END;
        }
        return wanted - stream_.avail_out;
    }

    std::string_view rest_;
    const std::string& file_;
    z_stream stream_{};
    bool ended_ = false;
};

/// Reads `count` items of `width` values each, block by block.
template <typename T, typename Item>
void read_items(Inflater& stream, std::uint64_t count, std::size_t width, const Item& item) {
    constexpr std::uint64_t block = 4096;
    std::vector<char> buffer(block * width * sizeof(T));
    for (std::uint64_t begin = 0; begin < count; begin += block) {
        const std::uint64_t n = std::min(block, count - begin);
        stream.read(buffer.data(), n * width * sizeof(T));
        for (std::uint64_t i = 0; i < n; ++i)
            item(begin + i, buffer.data() + i * width * sizeof(T));
    }
}

/// Reads vectors of N finite numbers in either precision and passes each to `add`. `in_float`: whether they must fit
/// into float.
template <int N, bool in_float, typename Add>
void read_vectors(Inflater& stream, std::uint64_t count, bool doubles, const std::string& file, const char* what,
                  const Add& add) {
    const auto read = [&]<typename T>(T) {
        read_items<T>(stream, count, N, [&](std::uint64_t index, const char* bytes) {
            Eigen::Matrix<double, N, 1> v;
            for (int k = 0; k < N; ++k)
                v[k] = static_cast<double>(load<T>(bytes + static_cast<std::size_t>(k) * sizeof(T)));
            if (!v.array().isFinite().all()) fail(file, "the {} of vertex {} is not finite", what, index);
            if (in_float && !std::all_of(v.begin(), v.end(), fits_float))
                fail(file, "the {} of vertex {} is too large", what, index);
            add(v);
        });
    };
    if (doubles) read(double());
    else read(float());
}

MeshData read_mesh(Inflater& stream, std::uint32_t flags, const std::string& file) {
    const auto vertices = stream.read<std::uint64_t>(), triangles = stream.read<std::uint64_t>();
    if (triangles == 0) fail(file, "the mesh is empty: it has no faces");
    const bool doubles = flags & double_precision;
    MeshData mesh;
    read_vectors<3, false>(stream, vertices, doubles, file, "position",
                           [&](const Vec3d& p) { mesh.positions.push_back(p); });
    if (flags & has_normals)
        read_vectors<3, true>(stream, vertices, doubles, file, "normal",
                              [&](const Vec3d& n) { mesh.normals.push_back(Vec3(n.cast<float>())); });
    if (flags & has_uvs)
        read_vectors<2, true>(stream, vertices, doubles, file, "texture coordinate",
                              [&](const Vec2d& uv) { mesh.uvs.push_back(Vec2(uv.cast<float>())); });
    if (flags & has_colors) read_vectors<3, false>(stream, vertices, doubles, file, "colour", [](const Vec3d&) {});
    read_items<std::uint32_t>(stream, triangles, 3, [&](std::uint64_t index, const char* bytes) {
        auto triangle = decltype(mesh.triangles)::value_type();
        for (std::size_t k = 0; k < 3; ++k) {
            triangle[k] = load<std::uint32_t>(bytes + 4 * k);
            if (triangle[k] >= vertices)
                fail(file, "vertex index {} of triangle {} is out of range: there are {} vertices", triangle[k], index,
                     vertices);
        }
        mesh.triangles.push_back(triangle);
    });
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
    Inflater stream(content.substr(offset + 4), file);
    const auto flags = stream.read<std::uint32_t>();
    if (version == 4)
        while (stream.read<char>() != '\0') {
        }  // the mesh's name
    SerializedMesh mesh{read_mesh(stream, flags, file), (flags & face_normals) != 0};
    stream.finish();
    return mesh;
}

}  // namespace gib
