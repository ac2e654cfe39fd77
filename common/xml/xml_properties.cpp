#include "common/xml/xml_properties.h"

#include "common/core/reject.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>

namespace gib {

namespace {

template <std::size_t N>
bool among(const std::string& text, const std::string_view (&list)[N]) {
    return std::find(std::begin(list), std::end(list), text) != std::end(list);
}

constexpr std::string_view value_tags[] = {"float",    "integer", "boolean", "string",   "rgb",
                                           "spectrum", "point",   "vector",  "transform"};
constexpr std::string_view object_tags[] = {"integrator", "sensor",  "film",   "sampler", "rfilter", "shape",
                                            "bsdf",       "emitter", "medium", "texture", "phase",   "volume"};

/// Parameters that change images of Mitsuba 0.6 and that some readers lack: also in old files they are no needless ones.
constexpr std::string_view unsupported[] = {"material", "max", "min", "shape_index", "wrap_mode_u", "wrap_mode_v"};

bool is_object(const XmlElement& element) {
    return among(element.tag, object_tags) || (element.tag == "spectrum" && element.find("type"));
}

/// The value of a <float> or an <integer>.
double parse_number_of(const XmlElement& element) {
    const XmlAttribute& value = element.required("value");
    return element.tag == "integer" ? static_cast<double>(parse_integer(value)) : parse_number(value);
}

void check_value_element(const XmlElement& element) {
    if (element.tag == "transform") return element.check_attributes({"name"});
    element.check_no_children();
    if (element.tag == "point" || element.tag == "vector") element.check_attributes({"name", "value", "x", "y", "z"});
    else if (element.tag == "spectrum") element.check_attributes({"name", "value", "filename"});
    else element.check_attributes({"name", "value"});
}

}  // namespace

void check_color_value(double value, ColorRange range, const std::string& name, const SourceLocation& where) {
    if (range == ColorRange::unit && !(value >= 0 && value <= 1))
        gib::reject(where, "'{}' must be between 0 and 1, not {}", name, value);
    if (!(value >= 0)) gib::reject(where, "'{}' must not be negative: {}", name, value);
    if (!std::isfinite(static_cast<float>(value))) gib::reject(where, "bad number '{}': too large", value);
}

Properties::Properties(const XmlElement& element, const XmlIds& ids) : element_(element), ids_(ids) {
    if (element.tag != "scene") element.check_attributes({"type", "id", "name"});
    for (const auto& child : element.children)
        add_child(child);
}

void Properties::add_child(const XmlElement& child) {
    const SourceLocation& where = child.where;
    std::string name = child.find("name") ? child.find("name")->value : "";
    if (child.tag == "alias") return;
    if (child.tag == "ref") {
        child.check_attributes({"id", "name"});
        child.check_no_children();
        properties_.push_back({.name = name, .element = &ids_.resolve(child), .where = where, .is_object = true});
    } else if (is_object(child)) {
        properties_.push_back({.name = name, .element = &child, .where = where, .is_object = true});
    } else if (among(child.tag, value_tags)) {
        name = child.required("name").value;
        check_value_element(child);
        properties_.push_back({.name = name, .element = &child, .where = where, .is_object = false});
    } else {
        gib::reject(where, "<{}> cannot hold <{}>", element_.tag, child.tag);
    }
    if (name.empty()) return;
    const auto [first, is_new] = line_of_name_.emplace(name, where.line);
    if (is_new) return;
    const auto earlier =
        std::find_if(properties_.begin(), properties_.end() - 1, [&](const auto& p) { return p.name == name; });
    if (!element_.last_counts || earlier->is_object || properties_.back().is_object)
        gib::reject(where, "'{}' is given twice, first at line {}", name, first->second);
    ids_.warn(where, fmt::format("'{}' is given twice, first at line {}: the last one counts", name, first->second));
    properties_.erase(earlier);
}

const std::string& Properties::plugin(const std::vector<std::string_view>& supported) const {
    const XmlAttribute& type = element_.required("type");
    if (std::find(supported.begin(), supported.end(), type.value) == supported.end())
        gib::reject(type.where, "the {} '{}' is not supported; supported are: {}", element_.tag, type.value,
                    fmt::join(supported, ", "));
    return type.value;
}

SourceLocation Properties::where(const std::string& name) const {
    const Property* property = find(name);
    if (!property) return element_.where;
    const XmlAttribute* value = property->element->find("value");
    return value && !property->is_object ? value->where : property->where;
}

void Properties::require(const std::string& name) const {
    if (!has(name)) gib::reject(element_.where, "'{}' needs '{}'", element_.required("type").value, name);
}

void Properties::exclude(const std::string& name, const std::string& other) const {
    if (has(name) && has(other)) reject(name, "give either '{}' or '{}'", other, name);
}

const Properties::Property* Properties::find(const std::string& name) const {
    const auto it = std::find_if(properties_.begin(), properties_.end(), [&](const auto& p) { return p.name == name; });
    return it == properties_.end() ? nullptr : &*it;
}

void Properties::declare(const std::string& name) {
    if (std::find(known_.begin(), known_.end(), name) == known_.end()) known_.push_back(name);
}

const Properties::Property* Properties::mark(const std::string& name) {
    declare(name);
    const Property* property = find(name);
    if (property) properties_[static_cast<std::size_t>(property - properties_.data())].read = true;
    return property;
}

const XmlElement* Properties::read(const std::string& name, std::initializer_list<std::string_view> kinds) {
    const Property* property = mark(name);
    if (!property) return nullptr;
    const std::string& tag = property->element->tag;
    if (!property->is_object && std::find(kinds.begin(), kinds.end(), tag) != kinds.end()) return property->element;
    std::vector<std::string_view> all(kinds);
    for (const auto& [parameter, kind] : other_kinds_)
        if (parameter == name) all.push_back(kind);
    gib::reject(property->where, "'{}' cannot be a <{}>; it takes: <{}>", name, tag, fmt::join(all, ">, <"));
}

std::optional<double> Properties::number(const std::string& name) {
    const XmlElement* element = read(name, {"float", "integer"});
    if (!element) return std::nullopt;
    const double value = parse_number_of(*element);
    if (!std::isfinite(static_cast<float>(value))) reject(name, "bad number '{}': too large", value);
    return value;
}

double Properties::positive(const std::string& name, double fallback) {
    const double value = number(name, fallback);
    if (!(static_cast<float>(value) > 0)) reject(name, "'{}' must be above 0, not {}", name, value);
    return value;
}

double Properties::not_negative(const std::string& name, double fallback) {
    const double value = number(name, fallback);
    if (!(value >= 0)) reject(name, "'{}' must not be negative: {:g}", name, value);
    return value;
}

double Properties::within(const std::string& name, double fallback, double lowest, double highest) {
    const double value = number(name, fallback);
    if (value >= lowest && value <= highest) return value;
    reject(name, "'{}' must be between {:g} and {:g}, not {:g}", name, lowest, highest, value);
}

std::optional<int> Properties::integer(const std::string& name, int lowest, int highest) {
    const auto value = long_integer(name, lowest, highest);
    return value ? std::optional(static_cast<int>(*value)) : std::nullopt;
}

std::optional<std::int64_t> Properties::long_integer(const std::string& name, std::int64_t lowest,
                                                     std::int64_t highest) {
    const XmlElement* element = read(name, {"integer"});
    if (!element) return std::nullopt;
    const std::int64_t value = parse_integer(element->required("value"));
    if (value < lowest || value > highest)
        reject(name, "'{}' must be between {} and {}, not {}", name, lowest, highest, value);
    return value;
}

void Properties::ignore(const std::string& name) { mark(name); }

bool Properties::boolean(const std::string& name, bool fallback) {
    const XmlElement* element = read(name, {"boolean"});
    return element ? parse_boolean(element->required("value")) : fallback;
}

std::optional<std::string> Properties::string(const std::string& name) {
    const XmlElement* element = read(name, {"string"});
    if (!element) return std::nullopt;
    return element->required("value").value;
}

std::string Properties::required_string(const std::string& name) {
    require(name);
    return *string(name);
}

std::string Properties::choice(const std::string& name, const std::string& fallback,
                               const std::vector<std::string_view>& choices) {
    const std::string value = lower_case(string(name).value_or(fallback));
    if (std::find(choices.begin(), choices.end(), value) == choices.end())
        reject(name, "'{}' cannot be '{}'; it takes: {}", name, value, fmt::join(choices, ", "));
    return value;
}

std::optional<Vec3d> Properties::point(const std::string& name) {
    const XmlElement* element = read(name, {"point", "vector"});
    if (!element) return std::nullopt;
    return parse_vector(*element);
}

Mat4d Properties::transform(const std::string& name) {
    const XmlElement* element = read(name, {"transform"});
    return element ? parse_transform(*element) : Mat4d(Mat4d::Identity());
}

const XmlElement* Properties::spectrum(const std::string& name) {
    const Property* property = mark(name);
    other_kinds_.emplace(other_kinds_.begin(), name, "spectrum");
    return property && property->element->tag == "spectrum" ? property->element : nullptr;
}

Color Properties::rgb(const std::string& name, float fallback, ColorRange range) {
    const XmlElement* element = read(name, {"rgb", "float", "integer"});
    if (!element) return Color::Constant(fallback);
    const XmlAttribute& value = element->required("value");
    const bool is_rgb = element->tag == "rgb";
    auto numbers = is_rgb ? parse_linear_channels(value) : std::vector<double>{parse_number_of(*element)};
    if (numbers.size() != 1 && numbers.size() != 3)
        gib::reject(value.where, "'{}' takes one or three numbers, found {}", name, numbers.size());
    const double highest = *std::max_element(numbers.begin(), numbers.end());
    for (double& x : numbers) {
        if (!is_noise(x, highest, range)) continue;
        warn(name, "'{}' must not be negative: {} counts as 0", name, x);
        x = 0;
    }
    Color color;
    for (int i = 0; i < 3; ++i) {
        const double x = numbers[numbers.size() == 1 ? 0 : static_cast<std::size_t>(i)];
        check_color_value(x, range, name, value.where);
        color[i] = static_cast<float>(x);
    }
    return color;
}

bool Properties::is_string(const std::string& name) {
    other_kinds_.emplace_back(name, "string");
    const Property* property = find(name);
    return property && property->element->tag == "string";
}

std::vector<NestedObject> Properties::objects(const std::string& tag) {
    known_.push_back(fmt::format("<{}>", tag));
    std::vector<NestedObject> found;
    for (auto& property : properties_) {
        if (!property.is_object || property.element->tag != tag) continue;
        property.read = true;
        found.push_back({property.element, property.where, property.name});
    }
    return found;
}

std::optional<NestedObject> Properties::object(const std::string& tag) {
    const auto found = objects(tag);
    if (found.size() > 1) gib::reject(found[1].where, "<{}> can hold only one <{}>", element_.tag, tag);
    return found.empty() ? std::nullopt : std::optional(found[0]);
}

std::optional<NestedObject> Properties::named_object(const std::string& name, const std::string& tag) {
    declare(name);
    other_kinds_.emplace_back(name, tag);
    for (auto& property : properties_) {
        if (property.name != name || !property.is_object || property.element->tag != tag) continue;
        property.read = true;
        return NestedObject{property.element, property.where, property.name};
    }
    return std::nullopt;
}

void Properties::finish() const {
    for (const auto& property : properties_) {
        if (property.read) continue;
        const XmlAttribute* type = element_.find("type");
        const std::string plugin = type ? fmt::format("{} '{}'", element_.tag, type->value) : element_.tag;
        const std::string what = property.is_object ? fmt::format("a <{}>", property.element->tag)
                                                    : fmt::format("a parameter '{}'", property.name);
        const std::string takes = known_.empty() ? "nothing" : fmt::format("{}", fmt::join(known_, ", "));
        if (!element_.old || property.is_object || among(property.name, unsupported))
            ids_.reject_unknown(property.where, fmt::format("{} does not take {}; it takes: {}", plugin, what, takes));
        else
            ids_.warn(property.where,
                      fmt::format("{} does not take {}, which has no effect; it takes: {}", plugin, what, takes));
    }
}

void Properties::warn_of_unread(std::initializer_list<std::string_view> expected) const {
    for (const auto& property : properties_) {
        if (property.read || std::find(expected.begin(), expected.end(), property.name) != expected.end()) continue;
        const XmlAttribute* type = element_.find("type");
        const std::string what =
            property.is_object ? fmt::format("a <{}>", property.element->tag) : fmt::format("'{}'", property.name);
        ids_.warn(property.where,
                  fmt::format("{} '{}': {} has no effect", element_.tag, type ? type->value : "", what));
    }
}

}  // namespace gib
