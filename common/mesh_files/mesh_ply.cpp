// Reads Stanford PLY files, ascii or binary.

#include "common/color/srgb.h"
#include "common/core/binary.h"
#include "common/core/reject.h"
#include "common/core/text_cursor.h"
#include "common/mesh_files/mesh_data.h"
#include "common/mesh_files/ply_attributes.h"
#include "common/mesh_files/polygon.h"

#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <optional>

namespace gib {

namespace {

enum class Format { ascii, little_endian, big_endian };

/// A number that a binary body holds.
template <typename T>
double number_at(const char* bytes, std::endian order) {
    return static_cast<double>(load<T>(bytes, order));
}

/// A type of numbers.
struct Type {
    std::string_view name, other_name;
    std::size_t size;  ///< [bytes]
    bool is_float;
    double (*read)(const char* bytes, std::endian order);
    double largest;
};

template <typename T>
constexpr Type type_of(std::string_view name, std::string_view other_name) {
    return {name, other_name, sizeof(T), std::is_floating_point_v<T>, number_at<T>, std::numeric_limits<T>::max()};
}

constexpr Type types[] = {type_of<std::int8_t>("char", "int8"),    type_of<std::uint8_t>("uchar", "uint8"),
                          type_of<std::int16_t>("short", "int16"), type_of<std::uint16_t>("ushort", "uint16"),
                          type_of<std::int32_t>("int", "int32"),   type_of<std::uint32_t>("uint", "uint32"),
                          type_of<float>("float", "float32"),      type_of<double>("double", "float64")};

/// The meaning of a property; properties of role `other` are dropped unless they hold an attribute.
enum class Role { x, y, z, nx, ny, nz, u, v, corners, other };

/// Where the values of a property go: a channel of an attribute, by its number among those of the element.
struct Slot {
    std::size_t attribute;
    std::optional<Eigen::Index> channel;  ///< none: the attribute is one number
};

struct Property {
    Type type;
    std::optional<Type> count_type;  ///< type of a list's length; none: a single value
    Role role;
    std::string name;
    std::optional<Slot> slot{};
};

struct Element {
    std::string name;
    std::uint64_t count;
    std::vector<Property> properties;
    std::vector<PlyAttribute> attributes{};

    bool has(Role role) const {
        return std::any_of(properties.begin(), properties.end(), [&](const auto& p) { return p.role == role; });
    }
    /// The fewest bytes that one item of this element can take.
    std::size_t smallest_item(Format format) const {
        std::size_t size = 0;
        for (const auto& p : properties)
            size += format == Format::ascii ? 2 : p.count_type.value_or(p.type).size;
        return size;
    }
};

struct Header {
    Format format;
    std::vector<Element> elements;
    SourceLocation end;  ///< place of its last line
};

Role role_of(const std::string& element, std::string_view name, bool list) {
    if (element == "face")
        return list && (name == "vertex_index" || name == "vertex_indices") ? Role::corners : Role::other;
    if (element != "vertex" || list) return Role::other;
    constexpr std::pair<std::string_view, Role> roles[] = {
        {"x", Role::x},   {"y", Role::y},   {"z", Role::z},         {"nx", Role::nx},
        {"ny", Role::ny}, {"nz", Role::nz}, {"u", Role::u},         {"v", Role::v},
        {"s", Role::u},   {"t", Role::v},   {"texture_u", Role::u}, {"texture_v", Role::v}};
    for (const auto& [known, role] : roles)
        if (name == known) return role;
    return Role::other;
}

/// Reads the header line by line.
class HeaderParser {
public:
    explicit HeaderParser(TextCursor& cursor) : cursor_(cursor) {}

    Header parse() {
        const SourceLocation start = cursor_.location();
        if (cursor_.word() != "ply") throw InputError(start, "not a PLY file: it does not start with 'ply'");
        cursor_.end_line();
        std::optional<Format> format;
        for (;;) {
            const SourceLocation where = cursor_.location();
            if (cursor_.at_end()) throw InputError(where, "truncated PLY header: there is no 'end_header'");
            const std::string_view keyword = cursor_.word();
            if (keyword == "format") {
                format = parse_format();
            } else if (keyword == "element") {
                parse_element();
            } else if (keyword == "property") {
                parse_property(where);
            } else if (keyword == "end_header") {
                if (!format) throw InputError(where, "the PLY header has no 'format'");
                cursor_.end_line();
                for (Element& element : elements_)
                    find_attributes(element);
                return {*format, std::move(elements_), where};
            } else if (keyword == "comment" || keyword == "obj_info") {
                cursor_.next_line();
                continue;
            } else if (!keyword.empty()) {
                reject(where, "unknown word '{}' in the PLY header", keyword);
            }
            cursor_.end_line();
        }
    }

private:
    Format parse_format() {
        cursor_.skip_blanks();
        const SourceLocation where = cursor_.location();
        const std::string_view name = cursor_.word(), version = cursor_.word();
        if (version != "1.0") reject(where, "unknown PLY version '{}'", version);
        if (name == "ascii") return Format::ascii;
        if (name == "binary_little_endian") return Format::little_endian;
        if (name == "binary_big_endian") return Format::big_endian;
        reject(where, "unknown PLY format '{}'", name);
    }

    void parse_element() {
        const std::string name(cursor_.word());
        cursor_.skip_blanks();
        const SourceLocation where = cursor_.location();
        const std::int64_t count = cursor_.integer();
        if (count < 0) throw InputError(where, "a negative count in the PLY header");
        // A second list of vertices could have other properties than the first.
        if (std::any_of(elements_.begin(), elements_.end(), [&](const Element& e) { return e.name == name; }))
            reject(where, "the element '{}' is given twice", name);
        elements_.push_back({name, static_cast<std::uint64_t>(count), {}});
    }

    static void find_attributes(Element& element) {
        if (element.name != "vertex" && element.name != "face") return;
        std::vector<std::string> names;
        for (const Property& p : element.properties)
            names.push_back(p.role == Role::other && !p.count_type ? p.name : "");
        element.attributes = ply_attributes(element.name, names);
        for (std::size_t a = 0; a < element.attributes.size(); ++a) {
            const auto& properties = element.attributes[a].properties;
            if (properties.size() == 1) element.properties[properties.front()].slot = Slot{a, std::nullopt};
            else
                for (std::size_t k = 0; k < properties.size(); ++k)
                    element.properties[properties[k]].slot = Slot{a, static_cast<Eigen::Index>(k)};
        }
    }

    void parse_property(const SourceLocation& where) {
        if (elements_.empty()) throw InputError(where, "a 'property' before the first 'element'");
        Element& element = elements_.back();
        std::string_view word = cursor_.word();
        std::optional<Type> count_type;
        if (word == "list") {
            count_type = type_named(cursor_.word());
            if (count_type->is_float) throw InputError(where, "the length of a list must be an integer");
            word = cursor_.word();
        }
        const Type type = type_named(word);
        const std::string name(cursor_.word());
        const Role role = role_of(element.name, name, count_type.has_value());
        if (role == Role::corners && type.is_float) throw InputError(where, "vertex indices must be integers");
        if (role != Role::other && element.has(role)) throw InputError(where, "this property is given twice");
        element.properties.push_back({type, count_type, role, name});
    }

    Type type_named(std::string_view name) const {
        for (const Type& type : types)
            if (name == type.name || name == type.other_name) return type;
        reject(cursor_.location(), "unknown PLY type '{}'", name);
    }

    TextCursor& cursor_;
    std::vector<Element> elements_;
};

/// Reads the values of a body.
class Body {
public:
    /// `cursor` stands behind the header of `content`.
    Body(std::string_view content, TextCursor& cursor, const Header& header)
        : content_(content), cursor_(cursor), header_(header), at_(cursor.offset()) {}

    double read(const Type& type) {
        if (is_ascii()) {
            cursor_.skip_space();
            cursor_.require_more();
            cursor_.mark();
            return type.is_float ? cursor_.number() : static_cast<double>(cursor_.integer());
        }
        if (content_.size() - at_ < type.size)
            reject(header_.end, "truncated: the file ends at byte {} before its data", content_.size());
        at_ += type.size;
        return type.read(content_.data() + at_ - type.size,
                         header_.format == Format::big_endian ? std::endian::big : std::endian::little);
    }
    /// The place of the last value.
    SourceLocation location() const { return is_ascii() ? cursor_.marked() : header_.end; }
    std::string place() const { return is_ascii() ? "" : fmt::format(", before byte {}", at_); }
    void finish() {
        if (is_ascii()) cursor_.skip_space();
        const bool at_end = is_ascii() ? cursor_.at_end() : at_ == content_.size();
        if (!at_end)
            reject(is_ascii() ? cursor_.location() : header_.end, "more data than the PLY header says{}",
                   is_ascii() ? "" : fmt::format(", from byte {}", at_));
    }

private:
    bool is_ascii() const { return header_.format == Format::ascii; }

    std::string_view content_;
    TextCursor& cursor_;
    const Header& header_;
    std::size_t at_;
};

class BodyParser {
public:
    BodyParser(const Header& header, Body body) : header_(header), reader_(body) {}

    MeshData parse(std::size_t body_bytes) {
        for (const auto& element : header_.elements) {
            // A wrong count must not reserve memory that the file cannot fill.
            const std::size_t smallest = std::max<std::size_t>(element.smallest_item(header_.format), 1);
            const std::size_t most = std::min<std::uint64_t>(element.count, body_bytes / smallest + 1);
            if (element.name == "vertex") {
                read_vertices(element, most);
            } else if (element.name == "face") {
                read_faces(element, most);
            } else if (!element.properties.empty()) {
                for (std::uint64_t i = 0; i < element.count; ++i)
                    for (const auto& property : element.properties)
                        skip(property);
            }
        }
        reader_.finish();
        if (mesh_.triangles.empty()) throw InputError(header_.end, "the mesh is empty: it has no faces");
        // Faces that stand before the vertices could not be checked while they were read.
        if (largest_index_ >= mesh_.positions.size()) index_out_of_range(largest_index_);
        triangulate_fans(mesh_.positions, mesh_.triangles, fans_);
        return std::move(mesh_);
    }

private:
    void skip(const Property& property) {
        const std::uint64_t count = property.count_type ? read_count(*property.count_type) : 1;
        for (std::uint64_t i = 0; i < count; ++i)
            reader_.read(property.type);
    }

    std::uint64_t read_count(const Type& type) {
        const double count = reader_.read(type);
        if (count < 0) throw InputError(reader_.location(), "a list of negative length" + reader_.place());
        return static_cast<std::uint64_t>(count);
    }

    /// Adds the attributes of an element, still without values, to the mesh. Returns the number of the first.
    std::size_t add_attributes(const Element& element) {
        const std::size_t first = mesh_.attributes.size();
        for (const PlyAttribute& attribute : element.attributes)
            mesh_.attributes.push_back({attribute.name, element.name == "face", attribute.properties.size() == 1, {}});
        return first;
    }

    /// Reads a value of an attribute. Mitsuba takes integers, scaled by the largest of their type, as sRGB.
    void read_attribute(const Property& property, std::vector<Color>& values) {
        const double stored = reader_.read(property.type);
        if (!fits_float(stored))
            reject(reader_.location(), "the attribute '{}' is too large or not finite: {:g}{}", property.name, stored,
                   reader_.place());
        const float value = property.type.is_float
                                ? static_cast<float>(stored)
                                : linear_from_srgb(static_cast<float>(stored / property.type.largest));
        const auto& [attribute, channel] = *property.slot;
        if (channel) values[attribute][*channel] = value;
        else values[attribute].setConstant(value);
    }

    void read_vertices(const Element& element, std::size_t expected) {
        if (!element.has(Role::x) || !element.has(Role::y) || !element.has(Role::z))
            throw InputError(header_.end, "the vertices of the PLY file have no x, y and z");
        const bool normals = element.has(Role::nx) && element.has(Role::ny) && element.has(Role::nz);
        const bool uvs = element.has(Role::u) && element.has(Role::v);
        mesh_.positions.reserve(expected);
        if (normals) mesh_.normals.reserve(expected);
        if (uvs) mesh_.uvs.reserve(expected);
        const std::size_t first_attribute = add_attributes(element);
        std::vector<Color> attributes(element.attributes.size());
        for (std::uint64_t i = 0; i < element.count; ++i) {
            double values[static_cast<std::size_t>(Role::corners)] = {};
            for (const auto& property : element.properties) {
                if (property.role == Role::other) {
                    if (property.slot) read_attribute(property, attributes);
                    else skip(property);
                    continue;
                }
                const double value = reader_.read(property.type);
                if (!std::isfinite(value)) reject(reader_.location(), "vertex {} is not finite{}", i, reader_.place());
                // Positions stay in double.
                if (property.role > Role::z && !fits_float(value))
                    reject(reader_.location(),
                           "vertex {}: a normal or texture coordinate is too "
                           "large: {:g}{}",
                           i, value, reader_.place());
                values[static_cast<std::size_t>(property.role)] = value;
            }
            mesh_.positions.emplace_back(values[0], values[1], values[2]);
            if (normals) mesh_.normals.push_back(Vec3d(values[3], values[4], values[5]).cast<float>());
            if (uvs) mesh_.uvs.push_back(Vec2d(values[6], values[7]).cast<float>());
            for (std::size_t a = 0; a < attributes.size(); ++a)
                mesh_.attributes[first_attribute + a].values.push_back(attributes[a]);
        }
    }

    void read_faces(const Element& element, std::size_t expected) {
        if (!element.has(Role::corners))
            throw InputError(header_.end, "the faces of the PLY file have no vertex_index or vertex_indices");
        mesh_.triangles.reserve(expected);
        const std::size_t first_attribute = add_attributes(element);
        std::vector<Color> attributes(element.attributes.size());
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const auto& property : element.properties) {
                if (property.role == Role::corners) read_face(property);
                else if (property.slot) read_attribute(property, attributes);
                else skip(property);
            }
            // Every triangle of the face has the face's attributes.
            for (std::size_t a = 0; a < attributes.size(); ++a)
                mesh_.attributes[first_attribute + a].values.resize(mesh_.triangles.size(), attributes[a]);
        }
    }

    void read_face(const Property& property) {
        const std::uint64_t count = read_count(*property.count_type);
        if (count < 3) mesh_.warnings.add(reader_.location(), short_face);
        const std::size_t first_triangle = mesh_.triangles.size();
        std::uint32_t first = 0, previous = 0;
        for (std::uint64_t i = 0; i < count; ++i) {
            const double index = reader_.read(property.type);
            if (index < 0 || index >= 4294967295.0) index_out_of_range(index);
            const auto vertex = static_cast<std::uint32_t>(index);
            if (!mesh_.positions.empty() && vertex >= mesh_.positions.size()) index_out_of_range(vertex);
            largest_index_ = std::max(largest_index_, vertex);
            if (i == 0) first = vertex;
            if (i >= 2) mesh_.triangles.push_back({first, previous, vertex});
            previous = vertex;
        }
        if (count > 3) fans_.push_back({first_triangle, static_cast<std::uint32_t>(count)});
    }

    [[noreturn]] void index_out_of_range(double index) const {
        reject(reader_.location(), "vertex index {:.0f} is out of range: there are {} vertices", index,
               mesh_.positions.size());
    }

    const Header& header_;
    Body reader_;
    MeshData mesh_;
    std::vector<Fan> fans_;
    std::uint32_t largest_index_ = 0;
};

}  // namespace

MeshData parse_ply(std::string_view content, const std::string& file) {
    TextCursor cursor(content, file);
    const Header header = HeaderParser(cursor).parse();
    return BodyParser(header, Body(content, cursor, header)).parse(cursor.bytes_left());
}

}  // namespace gib
