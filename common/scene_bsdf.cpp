#include "common/scene_bsdf.h"

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

double parse_relative_index(Properties& properties) {
    const double interior = parse_index(properties, "int_ior", "bk7"),
                 exterior = parse_index(properties, "ext_ior", "air");
    return interior / exterior;
}

/// dielectric and thindielectric.
template <typename Model>
Scattering parse_dielectric(Properties& properties) {
    Model model;
    model.eta = static_cast<float>(parse_relative_index(properties));
    model.specular_reflectance = properties.color("specular_reflectance", 1, ColorRange::unit);
    model.specular_transmittance = properties.color("specular_transmittance", 1, ColorRange::unit);
    return model;
}

Scattering parse_conductor(Properties& properties) {
    if (properties.string("material").value_or("none") != "none")
        throw InputError(properties.where("material"), "conductor materials by name are not supported yet: only none");
    Conductor conductor;
    const bool has_index = properties.has("eta") || properties.has("k");
    const ConductorIndex index{properties.color("eta", 0, ColorRange::non_negative),
                               properties.color("k", 1, ColorRange::non_negative)};
    if (has_index) conductor.index = index;
    conductor.specular_reflectance = properties.color("specular_reflectance", 1, ColorRange::unit);
    return conductor;
}

Scattering parse_diffuse(Properties& properties) {
    return Diffuse{properties.color("reflectance", 0.5f, ColorRange::unit)};
}

Material parse_twosided(Properties& properties, const XmlIds& ids) {
    const auto nested = properties.objects("bsdf");
    if (nested.empty() || nested.size() > 2)
        throw InputError(properties.element().where,
                         fmt::format("twosided takes one or two bsdfs, found {}", nested.size()));
    std::vector<NestedMaterial> sides;
    for (const auto& side : nested) {
        if (side.element->required("type").value == "twosided")
            throw InputError(side.where, "a bsdf inside twosided cannot be twosided");
        sides.push_back(std::make_shared<const Material>(parse_bsdf(*side.element, ids)));
        if (sides.back()->traits().transmission || sides.back()->has_holes())
            throw InputError(side.where, "a bsdf inside twosided must not transmit light");
    }
    return Material(TwoSided{sides.front(), sides.back()});
}

}  // namespace

Material parse_bsdf(const XmlElement& element, const XmlIds& ids) {
    Properties properties(element, ids);
    const std::string& type = properties.plugin({"diffuse", "dielectric", "thindielectric", "conductor", "twosided"});
    const auto parse = [&]() -> Material {
        if (type == "diffuse") return Material(parse_diffuse(properties));
        if (type == "dielectric") return Material(parse_dielectric<Dielectric>(properties));
        if (type == "thindielectric") return Material(parse_dielectric<ThinDielectric>(properties));
        if (type == "conductor") return Material(parse_conductor(properties));
        return parse_twosided(properties, ids);
    };
    Material material = parse();
    properties.finish();
    return material;
}

}  // namespace gib
