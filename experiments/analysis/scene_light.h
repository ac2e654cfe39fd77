#pragma once
// Which components of a scene hold light, by its reference and by the images of its methods. Light that the reference
// does not judge, or that a method leaves out, decides whether a verdict about the whole image holds.

#include "experiments/metrics/reference_image.h"
#include "experiments/results/layer.h"

#include <array>
#include <vector>

namespace gib {

class SceneLight {
public:
    /// Takes what the reference shows of the components that it resolves and of the others.
    explicit SceneLight(const Reference& reference);
    /// Adds the images of a method. `left_out` are the components of which it leaves out paths.
    void add(const std::vector<ComponentImages>& images, const Components& left_out);

    /// Whether some image has light in this component.
    bool is_seen(Component c) const { return seen_[static_cast<std::size_t>(index_of(c))]; }
    /// Whether the component holds light: some image shows it, or no image has all of the component's paths, so that
    /// none would show it.
    bool may_hold_light(Component c) const { return is_seen(c) || !sampled_[static_cast<std::size_t>(index_of(c))]; }
    /// Those of the components that hold light.
    Components holding_light(const Components& components) const;

private:
    void add(Component c, const Image& image, bool has_all_paths);

    std::array<bool, component_count> seen_{}, sampled_{};
};

}  // namespace gib
