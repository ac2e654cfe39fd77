#include "common/xml/xml_upgrade.h"

#include "common/color/srgb.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "common/xml/xml_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace gib {

namespace {

/// By how much the sum of a mixture's weights may differ from 1.
constexpr double weight_rounding = 1e-4;

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

/// An element without children at the place of another one.
XmlElement element(const std::string& tag, const std::vector<std::pair<std::string, std::string>>& attributes,
                   const SourceLocation& where) {
    XmlElement made{.tag = tag, .where = where, .attributes = {}, .children = {}};
    for (const auto& [name, value] : attributes)
        made.attributes.push_back({name, value, where});
    return made;
}
XmlElement value_element(const std::string& tag, const std::string& name, const std::string& value,
                         const SourceLocation& where) {
    return element(tag, {{"name", name}, {"value", value}}, where);
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
            to_world->children.insert(to_world->children.begin(), element("scale", {{"x", "-1"}}, e_.where));
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
            std::vector<double> channels = parse_channels(*value);
            for (double& channel : channels)
                channel = static_cast<double>(linear_from_srgb(static_cast<float>(channel)));
            e_.tag = "rgb";
            value->value = fmt::format("{}", fmt::join(channels, " "));
        } else if (e_.tag == "rgb" && value->value.starts_with('#')) {
            value->value = fmt::format("{}", fmt::join(parse_channels(*value), " "));
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
        if (!is(e_, "emitter", "sun") && !property(e_, "albedo"))
            e_.children.push_back(value_element("rgb", "albedo", "0.2", e_.where));
        if (!property(e_, "to_world")) e_.children.push_back(element("transform", {{"name", "to_world"}}, e_.where));
        XmlElement& to_world = *property(e_, "to_world");
        const std::string from_version_3 = "0 -1 0 0  0 0 1 0  -1 0 0 0  0 0 0 1";
        to_world.children.insert(to_world.children.begin(), element("matrix", {{"value", from_version_3}}, e_.where));
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
        const auto number = [&](std::string_view name, const std::string& fallback) {
            const XmlElement* child = property(e_, name);
            return child ? child->required("value").value : fallback;
        };
        const std::initializer_list<std::string_view> names = {"uoffset", "voffset", "uscale", "vscale", "uvscale"};
        if (std::none_of(names.begin(), names.end(), [&](auto name) { return property(e_, name); })) return;
        const std::string both = number("uvscale", "1");
        XmlElement to_uv = element("transform", {{"name", "to_uv"}}, e_.where);
        to_uv.children = {
            element("translate", {{"x", number("uoffset", "0")}, {"y", number("voffset", "0")}}, e_.where),
            element("scale", {{"x", number("uscale", both)}, {"y", number("vscale", both)}}, e_.where)};
        drop(e_, names);
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
        upgrade_wrap_mode();
    }

    /// Modes that differ stay and are refused.
    void upgrade_wrap_mode() {
        const XmlElement* both = property(e_, "wrap_mode");
        const auto mode = [&](std::string_view name) {
            const XmlElement* own = property(e_, name);
            const XmlElement* given = own ? own : both;
            return given ? given->required("value").value : std::string("repeat");
        };
        const std::string u = mode("wrap_mode_u");
        if (u != mode("wrap_mode_v")) return;
        drop(e_, {"wrap_mode", "wrap_mode_u", "wrap_mode_v"});
        e_.children.push_back(value_element("string", "wrap_mode", u, e_.where));
    }

    void upgrade_bsdf() {
        if (is(e_, "bsdf", "diffuse") || is(e_, "bsdf", "roughdiffuse"))
            rename(e_, "diffuse_reflectance", "reflectance");
        if (XmlElement* distribution = property(e_, "distribution"))
            if (XmlAttribute* value = attribute_of(*distribution, "value");
                value && (value->value == "phong" || value->value == "as")) {
                warnings_.add(value->where, fmt::format("the distribution '{}' is read as beckmann", value->value));
                value->value = "beckmann";
            }
        upgrade_roughness();
        if (is(e_, "bsdf", "conductor") || is(e_, "bsdf", "roughconductor")) upgrade_conductor();
        if (is(e_, "bsdf", "mixturebsdf")) upgrade_mixture();
        if (is(e_, "bsdf", "bumpmap")) upgrade_bumpmap();
        if (is(e_, "bsdf", "normalmap")) upgrade_normalmap();
    }

    /// alpha, whose default is 0.1, is the roughness in each direction that has none of its own. Readers of all bsdfs but
    /// ward do so themselves where both have none.
    void upgrade_roughness() {
        const bool has_u = property(e_, "alpha_u"), has_v = property(e_, "alpha_v");
        const XmlElement* alpha = property(e_, "alpha");
        if (!has_u && !has_v && !(alpha && is(e_, "bsdf", "ward"))) return;
        XmlElement other = alpha ? *alpha : value_element("float", "alpha", "0.1", e_.where);
        drop(e_, {"alpha"});
        for (const auto& [name, is_given] : {std::pair("alpha_u", has_u), std::pair("alpha_v", has_v)}) {
            if (is_given) continue;
            attribute_of(other, "name")->value = name;
            e_.children.push_back(other);
        }
    }

    void upgrade_conductor() {
        for (const std::string_view given : {"material", "eta", "k"})
            if (property(e_, given)) return;
        e_.children.push_back(value_element("string", "material", "Cu", e_.where));
    }

    /// The weights of a mixturebsdf, one for each of its `count` bsdfs, with a sum of at most 1.
    std::vector<double> mixture_weights(std::size_t count) const {
        const XmlElement* given = property(e_, "weights");
        if (!given) reject(e_.where, "a mixturebsdf needs 'weights'");
        const XmlAttribute& value = given->required("value");
        std::vector<double> weights = parse_numbers(value);
        if (weights.size() != count) reject(value.where, "found {} weights of {} bsdfs", weights.size(), count);
        const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
        if (!(*std::min_element(weights.begin(), weights.end()) >= 0 && sum > 0))
            reject(value.where, "the weights must not be negative, and their sum must be above 0");
        if (sum <= 1 + weight_rounding) return weights;
        warnings_.add(value.where, fmt::format("the weights sum to {:g}: they are scaled down to 1", sum));
        for (double& weight : weights)
            weight /= sum;
        return weights;
    }

    /// A mixturebsdf becomes blendbsdfs, one in the other: of the first two bsdfs, of these and the third, and so on.
    /// A black one takes what the weights leave of 1.
    void upgrade_mixture() {
        std::vector<XmlElement> parts;
        for (const auto& child : e_.children)
            if (child.tag == "bsdf" || child.tag == "ref") parts.push_back(child);
        if (parts.empty()) reject(e_.where, "a mixturebsdf needs bsdfs");
        std::vector<double> weights = mixture_weights(parts.size());
        const double rest = 1 - std::accumulate(weights.begin(), weights.end(), 0.0);
        if (parts.size() == 1 || rest > weight_rounding) {
            parts.push_back(element("bsdf", {{"type", "diffuse"}}, e_.where));
            parts.back().children.push_back(value_element("rgb", "reflectance", "0", e_.where));
            weights.push_back(std::max(rest, 0.0));
        }
        double sum = weights[0];
        XmlElement mixed = std::move(parts[0]);
        for (std::size_t i = 1; i < parts.size(); ++i) {
            sum += weights[i];
            const double share = sum > 0 ? weights[i] / sum : 0;
            XmlElement blend = element("bsdf", {{"type", "blendbsdf"}}, e_.where);
            blend.children = {value_element("float", "weight", fmt::format("{}", share), e_.where), std::move(mixed),
                              std::move(parts[i])};
            mixed = std::move(blend);
        }
        attribute_of(e_, "type")->value = "blendbsdf";
        std::erase_if(e_.children, [](const XmlElement& child) { return child.tag == "bsdf" || child.tag == "ref"; });
        drop(e_, {"weights"});
        std::move(mixed.children.begin(), mixed.children.end(), std::back_inserter(e_.children));
    }

    /// The texture of a normalmap has no name there.
    void upgrade_normalmap() {
        const auto bsdf = [](const XmlElement& child) { return child.tag == "bsdf"; };
        const bool has_bsdf = std::any_of(e_.children.begin(), e_.children.end(), bsdf);
        for (auto& child : e_.children) {
            if (child.tag != "texture" && !(child.tag == "ref" && has_bsdf)) continue;
            if (XmlAttribute* name = attribute_of(child, "name")) name->value = "normalmap";
            else child.attributes.push_back({"name", "normalmap", child.where});
            return;
        }
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
        drop(e_, {"medium_sampling_weight", "sampling_density", "strategy"});  // they choose how Mitsuba 0.6 samples
        if (is(e_, "medium", "homogeneous")) check_coefficients();
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
        // In version 3 a heterogeneous medium ends at a cube, even if its extinction is a number; here it fills its shape.
        if (const XmlElement* extinction = property(e_, "sigma_t"))
            if (extinction->tag != "volume" && extinction->tag != "ref")
                attribute_of(e_, "type")->value = "homogeneous";
    }

    /// Coefficients that a homogeneous medium does not give are those of the preset skin1. Presets are refused when
    /// they are read.
    void check_coefficients() {
        if (property(e_, "material")) return;
        bool has_any = false;
        for (const auto& [one, other] : {std::pair("sigma_s", "sigma_a"), std::pair("sigma_t", "albedo")}) {
            const bool has_one = property(e_, one), has_other = property(e_, other);
            has_any = has_any || has_one || has_other;
            if (has_one != has_other)
                warnings_.add(e_.where, fmt::format("'{}' is not given: the default of version 3 stands in for the "
                                                    "preset skin1",
                                                    has_one ? other : one));
        }
        if (!has_any) e_.children.push_back(value_element("string", "material", "skin1", e_.where));
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

bool has_old_names(const XmlElement& root) {
    return std::any_of(root.children.begin(), root.children.end(), [](const XmlElement& child) {
        const std::initializer_list<std::string_view> old_tags = {"lookAt", "srgb", "blackbody", "camera", "luminaire"};
        if (std::find(old_tags.begin(), old_tags.end(), child.tag) != old_tags.end()) return true;
        // Names of parameters are the language's; those of objects may be the author's.
        const XmlAttribute* name = child.find("name");
        const bool is_parameter = child.find("value") || child.tag == "transform";
        if (is_parameter && child.tag != "default" && name && underscored(name->value) != name->value) return true;
        return has_old_names(child);
    });
}

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
    if (version.before(3, 0) && is(element, "volume", "constvolume"))
        rename(element, "color", "value");  // of Mitsuba 2
    element.old = version.before(2, 0);
    element.last_counts = version.before(3, 0);
    if (element.old) Upgrade(element, version, warnings).apply();
    else if (version.before(3, 0) && element.tag == "medium")
        for (const char* name : {"density", "density_scale"})  // of Mitsuba 2.0 and 2.1
            rename(element, name, "scale");
}

}  // namespace gib
