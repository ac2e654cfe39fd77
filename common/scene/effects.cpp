#include "common/scene/effects.h"

#include "common/scene/scene.h"

#include <algorithm>

namespace gib {

const std::vector<EffectDescription>& effect_descriptions() {
    static const std::vector<EffectDescription> descriptions = {
        {Effect::direct_light, "direct_light", "light that reaches a diffuse surface straight from an emitter"},
        {Effect::diffuse_interreflection, "diffuse_interreflection",
         "light that leaves one diffuse surface for another"},
        {Effect::specular_reflection, "specular_reflection", "mirror images in conductors and dielectrics"},
        {Effect::refraction, "refraction", "light that passes a dielectric boundary and is bent"},
        {Effect::caustics, "caustics", "light that specular surfaces concentrate on diffuse ones"},
        {Effect::glossy_lobes, "glossy_lobes", "light scattered around a preferred direction by rough surfaces"},
        {Effect::participating_media, "participating_media", "light absorbed or scattered between surfaces"},
        {Effect::dispersion, "dispersion", "light split by its wavelength where it is refracted"},
        {Effect::textures, "textures", "materials or emitters that vary over a surface"},
        {Effect::bump_maps, "bump_maps", "shading normals tilted by a bump or normal map"},
        {Effect::smooth_normals, "smooth_normals", "shading normals interpolated over a mesh"},
        {Effect::depth_of_field, "depth_of_field", "blur of points on which the lens is not focused"},
        {Effect::environment_light, "environment_light", "light from all directions, infinitely far away"},
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

std::string Effects::names() const {
    std::string names;
    for (const Effect e : list()) {
        if (!names.empty()) names += ';';
        names += name_of(e);
    }
    return names;
}

Effects effects_of(const Scene& scene) {
    LobeTraits lobes;
    Effects effects;
    for (std::size_t i = 0; i < scene.shapes().size(); ++i) {
        const Material& material = scene.material_of_shape(i);
        if (material.is_textured()) effects.add(Effect::textures);
        if (!material.traits().scatters()) continue;
        lobes |= material.traits();
        if (material.is_bumped()) effects.add(Effect::bump_maps);
        if (material.is_dispersive()) effects.add(Effect::dispersion);
        if (has_smooth_normals(scene.shapes()[i])) effects.add(Effect::smooth_normals);
    }
    for (const Light& light : scene.lights()) {
        const auto* area = std::get_if<AreaLight>(&light);
        const auto* spot = std::get_if<SpotLight>(&light);
        const auto* projector = std::get_if<ProjectorLight>(&light);
        if ((area && area->texture) || (spot && spot->is_textured()) || (projector && projector->is_textured()))
            effects.add(Effect::textures);
    }
    if (lobes.specular()) effects.add(Effect::specular_reflection);
    if (lobes.refraction) effects.add(Effect::refraction);
    if (lobes.rough) effects.add(Effect::glossy_lobes);
    if (scene.has_media()) effects.add(Effect::participating_media);
    if (scene.sensor().has_lens()) effects.add(Effect::depth_of_field);
    if (scene.environment()) effects.add(Effect::environment_light);
    if (!scene.has_light()) return effects;
    if (lobes.diffuse) {
        effects.add(Effect::direct_light);
        effects.add(Effect::diffuse_interreflection);
    }
    if (lobes.diffuse && lobes.specular()) effects.add(Effect::caustics);
    return effects;
}

}  // namespace gib
