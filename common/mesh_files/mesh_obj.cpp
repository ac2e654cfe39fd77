// Reads Wavefront OBJ files.

#include "common/core/text_cursor.h"
#include "common/mesh_files/mesh_data.h"
#include "common/sampling/sampler.h"

#include <fmt/format.h>

#include <unordered_map>

namespace gib {

namespace {

/// The indices, from 0, of a corner's position, texture coordinate and normal; `none` where the corner has
/// no such index.
struct Corner {
    std::uint32_t position, uv, normal;
    bool operator==(const Corner&) const = default;
};

struct CornerHash {
    std::size_t operator()(const Corner& c) const {
        return combine_keys((std::uint64_t{c.position} << 32) + c.uv, c.normal);
    }
};

constexpr std::uint32_t none = ~0u;
constexpr int longest_chain = 32;

class ObjParser {
public:
    ObjParser(std::string_view text, const std::string& file) : cursor_(text, file) {
        // Short lines have 20 to 30 bytes. A guess that is too high only wastes address space.
        positions_.reserve(text.size() / 64);
        mesh_.triangles.reserve(text.size() / 64);
    }

    MeshData parse() {
        for (; !cursor_.at_end(); cursor_.next_line())
            parse_statement();
        if (mesh_.triangles.empty()) throw InputError(cursor_.location(), "the mesh is empty: it has no faces");
        collect_vertices();
        return std::move(mesh_);
    }

private:
    void parse_statement() {
        cursor_.skip_blanks();
        const std::string_view keyword = cursor_.peek() == '#' ? std::string_view() : cursor_.word();
        if (keyword == "v") {
            Vec3d p;
            for (int i = 0; i < 3; ++i)
                p[i] = finite_number("vertex");
            positions_.push_back(p);
        } else if (keyword == "vn") {
            Vec3 n;
            for (int i = 0; i < 3; ++i)
                n[i] = float_number("normal");
            normals_.push_back(n);
        } else if (keyword == "vt") {
            Vec2 uv;
            for (int i = 0; i < 2; ++i)
                uv[i] = float_number("texture coordinate");
            uvs_.push_back(uv);
        } else if (keyword == "f") {
            parse_face();
        }
    }

    double finite_number(const char* what) {
        cursor_.skip_blanks();
        cursor_.mark();
        const double x = cursor_.number();
        if (!std::isfinite(x)) throw InputError(cursor_.marked(), fmt::format("a {} is not finite", what));
        return x;
    }

    float float_number(const char* what) {
        const double x = finite_number(what);
        if (!fits_float(x)) throw InputError(cursor_.marked(), fmt::format("a {} is too large: {:g}", what, x));
        return static_cast<float>(x);
    }

    void parse_face() {
        std::uint32_t first = 0, previous = 0;
        int corners = 0;
        for (cursor_.skip_blanks(); !cursor_.at_line_end() && cursor_.peek() != '#'; cursor_.skip_blanks(), ++corners) {
            const std::uint32_t vertex = vertex_of(parse_corner());
            if (corners == 0) first = vertex;
            if (corners >= 2) mesh_.triangles.push_back({first, previous, vertex});
            previous = vertex;
        }
        if (corners < 3) throw InputError(cursor_.location(), fmt::format("a face has only {} vertices", corners));
    }

    /// Reads a corner: v, v/vt, v//vn or v/vt/vn.
    Corner parse_corner() {
        Corner corner{parse_index(positions_.size(), "vertex"), none, none};
        if (cursor_.peek() != '/') return corner;
        cursor_.advance();
        if (cursor_.peek() != '/') corner.uv = parse_index(uvs_.size(), "texture coordinate");
        if (cursor_.peek() != '/') return corner;
        cursor_.advance();
        corner.normal = parse_index(normals_.size(), "normal");
        return corner;
    }

    /// Reads an index, which counts from 1, or from the end if it is negative. Returns it from 0.
    std::uint32_t parse_index(std::size_t size, const char* what) {
        cursor_.mark();
        const std::int64_t given = cursor_.integer(), count = static_cast<std::int64_t>(size);
        const std::int64_t index = given < 0 ? count + given : given - 1;
        if (given == 0 || index < 0 || index >= count)
            throw InputError(cursor_.marked(),
                             fmt::format("{} index {} is out of range: there are {} so far", what, given, size));
        return static_cast<std::uint32_t>(index);
    }

    /// The vertex of a corner, which is added to the mesh if it is new.
    std::uint32_t vertex_of(const Corner& corner) {
        if (first_of_position_.size() < positions_.size()) first_of_position_.resize(positions_.capacity(), none);
        std::uint32_t& known = known_vertex(corner);
        if (known != none) return known;
        const auto vertex = static_cast<std::uint32_t>(corners_.size());
        if (vertex == none) throw InputError(cursor_.location(), "the mesh has more than 2^32 - 1 vertices");
        known = vertex;
        corners_.push_back(corner);
        next_.push_back(none);
        has_uvs_ |= corner.uv != none;
        has_normals_ |= corner.normal != none;
        return vertex;
    }

    /// The place that holds the vertex of a corner, or `none` if the corner is new. Corners with the same position
    /// form a chain. In most meshes chains are short and then quicker than a hash table. The time of a search grows
    /// with the number of links, so that corners beyond `longest_chain` links are kept in a hash table.
    std::uint32_t& known_vertex(const Corner& corner) {
        std::uint32_t* link = &first_of_position_[corner.position];
        for (int links = 1; *link != none && !(corners_[*link] == corner); ++links) {
            if (links == longest_chain) return crowded_.try_emplace(corner, none).first->second;
            link = &next_[*link];
        }
        return *link;
    }

    void collect_vertices() {
        const std::size_t size = corners_.size();
        mesh_.positions.resize(size);
        if (has_uvs_) mesh_.uvs.resize(size, Vec2::Zero());
        if (has_normals_) mesh_.normals.resize(size, Vec3::Zero());
        for (std::size_t i = 0; i < size; ++i) {
            mesh_.positions[i] = positions_[corners_[i].position];
            if (corners_[i].uv != none) mesh_.uvs[i] = uvs_[corners_[i].uv];
            if (corners_[i].normal != none) mesh_.normals[i] = normals_[corners_[i].normal];
        }
    }

    TextCursor cursor_;
    std::vector<Vec3d> positions_;
    std::vector<Vec3> normals_;
    std::vector<Vec2> uvs_;
    std::vector<Corner> corners_;                                    ///< the corner of each vertex of the mesh
    std::vector<std::uint32_t> first_of_position_;                   ///< the first vertex at a position
    std::vector<std::uint32_t> next_;                                ///< the next vertex at the same position
    std::unordered_map<Corner, std::uint32_t, CornerHash> crowded_;  ///< vertices that found no place in a chain
    bool has_uvs_ = false, has_normals_ = false;
    MeshData mesh_;
};

}  // namespace

MeshData parse_obj(std::string_view text, const std::string& file) { return ObjParser(text, file).parse(); }

}  // namespace gib
