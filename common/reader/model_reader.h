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

    /// Reads a colour. `Set` is a lambda without captures that puts it into the model.
    template <typename Set>
    void color(const std::string& name, float fallback, ColorRange range, Set set, float highest = infinity) {
        const Texture texture = parse_textured(properties_, name, fallback, range, files_);
        check_highest(name, texture, highest);
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
    void reflectance(float fallback = 1.f) {
        color("specular_reflectance", fallback, ColorRange::unit,
              [](Model& m, const Color& c) { m.specular_reflectance = c; });
    }
    void transmittance() {
        color("specular_transmittance", 1.f, ColorRange::unit,
              [](Model& m, const Color& c) { m.specular_transmittance = c; });
    }
    void diffuse_reflectance() {
        color("diffuse_reflectance", 0.5f, ColorRange::unit,
              [](Model& m, const Color& c) { m.diffuse_reflectance = c; });
    }
    /// Whether a parameter that has been read is a texture.
    bool varies() const { return !parameters_.empty(); }
    /// Scales both reflectances down if they exceed 1 together, as Mitsuba 0.6 does. Throws InputError if one of them varies.
    void conserve_energy() {
        const float sum = (model_.diffuse_reflectance + model_.specular_reflectance).maxCoeff();
        if (sum <= 1.f + unit_roundoff) return;
        const SourceLocation& where = properties_.element().where;
        const std::string& type = properties_.element().required("type").value;
        if (varies())
            gib::reject(where, "{}'s diffuse_reflectance and specular_reflectance must not exceed 1 together", type);
        model_.diffuse_reflectance /= sum;
        model_.specular_reflectance /= sum;
        properties_.ids().warn(where,
                               fmt::format("{}'s diffuse_reflectance and specular_reflectance exceed 1 together: both "
                                           "are scaled down",
                                           type));
    }
    Material material() && { return Material(TexturedScattering{std::move(model_), std::move(parameters_)}); }

private:
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
