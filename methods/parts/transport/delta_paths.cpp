#include "methods/parts/transport/delta_paths.h"

#include "common/scene/scene.h"

#include <algorithm>

namespace gib {

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

}  // namespace gib
