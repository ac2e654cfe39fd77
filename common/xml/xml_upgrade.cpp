#include "common/xml/xml_upgrade.h"

#include "common/color/srgb.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "common/xml/xml_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gib {

namespace {

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

/// "intIOR" becomes "int_ior": an underscore before the capitals that follow a small letter.
std::string underscored(const std::string& name) {
    std::string result;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (i > 0 && is_lower(name[i - 1]) && is_upper(name[i])) result += '_';
        result += is_upper(name[i]) ? static_cast<char>(name[i] + ('a' - 'A')) : name[i];
    }
    return result;
}

XmlAttribute* attribute_of(XmlElement& element, std::string_view name) {
    for (auto& attribute : element.attributes)
        if (attribute.name == name) return &attribute;
    return nullptr;
}

bool is(const XmlElement& element, std::string_view tag, std::string_view type) {
    const XmlAttribute* given = element.find("type");
    return element.tag == tag && given && given->value == type;
}

/// The child that is the property `name`; null if there is none.
XmlElement* property(XmlElement& element, std::string_view name) {
    for (auto& child : element.children)
        if (const XmlAttribute* given = child.find("name"); given && given->value == name) return &child;
    return nullptr;
}

void rename(XmlElement& element, std::string_view from, const std::string& to) {
    if (XmlElement* child = property(element, from)) attribute_of(*child, "name")->value = to;
}

void drop(XmlElement& element, std::initializer_list<std::string_view> names) {
    std::erase_if(element.children, [&](const XmlElement& child) {
        const XmlAttribute* given = child.find("name");
        return given && std::find(names.begin(), names.end(), given->value) != names.end();
    });
}

/// A value element at the place of another one.
XmlElement value_element(const std::string& tag, const std::string& name, const std::string& value,
                         const SourceLocation& where) {
    return {.tag = tag, .where = where, .attributes = {{"name", name, where}, {"value", value, where}}, .children = {}};
}

/// The numbers of "0.2, 0.5 0.1", or of "#rrggbb" (0 to 1).
std::vector<double> numbers_of(const XmlAttribute& value) {
    const std::string& text = value.value;
    if (!text.starts_with('#')) return parse_numbers(value);
    std::vector<double> channels;
    for (std::size_t i = 1; i + 1 < text.size(); i += 2) {
        unsigned byte = 0;
        const char* first = text.data() + i;
        if (std::from_chars(first, first + 2, byte, 16).ptr != first + 2) break;
        channels.push_back(byte / 255.0);
    }
    if (channels.size() != 3 || text.size() != 7) reject(value.where, "bad colour '{}': expected #rrggbb", text);
    return channels;
}

class Upgrade {
public:
    Upgrade(XmlElement& element, const SceneVersion& version, LoadWarnings& warnings)
        : e_(element), version_(version), warnings_(warnings) {}

    void apply() {
        if (XmlAttribute* name = attribute_of(e_, "name")) name->value = underscored(name->value);
        if (e_.tag == "lookAt") e_.tag = "lookat";
        if (version_.before(0, 4)) upgrade_names_before_0_4();
        if (version_.before(0, 5) && is(e_, "bsdf", "bump")) attribute_of(e_, "type")->value = "bumpmap";
        upgrade_color();
        if (e_.tag == "blackbody") upgrade_blackbody();
        if (e_.tag == "texture") upgrade_texture();
        if (e_.tag == "bsdf") upgrade_bsdf();
        if (e_.tag == "medium") upgrade_medium();
        if (is(e_, "volume", "gridvolume")) upgrade_gridvolume();
        if (e_.tag == "shape") {
            drop(e_, {"collapse"});  // it changes no image
            drop_with_warning("srgb", "integer colours count as sRGB, others as linear");
        }
        for (const char* type : {"sunsky", "sky", "sun"})
            if (is(e_, "emitter", type)) upgrade_daylight();
        if (is(e_, "emitter", "envmap")) {
            drop(e_, {"cache"});
            drop_with_warning("gamma", "the kind of the image decides");
        }
    }

private:
    void drop_with_warning(std::string_view name, std::string_view reason) {
        const XmlElement* child = property(e_, name);
        if (!child) return;
        warnings_.add(child->where, fmt::format("'{}' has no effect: {}", name, reason));
        drop(e_, {name});
    }

    void upgrade_names_before_0_4() {
        if (e_.tag == "luminaire") e_.tag = "emitter";
        if (e_.tag == "camera") e_.tag = "sensor";
        if (is(e_, "emitter", "area") || is(e_, "emitter", "constant")) rename(e_, "intensity", "radiance");
        if (is(e_, "emitter", "directional")) rename(e_, "intensity", "irradiance");
        if (e_.tag == "emitter") rename(e_, "intensity_scale", "scale");
        if (e_.tag != "sensor") return;
        rename(e_, "focus_depth", "focus_distance");
        if (XmlElement* to_world = property(e_, "to_world"))
            to_world->children.insert(
                to_world->children.begin(),
                {.tag = "scale", .where = e_.where, .attributes = {{"x", "-1", e_.where}}, .children = {}});
        const XmlElement* smaller = property(e_, "map_smaller_side");
        const bool larger = smaller && !parse_boolean(smaller->required("value"));
        drop(e_, {"map_smaller_side"});
        if (!property(e_, "fov_axis") && property(e_, "fov"))
            e_.children.push_back(value_element("string", "fov_axis", larger ? "larger" : "smaller", e_.where));
    }

    void upgrade_color() {
        if (e_.tag == "rgb" || e_.tag == "srgb" || e_.tag == "spectrum")
            std::erase_if(e_.attributes, [](const XmlAttribute& a) { return a.name == "intent"; });
        XmlAttribute* value = attribute_of(e_, "value");
        if (!value) return;
        if (e_.tag == "srgb") {
            std::vector<double> channels = numbers_of(*value);
            for (double& channel : channels)
                channel = static_cast<double>(linear_from_srgb(static_cast<float>(channel)));
            e_.tag = "rgb";
            value->value = fmt::format("{}", fmt::join(channels, " "));
        } else if (e_.tag == "spectrum" && value->value.find(':') == std::string::npos) {
            const std::size_t count = words_of(value->value).size();
            if (count == 1 || count == 3) e_.tag = "rgb";
        }
    }

    /// <blackbody temperature="3000K" scale="2"/> is a spectrum with these parameters.
    void upgrade_blackbody() {
        e_.check_attributes({"name", "temperature", "scale"});
        std::string kelvin = e_.required("temperature").value;
        if (kelvin.ends_with('K') || kelvin.ends_with('k')) kelvin.pop_back();
        const SourceLocation where = e_.required("temperature").where;
        e_.tag = "spectrum";
        e_.children.push_back(value_element("float", "temperature", kelvin, where));
        if (const XmlAttribute* scale = e_.find("scale"))
            e_.children.push_back(value_element("float", "scale", scale->value, scale->where));
        std::erase_if(e_.attributes, [](const XmlAttribute& a) { return a.name != "name"; });
        e_.attributes.push_back({"type", "blackbody", where});
    }

    /// Up is y, east is x and north is -z; in version 3 up is z and north is x.
    void upgrade_daylight() {
        if (!property(e_, "to_world"))
            e_.children.push_back({.tag = "transform",
                                   .where = e_.where,
                                   .attributes = {{"name", "to_world", e_.where}},
                                   .children = {}});
        XmlElement& to_world = *property(e_, "to_world");
        const std::string from_version_3 = "0 -1 0 0  0 0 1 0  -1 0 0 0  0 0 0 1";
        to_world.children.insert(
            to_world.children.begin(),
            {.tag = "matrix", .where = e_.where, .attributes = {{"value", from_version_3, e_.where}}, .children = {}});
    }

    void upgrade_texture() {
        upgrade_uv();
        if (is(e_, "texture", "bitmap")) upgrade_bitmap();
        if (is(e_, "texture", "vertexcolors")) {
            attribute_of(e_, "type")->value = "mesh_attribute";
            e_.children.push_back(value_element("string", "name", "vertex_color", e_.where));
        }
    }

    void upgrade_uv() {
        const auto number = [&](std::string_view name, const char* fallback) {
            const XmlElement* child = property(e_, name);
            return child ? child->required("value").value : std::string(fallback);
        };
        bool any = false;
        for (const std::string_view name : {"uoffset", "voffset", "uscale", "vscale"})
            any |= property(e_, name) != nullptr;
        if (!any) return;
        const auto operation = [&](const std::string& tag, const std::string& x, const std::string& y) {
            return XmlElement{
                .tag = tag, .where = e_.where, .attributes = {{"x", x, e_.where}, {"y", y, e_.where}}, .children = {}};
        };
        XmlElement to_uv{
            .tag = "transform", .where = e_.where, .attributes = {{"name", "to_uv", e_.where}}, .children = {}};
        to_uv.children = {operation("translate", number("uoffset", "0"), number("voffset", "0")),
                          operation("scale", number("uscale", "1"), number("vscale", "1"))};
        drop(e_, {"uoffset", "voffset", "uscale", "vscale"});
        e_.children.push_back(std::move(to_uv));
    }

    void upgrade_bitmap() {
        if (XmlElement* filter = property(e_, "filter_type")) {
            XmlAttribute* value = attribute_of(*filter, "value");
            if (value && (value->value == "trilinear" || value->value == "ewa")) {
                warnings_.add(value->where, fmt::format("the filter '{}' is read as bilinear", value->value));
                value->value = "bilinear";
            }
        }
        if (const XmlElement* gamma = property(e_, "gamma")) {
            const XmlAttribute& value = gamma->required("value");
            const double g = parse_number(value);
            if (g == 1) e_.children.push_back(value_element("boolean", "raw", "true", gamma->where));
            else if (!(g <= 0 || std::abs(g - 2.2) < 0.1))
                warnings_.add(value.where, fmt::format("a bitmap's gamma of {} is read as sRGB's curve", value.value));
        }
        drop(e_, {"gamma", "max_anisotropy", "cache"});
        const XmlElement *u = property(e_, "wrap_mode_u"), *v = property(e_, "wrap_mode_v");
        if (u && v && u->required("value").value == v->required("value").value) {
            rename(e_, "wrap_mode_u", "wrap_mode");
            drop(e_, {"wrap_mode_v"});
        }
    }

    void upgrade_bsdf() {
        if (is(e_, "bsdf", "diffuse")) rename(e_, "diffuse_reflectance", "reflectance");
        if (XmlElement* distribution = property(e_, "distribution"))
            if (XmlAttribute* value = attribute_of(*distribution, "value");
                value && (value->value == "phong" || value->value == "as")) {
                warnings_.add(value->where, fmt::format("the distribution '{}' is read as beckmann", value->value));
                value->value = "beckmann";
            }
        if (is(e_, "bsdf", "mixturebsdf")) upgrade_mixture();
        if (is(e_, "bsdf", "bumpmap")) upgrade_bumpmap();
    }

    void upgrade_mixture() {
        const XmlElement* weights = property(e_, "weights");
        if (!weights) return;
        const std::vector<double> w = parse_numbers(weights->required("value"));
        if (w.size() != 2 || std::abs(w[0] + w[1] - 1) > 1e-4) return;
        attribute_of(e_, "type")->value = "blendbsdf";
        XmlElement weight = value_element("float", "weight", fmt::format("{}", w[1]), weights->where);
        drop(e_, {"weights"});
        e_.children.push_back(std::move(weight));
    }

    /// <texture type="scale"> around the height becomes the bumpmap's scale.
    void upgrade_bumpmap() {
        for (auto& child : e_.children) {
            if (!is(child, "texture", "scale")) continue;
            XmlElement* scale = property(child, "scale");
            const auto inner = std::find_if(child.children.begin(), child.children.end(), [](const XmlElement& part) {
                return part.tag == "texture" || part.tag == "ref";
            });
            if (!scale || scale->tag != "float" || inner == child.children.end()) return;
            XmlElement factor = *scale, texture = *inner;
            child = std::move(texture);
            e_.children.push_back(std::move(factor));
            return;
        }
    }

    void upgrade_medium() {
        rename(e_, "density_multiplier", "scale");
        if (!is(e_, "medium", "heterogeneous")) return;
        rename(e_, "density", "sigma_t");
        drop(e_, {"method", "step_size"});  // they choose how Mitsuba 0.6 samples
        for (auto& child : e_.children) {
            if (!is(child, "volume", "constvolume") || !child.find("name")) continue;
            const std::string name = child.find("name")->value;
            if (const XmlElement* value = property(child, "value")) {
                XmlElement constant = *value;
                attribute_of(constant, "name")->value = name;
                child = std::move(constant);
            }
        }
    }

    void upgrade_gridvolume() {
        drop(e_, {"send_data"});
        if (!property(e_, "use_grid_bbox"))
            e_.children.push_back(value_element("boolean", "use_grid_bbox", "true", e_.where));
    }

    XmlElement& e_;
    const SceneVersion& version_;
    LoadWarnings& warnings_;
};

}  // namespace

SceneVersion parse_version(const XmlAttribute& version) {
    const std::string& text = version.value;
    const std::size_t dot = text.find('.'), next = text.find('.', dot == text.npos ? dot : dot + 1);
    const auto major = number_from<int>(text.substr(0, dot));
    const auto minor = number_from<int>(dot == text.npos ? "0" : text.substr(dot + 1, next - dot - 1));
    if (!major || !minor || *major < 0 || *minor < 0 || *major > 3 || SceneVersion{*major, *minor}.before(0, 3))
        reject(version.where, "version '{}' is not supported: only 0.3 to 3.x", text);
    return {*major, *minor};
}

void upgrade_element(XmlElement& element, const SceneVersion& version, LoadWarnings& warnings) {
    if (version.before(2, 0)) Upgrade(element, version, warnings).apply();
}

}  // namespace gib
