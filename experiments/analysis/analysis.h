#pragma once
// Computes the numbers of the tables and the report from the stored cells of a result folder.

#include "experiments/analysis/table_row.h"
#include "experiments/metrics/reference_image.h"

#include <vector>

namespace gib {

/// The components of a scene that hold light, by its reference and by the images of its methods. A verdict about the
/// whole image needs a reference of all of them.
class SceneLight {
public:
    /// Records which components are lit in the reference, and which of them it samples completely.
    explicit SceneLight(const Reference& reference) {
        const Components unresolved(reference.unresolved);
        for (Component c : all_components)
            if (const auto& layer = reference[c]) add(c, layer->mean, !unresolved.has(c));
    }
    /// Adds the images of a method. `left_out`: the components that it samples incompletely.
    void add(const std::vector<ComponentImages>& images, const Components& left_out) {
        for (const ComponentImages& image : images)
            for (Component c : all_components)
                if (image[c]) add(c, *image[c], !left_out.has(c));
    }

    /// The lit ones among `components`: lit in some image, or sampled completely by no image.
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

/// Reads a result folder and computes its rows. If a cell has no FLIP value yet, it is measured and stored in the
/// folder. Throws InputError if the folder holds no results.
Analysis analyse(const ResultFolder& folder);

}  // namespace gib
