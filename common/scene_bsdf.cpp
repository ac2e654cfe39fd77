#include "common/scene_bsdf.h"

#include "common/conductor_index.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>

namespace gib {

namespace {

struct NamedIndex {
    std::string_view name;
    double index;
};

/// Indices of refraction at 589 nm and 0 to 20 degrees Celsius, after Hecht, Optics, 4th edition: the names that
/// Mitsuba has.
constexpr NamedIndex named_indices[] = {
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419}};

double parse_index(Properties& properties, const std::string& name, const std::string& fallback) {
    if (properties.has(name) && !properties.is_string(name)) return properties.positive(name, 1);
    std::string wanted = properties.string(name).value_or(fallback);
    std::transform(wanted.begin(), wanted.end(), wanted.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
    std::vector<std::string_view> names;
    for (const auto& entry : named_indices) {
        if (entry.name == wanted) return entry.index;
        names.push_back(entry.name);
    }
    throw InputError(properties.where(name), fmt::format("'{}': there is no material '{}'; known are: {}", name, wanted,
                                                         fmt::join(names, ", ")));
}

Dielectric parse_dielectric(Properties& properties) {
    const double interior = parse_index(properties, "int_ior", "bk7"),
                 exterior = parse_index(properties, "ext_ior", "air");
    return {static_cast<float>(interior / exterior), properties.color("specular_reflectance", 1, ColorRange::unit),
            properties.color("specular_transmittance", 1, ColorRange::unit)};
}

/// Empty: a perfect mirror. Throws InputError for a material that is not known, or one beside eta and k.
std::optional<Conductor::Index> parse_conductor_index(Properties& properties) {
    const std::string material = properties.string("material").value_or("none");
    const bool has_index = properties.has("eta") || properties.has("k");
    const Conductor::Index index{properties.color("eta", 0, ColorRange::non_negative),
                                 properties.color("k", 1, ColorRange::non_negative)};
    if (material == "none") return has_index ? std::optional(index) : std::nullopt;
    if (has_index) throw InputError(properties.where("material"), "give either 'material' or 'eta' and 'k'");
    const auto known = conductor_index(material);
    if (!known)
        throw InputError(properties.where("material"), fmt::format("there is no material '{}'; known are: none, {}",
                                                                   material, fmt::join(conductor_names(), ", ")));
    return Conductor::Index{known->eta, known->k};
}

Conductor parse_conductor(Properties& properties) {
    return {parse_conductor_index(properties), properties.color("specular_reflectance", 1, ColorRange::unit)};
}

Scattering parse_scattering(const XmlElement& element, const XmlIds& ids) {
    Properties properties(element, ids);
    const std::string& type = properties.plugin({"diffuse", "dielectric", "conductor", "twosided"});
    const auto parse = [&]() -> Scattering {
        if (type == "dielectric") return parse_dielectric(properties);
        if (type == "conductor") return parse_conductor(properties);
        return Diffuse{properties.color("reflectance", 0.5f, ColorRange::unit)};
    };
    const Scattering scattering = parse();
    properties.finish();
    return scattering;
}

Bsdf parse_twosided(const XmlElement& element, const XmlIds& ids) {
    Properties properties(element, ids);
    const auto nested = properties.objects("bsdf");
    properties.finish();
    if (nested.empty() || nested.size() > 2)
        throw InputError(element.where, fmt::format("twosided takes one or two bsdfs, found {}", nested.size()));
    std::vector<Scattering> sides;
    for (const auto& side : nested) {
        if (side.element->required("type").value == "twosided")
            throw InputError(side.where, "a bsdf inside twosided cannot be twosided");
        sides.push_back(parse_scattering(*side.element, ids));
        if (std::holds_alternative<Dielectric>(sides.back()))
            throw InputError(side.where, "a bsdf inside twosided must not transmit light");
    }
    return {sides.front(), sides.back()};
}

}  // namespace

Bsdf parse_bsdf(const XmlElement& element, const XmlIds& ids) {
    if (element.required("type").value == "twosided") return parse_twosided(element, ids);
    return Bsdf(parse_scattering(element, ids));
}

}  // namespace gib
