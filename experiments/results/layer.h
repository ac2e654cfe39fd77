#pragma once
// The layers of an image with rows of their own: each component, and the sum of those that the reference has.

#include "common/core/components.h"
#include "common/scene/effects.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gib {

enum class Layer { total, emission, direct, caustic, indirect, volume };
inline constexpr std::array<Layer, component_count + 1> all_layers = {Layer::total,   Layer::emission, Layer::direct,
                                                                      Layer::caustic, Layer::indirect, Layer::volume};

inline constexpr Layer layer_of(Component c) { return static_cast<Layer>(static_cast<int>(c) + 1); }
/// Empty for the total.
inline constexpr std::optional<Component> component_of(Layer layer) {
    if (layer == Layer::total) return std::nullopt;
    return static_cast<Component>(static_cast<int>(layer) - 1);
}
inline std::string_view name_of(Layer layer) {
    return layer == Layer::total ? std::string_view("total") : name_of(*component_of(layer));
}
inline std::optional<Layer> layer_named(std::string_view name) {
    for (const Layer layer : all_layers)
        if (name_of(layer) == name) return layer;
    return std::nullopt;
}

/// A set of components.
class Components {
public:
    Components() = default;
    Components(std::initializer_list<Component> components) {
        for (const Component c : components)
            add(c);
    }
    explicit Components(const std::vector<Component>& components) {
        for (const Component c : components)
            add(c);
    }
    void add(Component c) { bits_ |= 1u << static_cast<unsigned>(c); }
    bool has(Component c) const { return ((bits_ >> static_cast<unsigned>(c)) & 1u) != 0; }
    /// Whether the layer contains light of the set; the total does if any component is in it.
    bool touches(Layer layer) const { return layer == Layer::total ? !empty() : has(*component_of(layer)); }
    bool empty() const { return bits_ == 0; }
    std::vector<Component> list() const {
        std::vector<Component> members;
        for (const Component c : all_components)
            if (has(c)) members.push_back(c);
        return members;
    }
    friend bool operator==(const Components&, const Components&) = default;

private:
    unsigned bits_ = 0;
};

/// The parts of a scene's light that a method leaves out.
struct LeftOut {
    Effects effects = {};        ///< that the scene calls for and the method does not simulate
    Components components = {};  ///< components that it samples incompletely

    bool empty() const { return effects.empty() && components.empty(); }
};

}  // namespace gib
