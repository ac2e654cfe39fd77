#include "common/effects.h"

namespace gib {

const std::vector<EffectDescription>& effect_descriptions() {
    static const std::vector<EffectDescription> descriptions = {
        {Effect::direct_light, "direct_light", "light that reaches a diffuse surface straight from an emitter"},
        {Effect::diffuse_interreflection, "diffuse_interreflection",
         "light that leaves one diffuse surface for another"},
        {Effect::specular_reflection, "specular_reflection", "mirror images in conductors and dielectrics"},
        {Effect::refraction, "refraction", "light that passes a dielectric boundary and is bent"},
        {Effect::caustics, "caustics", "light that specular surfaces concentrate on diffuse ones"},
        {Effect::smooth_normals, "smooth_normals", "shading normals interpolated over a mesh"},
        {Effect::environment_light, "environment_light", "light from all around, infinitely far away"},
    };
    return descriptions;
}

std::string_view name_of(Effect effect) { return effect_descriptions()[static_cast<std::size_t>(effect)].name; }

Effects Effects::all() {
    Effects e;
    for (const auto& d : effect_descriptions())
        e.add(d.effect);
    return e;
}

std::vector<Effect> Effects::list() const {
    std::vector<Effect> effects;
    for (const auto& d : effect_descriptions())
        if (has(d.effect)) effects.push_back(d.effect);
    return effects;
}

Effects effects_of(const Scene& scene) {
    bool diffuse = false, specular = false;
    Effects effects;
    for (std::size_t i = 0; i < scene.shapes().size(); ++i) {
        const Bsdf& bsdf = scene.bsdf_of_shape(i);
        if (!bsdf.reflects()) continue;
        diffuse |= bsdf.has_diffuse();
        specular |= bsdf.has_specular();
        if (bsdf.has_refraction()) effects.add(Effect::refraction);
        if (has_smooth_normals(scene.shapes()[i])) effects.add(Effect::smooth_normals);
    }
    if (specular) effects.add(Effect::specular_reflection);
    if (scene.environment()) effects.add(Effect::environment_light);
    if (!scene.has_light()) return effects;
    if (diffuse) {
        effects.add(Effect::direct_light);
        effects.add(Effect::diffuse_interreflection);
    }
    if (diffuse && specular) effects.add(Effect::caustics);
    return effects;
}

}  // namespace gib
