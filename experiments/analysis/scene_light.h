#pragma once
// Which components of a scene hold light, by its reference and by the images of its methods. Light that the reference
// does not judge, or that a method leaves out, decides whether a verdict about the whole image holds.

#include "experiments/metrics/reference_image.h"
#include "experiments/results/layer.h"

#include <vector>

namespace gib {

class SceneLight {
public:
    /// Takes what the reference shows of the components that it resolves and of the others.
    explicit SceneLight(const Reference& reference) {
        const Components unresolved(reference.unresolved);
        for (Component c : all_components)
            if (const auto& layer = reference[c]) add(c, layer->mean, !unresolved.has(c));
    }
    /// Adds the images of a method. `left_out` are the components of which it leaves out paths.
    void add(const std::vector<ComponentImages>& images, const Components& left_out) {
        for (const ComponentImages& image : images)
            for (Component c : all_components)
                if (image[c]) add(c, *image[c], !left_out.has(c));
    }

    /// Those of the components that hold light: some image shows it, or no image has all of the component's paths, so that
    /// none would show it.
    Components holding_light(const Components& components) const {
        Components found;
        for (const Component c : components.list())
            if (seen_.has(c) || !sampled_.has(c)) found.add(c);
        return found;
    }

private:
    void add(Component c, const Image& image, bool has_all_paths) {
        if (has_all_paths) sampled_.add(c);
        if (!seen_.has(c) && !is_black(image)) seen_.add(c);
    }

    Components seen_, sampled_;
};

}  // namespace gib
