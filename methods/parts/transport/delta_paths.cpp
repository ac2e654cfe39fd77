#include "methods/parts/transport/delta_paths.h"

#include "common/scene/scene.h"

#include <algorithm>
#include <iterator>

namespace gib {

namespace {

bool is_pencil(const Light& light) {
    constexpr double small = 1e-6;  // [sr]
    const auto is_narrow = [](const auto& source) { return source.pdf_w(source.sample({0.5f, 0.5f}).w) * small > 1; };
    if (const auto* spot = std::get_if<SpotLight>(&light)) return is_narrow(*spot);
    const auto* projector = std::get_if<ProjectorLight>(&light);
    return projector && is_narrow(*projector);
}

/// Whether the effects hold paths of this component.
bool has_paths_of(Component c, const Effects& effects) {
    switch (c) {
        case Component::emission:
            return true;
        case Component::direct:
            return effects.has(Effect::direct_light);
        case Component::caustic:
            return effects.has(Effect::caustics);
        case Component::indirect:
            return effects.has(Effect::diffuse_interreflection);
        case Component::volume:
            return effects.has(Effect::participating_media);
    }
    return false;
}

}  // namespace

void leave_out(Plan& plan, const std::vector<Component>& components) {
    for (const Component c : components)
        if (std::find(plan.unresolved.begin(), plan.unresolved.end(), c) == plan.unresolved.end())
            plan.unresolved.push_back(c);
}

bool has_delta_lobe(const Scene& scene) {
    return std::any_of(scene.materials().begin(), scene.materials().end(),
                       [](const Material& material) { return material.traits().delta; });
}

std::vector<Component> components_of_delta_paths(const Scene& scene, const Effects& called_for) {
    const bool has_delta_light = std::any_of(scene.lights().begin(), scene.lights().end(), is_delta);
    if (!has_delta_light || !has_delta_lobe(scene)) return {};
    std::vector<Component> components;
    if (called_for.has(Effect::caustics)) components = {Component::caustic, Component::indirect};
    if (called_for.has(Effect::participating_media)) components.push_back(Component::volume);
    return components;
}

std::vector<Component> components_of_pencils(const Scene& scene, const Effects& called_for,
                                             const std::vector<Component>& lit) {
    if (std::none_of(scene.lights().begin(), scene.lights().end(), is_pencil)) return {};
    std::vector<Component> components;
    std::copy_if(lit.begin(), lit.end(), std::back_inserter(components),
                 [&](Component c) { return has_paths_of(c, called_for); });
    return components;
}

std::vector<Component> components_of_mirrored_pencils(const Scene& scene, const Effects& called_for) {
    if (!has_delta_lobe(scene)) return {};
    return components_of_pencils(scene, called_for, {Component::direct, Component::volume});
}

void leave_out_of_camera_paths(Plan& plan, const Scene& scene) {
    const std::vector<Component> delta = components_of_delta_paths(scene, plan.called_for);
    leave_out(plan, delta);
    const auto& lights = scene.lights();
    if (!delta.empty() && plan.called_for.has(Effect::caustics) && !plan.called_for.has(Effect::glossy_lobes) &&
        std::all_of(lights.begin(), lights.end(), is_delta))
        plan.missing.add(Effect::caustics);
    leave_out(plan,
              components_of_pencils(scene, plan.called_for,
                                    {Component::direct, Component::caustic, Component::indirect, Component::volume}));
}

}  // namespace gib
