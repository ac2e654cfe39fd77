#include "common/mesh_files/mesh_ms3d.h"

#include "common/core/reject.h"
#include "common/core/text_cursor.h"
#include "common/materials/phong.h"

#include <map>

namespace gib {

namespace {

constexpr std::int64_t largest_integer = 0x7fffffff;

class Ms3dParser {
public:
    Ms3dParser(std::string_view text, const std::string& file) : cursor_(text, file), start_(cursor_.location()) {}

    /// Reads up to the materials; bones and comments follow, which a still picture does not need.
    Ms3dModel parse() {
        for (bool at_materials = false; !at_materials && find_line();) {
            const SourceLocation where = cursor_.location();
            const std::string name(cursor_.word());
            if (name == "Frames:" || name == "Frame:") {
                integer("a frame number", 0);
                cursor_.end_line();
            } else if (name == "Meshes:") {
                repeat([&] { parse_mesh(); });
            } else if (name == "Materials:") {
                repeat([&] { parse_material(); });
                at_materials = true;
            } else {
                reject(where, "unknown word '{}': expected Frames:, Frame:, Meshes: or Materials:", name);
            }
        }
        if (model_.groups.empty()) throw InputError(start_, "the model is empty: it has no triangles");
        if (last_material_ >= static_cast<std::int64_t>(model_.materials.size()))
            reject(last_material_at_, "material {} is out of range: there are {}", last_material_,
                   model_.materials.size());
        return std::move(model_);
    }

private:
    void parse_mesh() {
        Ms3dGroup group;
        line();
        group.name = quoted();
        integer("flags", 0);
        const std::int64_t material = integer("a material", -1);  // -1: none
        if (material >= 0) group.material = static_cast<std::uint32_t>(material);
        if (material > last_material_) {
            last_material_ = material;
            last_material_at_ = cursor_.marked();
        }
        cursor_.end_line();

        std::vector<Vec3d> positions;
        std::vector<Vec2> uvs;
        items([&] {
            integer("flags", 0);
            positions.push_back(vector("a vertex"));
            const float u = cursor_.float_number("a texture coordinate"),
                        v = cursor_.float_number("a texture coordinate");
            uvs.emplace_back(u, v);
            integer("a bone", -1);
        });
        std::vector<Vec3> normals;
        items([&] { normals.push_back(float_vector("a normal")); });

        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> vertex_of_pair;  // by position and normal
        items([&] {
            integer("flags", 0);
            std::uint32_t position[3], normal[3];
            for (auto& i : position)
                i = index("vertex", positions.size());
            for (auto& i : normal)
                i = index("normal", normals.size());
            integer("a smoothing group", 0);
            auto& triangle = group.mesh.triangles.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [it, is_new] = vertex_of_pair.emplace(
                    std::pair{position[k], normal[k]}, static_cast<std::uint32_t>(group.mesh.positions.size()));
                triangle[k] = it->second;
                if (!is_new) continue;
                group.mesh.positions.push_back(positions[position[k]]);
                group.mesh.uvs.push_back(uvs[position[k]]);
                group.mesh.normals.push_back(normals[normal[k]]);
            }
        });
        if (!group.mesh.triangles.empty()) model_.groups.push_back(std::move(group));
    }

    void parse_material() {
        Ms3dMaterial material;
        line();
        material.name = quoted();
        cursor_.end_line();
        color("the ambient colour");
        material.diffuse = color("the diffuse colour");
        material.specular = color("the specular colour");
        material.emissive = color("the emissive colour");
        material.shininess = line_number("the shininess", 0, Phong::highest_exponent);
        material.transparency = line_number("the transparency", 0, 1);
        line();
        material.texture = quoted();
        cursor_.end_line();
        line();
        quoted();  // the alpha texture
        cursor_.end_line();
        model_.materials.push_back(std::move(material));
    }

    /// Goes to the next line that is neither empty nor a comment; false at the end of the file.
    bool find_line() {
        for (cursor_.skip_space(); cursor_.peek() == '/'; cursor_.skip_space())
            cursor_.next_line();
        return !cursor_.at_end();
    }
    void line() {
        find_line();
        cursor_.require_more();
    }
    /// Reads a count that ends its line, and calls `body` as many times.
    template <typename Body>
    void repeat(const Body& body) {
        const std::int64_t count = integer("a count", 0);
        cursor_.end_line();
        for (std::int64_t i = 0; i < count; ++i)
            body();
    }
    /// Reads a line with a count, and a line for each item by `body`.
    template <typename Body>
    void items(const Body& body) {
        line();
        repeat([&] {
            line();
            body();
            cursor_.end_line();
        });
    }

    std::int64_t integer(const char* what, std::int64_t lowest) {
        cursor_.skip_blanks();
        cursor_.mark();
        const std::int64_t value = cursor_.integer();
        if (value < lowest || value > largest_integer) reject(cursor_.marked(), "{} cannot be {}", what, value);
        return value;
    }
    std::uint32_t index(const char* what, std::size_t count) {
        cursor_.skip_blanks();
        cursor_.mark();
        const std::int64_t value = cursor_.integer();
        if (value < 0 || value >= static_cast<std::int64_t>(count))
            reject(cursor_.marked(), "{} index {} is out of range: there are {}", what, value, count);
        return static_cast<std::uint32_t>(value);
    }
    Vec3d vector(const char* what) {
        Vec3d v;
        for (double& x : v)
            x = cursor_.finite_number(what);
        return v;
    }
    Vec3 float_vector(const char* what) {
        Vec3 v;
        for (int i = 0; i < 3; ++i)
            v[i] = cursor_.float_number(what);
        return v;
    }
    float ranged(const char* what, float lowest, float highest) {
        const float value = cursor_.float_number(what);
        if (!(value >= lowest && value <= highest))
            reject(cursor_.marked(), "{} must be between {} and {}, not {}", what, lowest, highest, value);
        return value;
    }
    float line_number(const char* what, float lowest, float highest) {
        line();
        const float value = ranged(what, lowest, highest);
        cursor_.end_line();
        return value;
    }
    /// Reads a line of red, green, blue and an alpha, which is not used.
    Color color(const char* what) {
        line();
        Color c;
        for (int i = 0; i < 3; ++i)
            c[i] = ranged(what, 0, 1);
        cursor_.float_number(what);
        cursor_.end_line();
        return c;
    }
    std::string quoted() {
        cursor_.skip_blanks();
        const SourceLocation where = cursor_.location();
        if (cursor_.peek() != '"') throw InputError(where, "expected a name in quotes");
        std::string text;
        for (cursor_.advance(); !cursor_.at_line_end() && cursor_.peek() != '"'; cursor_.advance())
            text += cursor_.peek();
        if (cursor_.at_line_end()) throw InputError(where, "the quote is not closed");
        cursor_.advance();
        return text;
    }

    TextCursor cursor_;
    SourceLocation start_;
    std::int64_t last_material_ = -1;  ///< the highest index, which refers to a block further down the file
    SourceLocation last_material_at_;
    Ms3dModel model_;
};

}  // namespace

Ms3dModel parse_ms3d(std::string_view text, const std::string& file) { return Ms3dParser(text, file).parse(); }

}  // namespace gib
