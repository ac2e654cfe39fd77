#include "experiments/analysis/scene_light.h"

#include <algorithm>

namespace gib {

namespace {

bool contains(const std::vector<Component>& components, Component c) {
    return std::find(components.begin(), components.end(), c) != components.end();
}

}  // namespace

SceneLight::SceneLight(const Reference& reference) {
    for (Component c : all_components)
        if (const auto& layer = reference[c]) add(c, layer->mean, !contains(reference.unresolved, c));
}

void SceneLight::add(const std::vector<ComponentImages>& images, const std::string& left_out) {
    const std::vector<Component> incomplete = components_named(left_out);
    for (const ComponentImages& image : images)
        for (Component c : all_components)
            if (image[c]) add(c, *image[c], !contains(incomplete, c));
}

void SceneLight::add(Component c, const Image& image, bool has_all_paths) {
    const auto i = static_cast<std::size_t>(index_of(c));
    sampled_[i] = sampled_[i] || has_all_paths;
    seen_[i] = seen_[i] || !is_black(image);
}

std::string SceneLight::holding_light(const std::string& names) const {
    std::vector<Component> found = components_named(names);
    std::erase_if(found, [this](Component c) { return !may_hold_light(c); });
    return names_of(found);
}

}  // namespace gib
