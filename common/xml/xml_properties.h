#pragma once
// The parameters of a plugin element such as <shape type="sphere">. A plugin takes only what it asks for: anything
// else in its element is an error at its place, so that no setting is ignored in silence.

#include "common/core/reject.h"
#include "common/xml/xml_expansion.h"
#include "common/xml/xml_values.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <unordered_map>

namespace gib {

/// An object inside another one, or a reference to one.
struct NestedObject {
    const XmlElement* element;
    SourceLocation where;   ///< place of the element or of the <ref>
    std::string name = {};  ///< name by which the holder knows it; empty: none is given
};

/// The values that the channels of a colour may have. The range also decides how a spectrum
/// becomes RGB (scene_spectrum.h).
enum class ColorRange {
    unit,          ///< 0 to 1: a reflectance
    non_negative,  ///< such as an index of refraction
    emission       ///< not negative: a radiance, intensity or irradiance
};

/// Whether a negative number stands for 0 among numbers up to `highest`: measured indices of refraction and coefficients of
/// media have small negative values by noise or as colours out of gamut.
inline bool is_noise(double value, double highest, ColorRange range) {
    return range == ColorRange::non_negative && value < 0 && -value < highest;
}

/// Throws InputError for a number that a colour of this range cannot have, before or after it is rounded to float.
void check_color_value(double value, ColorRange range, const std::string& name, const SourceLocation& where);

class Properties {
public:
    /// Both arguments must outlive this object. Throws InputError for a child that is no property or object at all, for a
    /// reference to nothing and for a name that is given twice (of values of files before version 3 the last counts, with a
    /// warning).
    Properties(const XmlElement& element, const XmlIds& ids);

    const XmlElement& element() const { return element_; }
    /// The plugin's name. Throws InputError if it is missing or not among the supported ones.
    const std::string& plugin(const std::vector<std::string_view>& supported) const;
    const XmlIds& ids() const { return ids_; }
    bool has(const std::string& name) const { return find(name) != nullptr; }
    /// The place of a value: that of its attribute, or of the plugin's element if the property is not given.
    SourceLocation where(const std::string& name) const;
    /// The place of a property's element; the property must be given.
    const SourceLocation& element_where(const std::string& name) const { return find(name)->where; }

    /// Adds a warning, put together from a message and its arguments, at the value of `name`.
    template <typename... Args>
    void warn(const std::string& name, fmt::format_string<Args...> message, Args&&... args) const {
        ids_.warn(where(name), fmt::format(message, std::forward<Args>(args)...));
    }
    /// Throws InputError, put together from a message and its arguments, at the value of `name`.
    template <typename... Args>
    [[noreturn]] void reject(const std::string& name, fmt::format_string<Args...> message, Args&&... args) const {
        gib::reject(where(name), message, std::forward<Args>(args)...);
    }
    /// Throws InputError at the plugin's element if the parameter is not given.
    void require(const std::string& name) const;
    /// Throws InputError at `name` if `other` is given too.
    void exclude(const std::string& name, const std::string& other) const;

    /// Declares that the plugin takes the parameter `name`, though perhaps not together with the given ones.
    void declare(const std::string& name);
    // Reading a property declares that the plugin takes it. All readers throw InputError for a value of another kind.
    std::optional<double> number(const std::string& name);
    double number(const std::string& name, double fallback) { return number(name).value_or(fallback); }
    /// Throws InputError at a value that is not above 0.
    double positive(const std::string& name, double fallback);
    /// Throws InputError at a value below 0.
    double not_negative(const std::string& name, double fallback);
    /// Throws InputError at a value out of [lowest, highest].
    double within(const std::string& name, double fallback, double lowest, double highest);
    std::optional<int> integer(const std::string& name, int lowest, int highest = std::numeric_limits<int>::max());
    /// The same with 64 bits.
    std::optional<std::int64_t> long_integer(const std::string& name, std::int64_t lowest,
                                             std::int64_t highest = std::numeric_limits<std::int64_t>::max());
    /// Reads a parameter of any kind that has no effect.
    void ignore(const std::string& name);
    bool boolean(const std::string& name, bool fallback);
    std::optional<std::string> string(const std::string& name);
    std::string required_string(const std::string& name);
    /// One of `choices`, in lower case.
    std::string choice(const std::string& name, const std::string& fallback,
                       const std::vector<std::string_view>& choices);
    /// The value that one of `choices` names.
    template <typename Value>
    Value chosen(const std::string& name, Value fallback,
                 std::initializer_list<std::pair<std::string_view, std::type_identity_t<Value>>> choices) {
        std::vector<std::string_view> names;
        for (const auto& [word, value] : choices)
            names.push_back(word);
        const std::string given = choice(name, std::string(names.front()), names);
        const auto* chosen = choices.begin() + (std::find(names.begin(), names.end(), given) - names.begin());
        return has(name) ? chosen->second : fallback;
    }
    std::optional<Vec3d> point(const std::string& name);
    Mat4d transform(const std::string& name);
    /// Declares that the property may be a <spectrum>. Returns its element if it is one, else null; color_property()
    /// reads the value.
    const XmlElement* spectrum(const std::string& name);
    /// An <rgb>, or a <float> for a grey; linear, with sRGB's primaries. Of colours that are not_negative, negative channels
    /// count as 0 with a warning if they are smaller than the largest one, as in measured data.
    Color rgb(const std::string& name, float fallback, ColorRange range);
    /// Declares that the property may be a <string>. Returns whether it is one.
    bool is_string(const std::string& name);

    /// The nested objects of a kind ("bsdf"), in the file's order.
    std::vector<NestedObject> objects(const std::string& tag);
    /// The object `name` if it is of that kind; nothing if it is of another kind, a value or not given.
    std::optional<NestedObject> named_object(const std::string& name, const std::string& tag);
    /// The nested object of a kind, if there is one. Throws InputError at a second one.
    std::optional<NestedObject> object(const std::string& tag);

    /// Rejects properties and objects that were not read (XmlIds::reject_unknown), and lists the known ones. In old files
    /// (XmlElement::old) it only warns of properties that Mitsuba 0.6 does not know either, as Mitsuba 0.6 does.
    void finish() const;
    /// In place of finish(), where what was not asked for changes no image: warns that it has no effect, unless its name
    /// is among `expected`, which are Mitsuba's.
    void warn_of_unread(std::initializer_list<std::string_view> expected) const;

private:
    struct Property {
        std::string name;  ///< name of the value or object; empty: the object has none
        const XmlElement* element;
        SourceLocation where;
        bool is_object;
        bool read = false;
    };
    const Property* find(const std::string& name) const;
    /// Marks the property as read; null if it is not given.
    const Property* mark(const std::string& name);
    /// Marks the property as read; null if it is not given. `kinds` are the elements that hold such a value.
    const XmlElement* read(const std::string& name, std::initializer_list<std::string_view> kinds);
    void add_child(const XmlElement& child);

    const XmlElement& element_;
    const XmlIds& ids_;
    std::vector<Property> properties_;
    std::unordered_map<std::string, int> line_of_name_;  ///< hashed: a scene may hold 1e5 named shapes
    std::vector<std::string> known_;
    /// Pairs of a parameter's name and another kind of element that it may be, which read() lists in its message.
    std::vector<std::pair<std::string, std::string>> other_kinds_;
};

}  // namespace gib
