// Reads Wavefront OBJ files.

#include "common/core/reject.h"
#include "common/core/text_cursor.h"
#include "common/mesh_files/mesh_data.h"
#include "common/mesh_files/polygon.h"

#include <algorithm>

namespace gib {

namespace {

/// The indices, from 0, of a corner's position, texture coordinate and normal; `no_index` where the corner has
/// no such index.
struct Corner {
    std::uint32_t position, uv, normal;
    bool operator==(const Corner&) const = default;
};

constexpr std::uint32_t no_index = ~0u;

/// Statements of the format that say nothing about the triangles: groups, files of materials, points, lines and how to
/// show them.
constexpr std::string_view passed_over[] = {"g",        "o",        "s",          "mg",       "mtllib", "usemap",
                                            "maplib",   "l",        "p",          "vp",       "lod",    "bevel",
                                            "c_interp", "d_interp", "shadow_obj", "trace_obj"};

/// The three bytes that some programs write before UTF-8 text.
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

class ObjParser {
public:
    ObjParser(std::string_view text, const std::string& file) : cursor_(text, file, Backslash::joins_lines) {
        // Short lines have 20 to 30 bytes. A guess that is too high only wastes address space.
        positions_.reserve(text.size() / 64);
        mesh_.triangles.reserve(text.size() / 64);
        if (text.starts_with(byte_order_mark))
            for (std::size_t i = 0; i < byte_order_mark.size(); ++i)
                cursor_.advance();
    }

    MeshData parse() {
        for (; !cursor_.at_end(); end_statement())
            parse_statement();
        if (mesh_.triangles.empty()) throw InputError(cursor_.location(), "the mesh is empty: it has no faces");
        collect_vertices();
        triangulate_fans(mesh_.positions, mesh_.triangles, fans_);
        return std::move(mesh_);
    }

private:
    void parse_statement() {
        cursor_.skip_blanks();
        if (cursor_.at_line_end() || cursor_.peek() == '#') return;
        cursor_.mark();
        const std::string_view keyword = cursor_.word();
        if (keyword == "v") {
            Vec3d p;
            for (int i = 0; i < 3; ++i)
                p[i] = cursor_.finite_number("a vertex");
            positions_.push_back(p);
        } else if (keyword == "vn") {
            Vec3 n;
            for (int i = 0; i < 3; ++i)
                n[i] = cursor_.float_number("a normal");
            normals_.push_back(n);
        } else if (keyword == "vt") {
            Vec2 uv;
            for (int i = 0; i < 2; ++i)
                uv[i] = cursor_.float_number("a texture coordinate");
            uvs_.push_back(uv);
        } else if (keyword == "f") {
            parse_face();
        } else if (keyword == "usemtl") {
            mesh_.materials.push_back({mesh_.triangles.size(), rest_of_line()});
        } else if (std::ranges::find(passed_over, keyword) == std::end(passed_over)) {
            mesh_.warnings.add(cursor_.marked(),
                               fmt::format("unknown word '{}': lines that start with it are passed over", keyword));
        }
    }

    /// A name, which may have blanks in it.
    std::string rest_of_line() {
        std::string rest;
        for (cursor_.skip_blanks(); !cursor_.at_line_end(); cursor_.skip_blanks())
            rest += (rest.empty() ? "" : " ") + std::string(cursor_.word());
        return rest;
    }

    /// Moves to the next line. What is left of a statement may go on there; a comment does not.
    void end_statement() {
        for (cursor_.skip_blanks(); !cursor_.at_line_end() && cursor_.peek() != '#'; cursor_.skip_blanks())
            cursor_.word();
        cursor_.next_line();
    }

    void parse_face() {
        const std::size_t first_triangle = mesh_.triangles.size();
        std::uint32_t first = 0, previous = 0, corners = 0;
        for (cursor_.skip_blanks(); !cursor_.at_line_end() && cursor_.peek() != '#'; cursor_.skip_blanks(), ++corners) {
            const std::uint32_t vertex = vertex_of(parse_corner());
            if (corners == 0) first = vertex;
            if (corners >= 2) mesh_.triangles.push_back({first, previous, vertex});
            previous = vertex;
        }
        if (corners < 3) mesh_.warnings.add(cursor_.location(), short_face);
        if (corners > 3) fans_.push_back({first_triangle, corners});
    }

    /// Reads a corner: v, v/vt, v//vn or v/vt/vn. Some programs write v/ where there is no texture coordinate.
    Corner parse_corner() {
        Corner corner{parse_index(positions_.size(), "vertex"), no_index, no_index};
        if (cursor_.peek() != '/') return corner;
        cursor_.advance();
        if (cursor_.at_blank() || cursor_.at_line_end()) return corner;
        if (cursor_.peek() != '/') corner.uv = parse_index(uvs_.size(), "texture coordinate");
        if (cursor_.peek() != '/') return corner;
        cursor_.advance();
        corner.normal = parse_index(normals_.size(), "normal");
        return corner;
    }

    /// Reads an index, which counts from 1, or from the end if it is negative. Returns it from 0.
    std::uint32_t parse_index(std::size_t size, const char* what) {
        cursor_.mark();
        // A number after a blank would be the next corner's.
        if (cursor_.at_blank()) reject(cursor_.marked(), "a {} index is missing", what);
        const std::int64_t given = cursor_.integer(), count = static_cast<std::int64_t>(size);
        const std::int64_t index = given < 0 ? count + given : given - 1;
        if (given == 0 || index < 0 || index >= count)
            reject(cursor_.marked(), "{} index {} is out of range: there are {} so far", what, given, size);
        return static_cast<std::uint32_t>(index);
    }

    /// The vertex of a corner, which is added to the mesh if it is new. Vertices with the same position form a chain;
    /// in meshes chains are short and then quicker than a hash table.
    std::uint32_t vertex_of(const Corner& corner) {
        if (first_of_position_.size() < positions_.size()) first_of_position_.resize(positions_.capacity(), no_index);
        std::uint32_t* link = &first_of_position_[corner.position];
        while (*link != no_index && !(corners_[*link] == corner))
            link = &next_[*link];
        if (*link != no_index) return *link;
        const auto vertex = static_cast<std::uint32_t>(corners_.size());
        *link = vertex;
        corners_.push_back(corner);
        next_.push_back(no_index);
        has_uvs_ |= corner.uv != no_index;
        has_normals_ |= corner.normal != no_index;
        return vertex;
    }

    void collect_vertices() {
        const std::size_t size = corners_.size();
        mesh_.positions.resize(size);
        if (has_uvs_) mesh_.uvs.resize(size, Vec2::Zero());
        if (has_normals_) mesh_.normals.resize(size, Vec3::Zero());
        for (std::size_t i = 0; i < size; ++i) {
            mesh_.positions[i] = positions_[corners_[i].position];
            if (corners_[i].uv != no_index) mesh_.uvs[i] = uvs_[corners_[i].uv];
            if (corners_[i].normal != no_index) mesh_.normals[i] = normals_[corners_[i].normal];
        }
    }

    TextCursor cursor_;
    std::vector<Vec3d> positions_;
    std::vector<Vec3> normals_;
    std::vector<Vec2> uvs_;
    std::vector<Corner> corners_;                   ///< the corner of each vertex of the mesh
    std::vector<std::uint32_t> first_of_position_;  ///< the first vertex at a position
    std::vector<std::uint32_t> next_;               ///< the next vertex at the same position
    std::vector<Fan> fans_;
    bool has_uvs_ = false, has_normals_ = false;
    MeshData mesh_;
};

}  // namespace

MeshData parse_obj(std::string_view text, const std::string& file) { return ObjParser(text, file).parse(); }

}  // namespace gib
