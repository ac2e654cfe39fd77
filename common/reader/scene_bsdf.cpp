#include "common/reader/scene_bsdf.h"

#include "common/color/conductor_index.h"
#include "common/color/dielectric_index.h"
#include "common/color/dispersion.h"
#include "common/core/reject.h"
#include "common/reader/model_reader.h"
#include "common/xml/scene_spectrum.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>

namespace gib {

namespace {

/// Bounds of the relative index, int_ior over ext_ior. Beyond them the models lose their digits: a coat of index 1e4
/// lets out a share of 1e-8 of the light inside, less than the rounding error of 1.
constexpr float lowest_relative_index = 0.01f, highest_relative_index = 100.f;
/// The highest eta and k of a conductor, whose fourth powers float must hold.
constexpr float highest_conductor_index = 1e6f;
constexpr float highest_roughness = 1e4f;
constexpr double highest_bump = 1e9;
/// The default materials inside of an interface and of plastic.
const std::string glass = "bk7", plastic = "polypropylene";

double parse_index(Properties& properties, const std::string& name, const std::string& fallback) {
    if (!properties.is_string(name) && properties.has(name)) return properties.positive(name, 1);
    const std::string wanted = lower_case(properties.string(name).value_or(fallback));
    if (const auto index = dielectric_index(wanted)) return *index;
    properties.reject(name, "'{}': there is no material '{}'; known are: {}", name, wanted,
                      fmt::join(dielectric_names(), ", "));
}

/// The two indices of refraction at an interface.
struct Indices {
    double inside, outside;
};

Indices parse_indices(Properties& properties, const std::string& interior) {
    return {parse_index(properties, "int_ior", interior), parse_index(properties, "ext_ior", "air")};
}

/// The property to blame for a wrong relative index.
const char* index_name(const Properties& properties) { return properties.has("int_ior") ? "int_ior" : "ext_ior"; }

float parse_relative_index(Properties& properties, const std::string& interior) {
    const auto [inside, outside] = parse_indices(properties, interior);
    const double eta = inside / outside;
    if (!(eta >= lowest_relative_index && eta <= highest_relative_index))
        properties.reject(index_name(properties), "'int_ior' over 'ext_ior' must be between {} and {}, not {:g}",
                          lowest_relative_index, highest_relative_index, eta);
    return static_cast<float>(eta);
}

/// Reads the relative index of a rough model. As in Mitsuba, an interface without a change of index is refused.
float parse_changing_index(Properties& properties, const std::string& interior) {
    const float eta = parse_relative_index(properties, interior);
    if (eta == 1.f) properties.reject(index_name(properties), "'int_ior' and 'ext_ior' must differ");
    return eta;
}

/// Reads the relative index of a rough coat, which must be above 1. Light enters a coat of lower index only through a
/// cone, and RoughCoat's nodes are too far apart for the edge of this cone: beyond it light would both be reflected
/// totally and enter.
float parse_coat_index(Properties& properties, const std::string& interior) {
    const float eta = parse_changing_index(properties, interior);
    if (eta < 1.f)
        properties.reject(index_name(properties),
                          "'int_ior' must be above 'ext_ior': a rough coat is denser than what is outside");
    return eta;
}

/// Reads the dispersion of the interior, which Mitsuba does not have: `cauchy_b`, the B of Cauchy's formula [um^2],
/// or `abbe`, Abbe's number. Returns B over the exterior's index, as for the relative index; 0 if neither is given.
float parse_dispersion(Properties& properties, const std::string& interior) {
    const bool has_abbe = properties.has("abbe");
    properties.exclude("abbe", "cauchy_b");
    const auto [inside, outside] = parse_indices(properties, interior);
    const double given = properties.not_negative("cauchy_b", 0);
    const double abbe = properties.positive("abbe", 1);
    if (has_abbe && !(inside > 1)) properties.reject("abbe", "'abbe' needs an 'int_ior' above 1, not {:g}", inside);
    const double b = (has_abbe ? cauchy_b_of_abbe(inside, abbe) : given) / outside;
    for (const int stratum : {0, wavelength_strata - 1}) {
        const double wavelength = stratum_wavelength(stratum), eta = cauchy_index(inside / outside, b, wavelength);
        if (!(eta >= static_cast<double>(lowest_relative_index) && eta <= static_cast<double>(highest_relative_index)))
            properties.reject(has_abbe ? "abbe" : "cauchy_b",
                              "an index ratio of {:g} at {:g} nm: it must be between {} and {}", eta, wavelength,
                              lowest_relative_index, highest_relative_index);
    }
    return static_cast<float>(b);
}

/// Reads the index of a conductor. Without a material and an index it is a perfect mirror.
template <typename Model>
void read_inner_index(ModelReader<Model>& model) {
    Properties& properties = model.properties();
    const std::string material = properties.string("material").value_or("none");
    for (const char* name : {"eta", "k"})
        properties.declare(name);
    const bool has_index = properties.has("eta") || properties.has("k");
    if (has_index) model->index = ConductorIndex{Color::Zero(), Color::Ones()};
    const auto set_eta = [](Model& m, const Color& c) { m.index->eta = c; };
    const auto set_k = [](Model& m, const Color& c) { m.index->k = c; };
    if (has_index || material == "none") {
        if (!has_index) return;
        if (material != "none") properties.reject("material", "give either 'material' or 'eta' and 'k'");
        model.color("eta", 0.f, ColorRange::non_negative, set_eta, highest_conductor_index);
        model.color("k", 1.f, ColorRange::non_negative, set_k, highest_conductor_index);
        return;
    }
    model->index = conductor_index(material);
    if (!model->index)
        properties.reject("material", "there is no material '{}'; known are: none, {}", material,
                          fmt::join(conductor_names(), ", "));
}

/// Reads the index of a conductor relative to what is outside: `ext_eta` is the `extEta` of Mitsuba 0.6, a number or the name of
/// a dielectric, by which it divides eta and k. Version 3 has no such parameter.
template <typename Model>
void read_conductor_index(ModelReader<Model>& model) {
    read_inner_index(model);
    Properties& properties = model.properties();
    const auto outside = static_cast<float>(parse_index(properties, "ext_eta", "vacuum"));
    if (outside == 1.f || !model->index) return;
    if (model.varies()) properties.reject("ext_eta", "'ext_eta' needs an 'eta' and a 'k' that are no textures");
    model->index->eta /= outside;
    model->index->k /= outside;
}

/// Reads `distribution`, and `sample_visible`, which changes no image.
MicrofacetType parse_distribution_type(Properties& properties) {
    properties.boolean("sample_visible", true);
    return properties.chosen("distribution", MicrofacetType::beckmann,
                             {{"beckmann", MicrofacetType::beckmann}, {"ggx", MicrofacetType::ggx}});
}

/// Whether alpha_u and alpha_v are given instead of alpha.
bool has_two_roughnesses(Properties& properties) {
    for (const char* name : {"alpha", "alpha_u", "alpha_v"})
        properties.declare(name);
    const bool has_u = properties.has("alpha_u"), has_v = properties.has("alpha_v");
    if ((has_u || has_v) && (properties.has("alpha") || !has_u || !has_v))
        throw InputError(properties.element_where(has_u ? "alpha_u" : "alpha_v"),
                         "give either 'alpha' or both 'alpha_u' and 'alpha_v'");
    return has_u;
}

template <typename Model>
void read_distribution(ModelReader<Model>& model) {
    Properties& properties = model.properties();
    model->distribution.type = parse_distribution_type(properties);
    const auto set_u = [](Model& m, float alpha) { m.distribution.alpha_u = alpha; };
    const auto set_v = [](Model& m, float alpha) { m.distribution.alpha_v = alpha; };
    const auto set_both = [](Model& m, float alpha) { m.distribution.alpha_u = m.distribution.alpha_v = alpha; };
    if (!has_two_roughnesses(properties)) return model.number("alpha", 0.1f, set_both, highest_roughness);
    model.number("alpha_u", 0.1f, set_u, highest_roughness);
    model.number("alpha_v", 0.1f, set_v, highest_roughness);
}

/// Reads the distribution of a roughplastic, whose tables are made once for one roughness. Roughnesses are therefore
/// numbers and, as in Mitsuba, the same in both directions.
MicrofacetDistribution parse_uniform_distribution(Properties& properties) {
    const MicrofacetType type = parse_distribution_type(properties);
    const auto roughness = [&](const std::string& name) {
        return static_cast<float>(properties.within(name, 0.1, 0, highest_roughness));
    };
    if (!has_two_roughnesses(properties)) {
        const float alpha = roughness("alpha");
        return {type, alpha, alpha};
    }
    const MicrofacetDistribution distribution{type, roughness("alpha_u"), roughness("alpha_v")};
    if (distribution.alpha_u != distribution.alpha_v)
        properties.reject("alpha_v", "the 'alpha_u' and 'alpha_v' of a roughplastic must be the same");
    return distribution;
}

void read(ModelReader<Diffuse>& model) { model.color<&Diffuse::reflectance>("reflectance", 0.5f); }

/// Reads a dielectric or a thindielectric.
template <typename Model>
void read_dielectric(ModelReader<Model>& model) {
    model->eta = parse_relative_index(model.properties(), glass);
    if constexpr (requires { model->cauchy_b; }) model->cauchy_b = parse_dispersion(model.properties(), glass);
    model.reflectance();
    model.transmittance();
}
void read(ModelReader<Dielectric>& model) { read_dielectric(model); }
void read(ModelReader<ThinDielectric>& model) { read_dielectric(model); }

void read(ModelReader<RoughDielectric>& model) {
    model->eta = parse_changing_index(model.properties(), glass);
    model->cauchy_b = parse_dispersion(model.properties(), glass);
    read_distribution(model);
    model.reflectance();
    model.transmittance();
}

void read(ModelReader<Conductor>& model) {
    read_conductor_index(model);
    model.reflectance();
}

void read(ModelReader<RoughConductor>& model) {
    read_conductor_index(model);
    read_distribution(model);
    model.reflectance();
}

void read(ModelReader<Plastic>& model) {
    model->eta = parse_relative_index(model.properties(), plastic);
    model->nonlinear = model.properties().boolean("nonlinear", false);
    model->prepare();
    model.diffuse_reflectance();
    model.reflectance();
}

void read(ModelReader<RoughPlastic>& model) {
    model->eta = parse_coat_index(model.properties(), plastic);
    model->nonlinear = model.properties().boolean("nonlinear", false);
    model->distribution = parse_uniform_distribution(model.properties());
    model->prepare();
    model.diffuse_reflectance();
    model.reflectance();
}

void read(ModelReader<Phong>& model) {
    model.number<&Phong::exponent>("exponent", 30.f, Phong::highest_exponent);
    model.reflectance_pair();
}

/// Reads a roughdiffuse of Mitsuba 0.6.
void read(ModelReader<RoughDiffuse>& model) {
    model.color<&RoughDiffuse::reflectance>("reflectance", 0.5f);
    model.number<&RoughDiffuse::alpha>("alpha", 0.2f, highest_roughness);
    model->fast = model.properties().boolean("use_fast_approx", false);
}

/// Reads a ward of Mitsuba 0.6.
void read(ModelReader<Ward>& model) {
    using Variant = Ward::Variant;
    model->variant = model.properties().chosen(
        "variant", Variant::balanced,
        {{"balanced", Variant::balanced}, {"ward", Variant::ward}, {"ward-duer", Variant::ward_duer}});
    model.number(
        "alpha_u", 0.1f, [](Ward& m, float alpha) { m.distribution.alpha_u = alpha; }, highest_roughness);
    model.number(
        "alpha_v", 0.1f, [](Ward& m, float alpha) { m.distribution.alpha_v = alpha; }, highest_roughness);
    model.reflectance_pair();
}

/// Reads `eta` or `specular` of a principled. As in Mitsuba, an interface that light passes has a change of index.
float parse_principled_index(Properties& properties, bool transmits) {
    properties.exclude("eta", "specular");
    const double specular = properties.within("specular", 0.5, 0, 1);
    const double eta = properties.positive("eta", 1);
    if (!properties.has("eta"))
        return static_cast<float>(Principled::eta_of_specular(transmits && specular == 0 ? 1e-3 : specular));
    if (!(eta >= lowest_relative_index && eta <= highest_relative_index))
        properties.reject("eta", "'eta' must be between {} and {}, not {:g}", lowest_relative_index,
                          highest_relative_index, eta);
    return transmits && eta == 1 ? 1.001f : static_cast<float>(eta);
}

void read(ModelReader<Principled>& model) {
    model.color<&Principled::base_color>("base_color", 0.5f);
    model.number<&Principled::roughness>("roughness", 0.5f, 1.f);
    model.number<&Principled::anisotropic>("anisotropic", 0.f, 1.f);
    model.number<&Principled::metallic>("metallic", 0.f, 1.f);
    model.number<&Principled::spec_trans>("spec_trans", 0.f, 1.f);
    model.number<&Principled::spec_tint>("spec_tint", 0.f, 1.f);
    model.number<&Principled::sheen>("sheen", 0.f, 1.f);
    model.number<&Principled::sheen_tint>("sheen_tint", 0.f, 1.f);
    model.number<&Principled::flatness>("flatness", 0.f, 1.f);
    model.number<&Principled::clearcoat>("clearcoat", 0.f, 1.f);
    model.number<&Principled::clearcoat_gloss>("clearcoat_gloss", 0.f, 1.f);
    model->eta = parse_principled_index(model.properties(), model->spec_trans > 0.f);
    // Mitsuba's shares of the samples, which change no image.
    for (const char* name :
         {"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate", "clearcoat_sampling_rate"})
        model.properties().not_negative(name, 1);
}

void read(ModelReader<PrincipledThin>& model) {
    using Thin = PrincipledThin;
    model.color<&Thin::base_color>("base_color", 0.5f);
    model.number<&Thin::roughness>("roughness", 0.5f, 1.f);
    model.number<&Thin::diff_trans>("diff_trans", 0.f, 2.f);
    model.number<&Thin::anisotropic>("anisotropic", 0.f, 1.f);
    model.number<&Thin::spec_trans>("spec_trans", 0.f, 1.f);
    model.number<&Thin::spec_tint>("spec_tint", 0.f, 1.f);
    model.number<&Thin::sheen>("sheen", 0.f, 1.f);
    model.number<&Thin::sheen_tint>("sheen_tint", 0.f, 1.f);
    model.number<&Thin::flatness>("flatness", 0.f, 1.f);
    model->eta = static_cast<float>(model.properties().within("eta", 1.5, static_cast<double>(lowest_relative_index),
                                                              static_cast<double>(highest_relative_index)));
    // Mitsuba's shares of the samples, which change no image.
    for (const char* name : {"diffuse_reflectance_sampling_rate", "specular_reflectance_sampling_rate",
                             "specular_transmittance_sampling_rate", "diffuse_transmittance_sampling_rate"})
        model.properties().not_negative(name, 1);
}

template <typename Model>
Material parse_model(Properties& properties, TextureFiles& files) {
    ModelReader<Model> model(properties, files);
    read(model);
    return std::move(model).material();
}

NestedMaterial parse_nested(const NestedObject& object, TextureFiles& files) {
    return std::make_shared<const Material>(parse_bsdf(object, files));
}

/// The bsdfs inside one that takes `lowest` to `highest` of them. Throws InputError for another number.
std::vector<NestedObject> nested_bsdfs(Properties& properties, std::size_t lowest, std::size_t highest) {
    auto nested = properties.objects("bsdf");
    if (nested.size() >= lowest && nested.size() <= highest) return nested;
    const char* names[] = {"no", "one", "two"};
    reject(properties.element().where, "{} takes {} bsdf{}, found {}", properties.element().required("type").value,
           lowest == highest ? names[lowest] : fmt::format("{} or {}", names[lowest], names[highest]),
           highest == 1 ? "" : "s", nested.size());
}

Material parse_twosided(Properties& properties, TextureFiles& files) {
    std::vector<NestedMaterial> sides;
    for (const auto& side : nested_bsdfs(properties, 1, 2)) {
        if (side.element->required("type").value == "twosided")
            throw InputError(side.where, "a bsdf inside twosided cannot be twosided");
        sides.push_back(parse_nested(side, files));
        if (sides.back()->traits().transmission || sides.back()->has_holes())
            throw InputError(side.where, "a bsdf inside twosided must not transmit light");
    }
    return Material(TwoSided{sides.front(), sides.back()});
}

/// Reads a coating or a roughcoating of Mitsuba 0.6. What the surface reflects is that of a plastic with a black base.
template <typename Surface>
Material parse_coating(Properties& properties, TextureFiles& files) {
    constexpr bool rough = std::is_same_v<Surface, RoughPlastic>;
    ModelReader<Surface> surface(properties, files);
    surface->eta = rough ? parse_coat_index(properties, glass) : parse_relative_index(properties, glass);
    if constexpr (rough) surface->distribution = parse_uniform_distribution(properties);
    surface->diffuse_reflectance = Color::Zero();
    surface->prepare();
    surface.reflectance();
    Coat coat;
    coat.eta = surface->eta;
    if constexpr (rough) coat.rough = surface->coat();
    const Texture absorption = parse_textured(properties, "sigma_a", 0, ColorRange::non_negative, files);
    const auto thickness = static_cast<float>(properties.not_negative("thickness", 1));
    coat.absorption = absorption.maximum() * thickness;
    const NestedObject inside = nested_bsdfs(properties, 1, 1)[0];
    const NestedMaterial nested = parse_nested(inside, files);
    if (nested->traits().transmission || nested->has_holes())
        throw InputError(inside.where, "a bsdf inside a coating must not transmit light");
    if (nested->is_bumped() || nested->is_coated())
        throw InputError(inside.where, "a bsdf inside a coating must not tilt normals or be coated itself");
    return Material(Coating{std::make_shared<const Coat>(coat), absorption, thickness,
                            std::make_shared<const Material>(std::move(surface).material()), nested});
}

Material parse_blend(Properties& properties, TextureFiles& files) {
    const auto nested = nested_bsdfs(properties, 2, 2);
    return Material(Blend{parse_textured_number(properties, "weight", 0.5f, ColorRange::unit, files),
                          parse_nested(nested[0], files), parse_nested(nested[1], files)});
}

Material parse_mask(Properties& properties, TextureFiles& files) {
    return Material(Mask{parse_textured_number(properties, "opacity", 0.5f, ColorRange::unit, files),
                         parse_nested(nested_bsdfs(properties, 1, 1)[0], files)});
}

PerturbationOptions parse_perturbation(Properties& properties) {
    return {properties.boolean("flip_invalid_normals", true), properties.boolean("use_shadowing_function", true)};
}

/// Reads a bumpmap. The texture of the height may have any name.
Material parse_bumpmap(Properties& properties, TextureFiles& files) {
    const double scale = properties.within("scale", 1, -highest_bump, highest_bump);
    const PerturbationOptions options = parse_perturbation(properties);
    const auto height = properties.object("texture");
    if (!height) throw InputError(properties.element().where, "a bumpmap needs a texture");
    const NestedMaterial nested = parse_nested(nested_bsdfs(properties, 1, 1)[0], files);
    const Texture texture = parse_texture(*height, ColorRange::non_negative, files);
    if (!texture.has_gradient())
        throw InputError(height->where, "a bumpmap's texture must be a bitmap: it needs a slope");
    return Material(
        BumpMap{.height = texture, .scale = static_cast<float>(scale), .nested = nested, .options = options});
}

Material parse_normalmap(Properties& properties, TextureFiles& files) {
    if (!properties.has("normalmap"))
        throw InputError(properties.element().where, "a normalmap needs a texture named 'normalmap'");
    // An image may hold any numbers; a value must be a colour.
    const auto image = properties.named_object("normalmap", "texture");
    const Texture normal = image ? parse_texture(*image, ColorRange::non_negative, files)
                                 : Texture(color_property(properties, "normalmap", 1, ColorRange::unit));
    const PerturbationOptions options = parse_perturbation(properties);
    return Material(NormalMap{normal, parse_nested(nested_bsdfs(properties, 1, 1)[0], files), options});
}

void warn_of_polarization(const Properties& properties) {
    properties.ids().warn(properties.element().where,
                          fmt::format("polarization is left out: '{}' lets light through as in Mitsuba's unpolarized "
                                      "variants",
                                      properties.element().required("type").value));
}

/// Reads a polarizer or a circular one. Unpolarized light of any direction goes straight on, and half of it is absorbed.
Material parse_polarizer(Properties& properties, TextureFiles& files) {
    warn_of_polarization(properties);
    for (const char* name : {"theta", "polarizing", "left_handed"})
        properties.ignore(name);
    ModelReader<ThinDielectric> model(properties, files);
    model->eta = 1;
    model->specular_reflectance = Color::Zero();
    model.color("transmittance", 1.f, ColorRange::unit,
                [](ThinDielectric& m, const Color& c) { m.specular_transmittance = 0.5f * c; });
    return std::move(model).material();
}

/// Reads a retarder, which changes only the polarization of light.
Material parse_retarder(Properties& properties, TextureFiles&) {
    warn_of_polarization(properties);
    for (const char* name : {"theta", "delta"})
        properties.ignore(name);
    return Material(Nothing{});
}

using Parse = Material (*)(Properties&, TextureFiles&);
struct BsdfPlugin {
    std::string_view name;
    Parse parse;
};
constexpr BsdfPlugin plugins[] = {
    {"diffuse", parse_model<Diffuse>},
    {"dielectric", parse_model<Dielectric>},
    {"thindielectric", parse_model<ThinDielectric>},
    {"roughdielectric", parse_model<RoughDielectric>},
    {"conductor", parse_model<Conductor>},
    {"roughconductor", parse_model<RoughConductor>},
    {"plastic", parse_model<Plastic>},
    {"roughplastic", parse_model<RoughPlastic>},
    {"phong", parse_model<Phong>},
    {"principled", parse_model<Principled>},
    {"principledthin", parse_model<PrincipledThin>},
    {"roughdiffuse", parse_model<RoughDiffuse>},
    {"ward", parse_model<Ward>},
    {"coating", parse_coating<Plastic>},
    {"roughcoating", parse_coating<RoughPlastic>},
    {"twosided", parse_twosided},
    {"blendbsdf", parse_blend},
    {"mask", parse_mask},
    {"null", [](Properties&, TextureFiles&) { return Material(Nothing{}); }},
    {"polarizer", parse_polarizer},
    {"circular", parse_polarizer},
    {"retarder", parse_retarder},
    {"bumpmap", parse_bumpmap},
    {"normalmap", parse_normalmap},
};

}  // namespace

Material parse_bsdf(const NestedObject& object, TextureFiles& files) {
    const OpenElement open(object, files);
    Properties properties(*object.element, files.ids());
    std::vector<std::string_view> names;
    for (const BsdfPlugin& plugin : plugins)
        names.push_back(plugin.name);
    const std::string& type = properties.plugin(names);
    const auto plugin =
        std::find_if(std::begin(plugins), std::end(plugins), [&](const auto& p) { return p.name == type; });
    if (object.element->old) properties.boolean("ensure_energy_conservation", true);  // of all bsdfs of Mitsuba 0.6
    try {
        Material material = plugin->parse(properties, files);
        properties.finish();
        return material;
    } catch (const std::invalid_argument& error) {
        throw InputError(object.where, error.what());
    }
}

}  // namespace gib
