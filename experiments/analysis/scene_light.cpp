#include "experiments/analysis/scene_light.h"

namespace gib {

SceneLight::SceneLight(const Reference& reference) {
    const Components unresolved(reference.unresolved);
    for (Component c : all_components)
        if (const auto& layer = reference[c]) add(c, layer->mean, !unresolved.has(c));
}

void SceneLight::add(const std::vector<ComponentImages>& images, const Components& left_out) {
    for (const ComponentImages& image : images)
        for (Component c : all_components)
            if (image[c]) add(c, *image[c], !left_out.has(c));
}

void SceneLight::add(Component c, const Image& image, bool has_all_paths) {
    const auto i = static_cast<std::size_t>(index_of(c));
    sampled_[i] = sampled_[i] || has_all_paths;
    seen_[i] = seen_[i] || !is_black(image);
}

Components SceneLight::holding_light(const Components& components) const {
    Components found;
    for (const Component c : components.list())
        if (may_hold_light(c)) found.add(c);
    return found;
}

}  // namespace gib
