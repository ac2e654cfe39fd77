#pragma once
// Reads the parameters of a scattering model, each of which may be a texture.

#include "common/core/reject.h"
#include "common/materials/material.h"
#include "common/reader/scene_texture.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace gib {

/// Reads the parameters of a model. Constant ones are put into the model, the others are kept beside it as textures.
template <typename Model>
class ModelReader {
public:
    ModelReader(Properties& properties, TextureFiles& files) : properties_(properties), files_(files) {}

    Model* operator->() { return &model_; }
    Properties& properties() { return properties_; }

    /// Reads a colour. `Set` is a lambda without captures that puts it into the model. A reflectance above 1 is scaled down in
    /// old files.
    template <typename Set>
    void color(const std::string& name, float fallback, ColorRange range, Set set, float highest = infinity) {
        const bool scales = range == ColorRange::unit && scales_reflectances();
        Texture texture =
            parse_textured(properties_, name, fallback, scales ? ColorRange::non_negative : range, files_);
        check_highest(name, texture, highest);
        if (const float most = texture.maximum().maxCoeff(); scales && most > 1.f) {
            properties_.warn(name, "'{}' is above 1: it is scaled down to {}", name, scaled_reflectance);
            texture = scaled(texture, scaled_reflectance / most);
        }
        put(texture, set);
    }
    template <typename Set>
    void put(const Texture& texture, Set set) {
        set(model_, texture.maximum());
        if (texture.constant()) return;
        parameters_.push_back({texture, [](Scattering& s, const Color& c) { Set{}(std::get<Model>(s), c); }, nullptr});
    }
    /// Reads a number. `Set` is a lambda without captures that puts it into the model.
    template <typename Set>
    void number(const std::string& name, float fallback, Set set, float highest) {
        const Texture texture = parse_textured_number(properties_, name, fallback, ColorRange::non_negative, files_);
        check_highest(name, texture, highest);
        set(model_, texture.constant() ? texture.value(Vec2(0, 0)) : texture.maximum().maxCoeff());
        if (texture.constant()) return;
        parameters_.push_back({texture, nullptr, [](Scattering& s, float x) { Set{}(std::get<Model>(s), x); }});
    }
    /// The same for a member of the model. Colours are reflectances.
    template <auto member>
    void color(const std::string& name, float fallback) {
        color(name, fallback, ColorRange::unit, [](Model& m, const Color& c) { m.*member = c; });
    }
    template <auto member>
    void number(const std::string& name, float fallback, float highest) {
        number(
            name, fallback, [](Model& m, float x) { m.*member = x; }, highest);
    }
    void reflectance() { color<&Model::specular_reflectance>("specular_reflectance", 1.f); }
    void transmittance() { color<&Model::specular_transmittance>("specular_transmittance", 1.f); }
    void diffuse_reflectance() { color<&Model::diffuse_reflectance>("diffuse_reflectance", 0.5f); }
    /// Reads the diffuse and the specular reflectance of a model that is the sum of both, such as phong. Where their highest
    /// values exceed 1 together, both are scaled down.
    void reflectance_pair() {
        const ColorRange range = scales_reflectances() ? ColorRange::non_negative : ColorRange::unit;
        Texture diffuse = parse_textured(properties_, "diffuse_reflectance", 0.5f, range, files_),
                specular = parse_textured(properties_, "specular_reflectance", 0.2f, range, files_);
        const float sum = (diffuse.maximum() + specular.maximum()).maxCoeff();
        if (!(sum <= 1.f + unit_roundoff)) {
            const float scale = (scales_reflectances() ? scaled_reflectance : 1.f) / sum;
            diffuse = scaled(diffuse, scale);
            specular = scaled(specular, scale);
            properties_.ids().warn(properties_.element().where,
                                   fmt::format("{}'s diffuse_reflectance and specular_reflectance exceed 1 together: "
                                               "both are scaled down by {:.4g}",
                                               properties_.element().required("type").value, scale));
        }
        put(diffuse, [](Model& m, const Color& c) { m.diffuse_reflectance = c; });
        put(specular, [](Model& m, const Color& c) { m.specular_reflectance = c; });
    }
    /// Whether a parameter that has been read is a texture.
    bool varies() const { return !parameters_.empty(); }
    Material material() && { return Material(TexturedScattering{std::move(model_), std::move(parameters_)}); }

private:
    /// The value to which Mitsuba 0.6 scales reflectances above 1 (BSDF::ensureEnergyConservation).
    static constexpr float scaled_reflectance = 0.99f;
    /// Whether reflectances above 1 are scaled down: in old files, unless a file says that they are not.
    bool scales_reflectances() {
        return properties_.element().old && properties_.boolean("ensure_energy_conservation", true);
    }
    static Texture scaled(const Texture& texture, float scale) {
        return Texture(ScaledTexture{texture, Color::Constant(scale)});
    }
    void check_highest(const std::string& name, const Texture& texture, float highest) const {
        const float value = texture.maximum().maxCoeff();
        if (!(value <= highest))
            properties_.reject(name, "'{}' must be at most {:g}, not {:g}{}", name, highest, value,
                               texture.constant() ? "" : " of its texture");
    }

    Properties& properties_;
    TextureFiles& files_;
    Model model_;
    std::vector<TexturedParameter> parameters_;
};

}  // namespace gib
