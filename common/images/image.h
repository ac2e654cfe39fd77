#pragma once
// Images in memory: linear radiance, height x width x 3, row 0 on top.

#include "common/core/components.h"
#include "common/core/math.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gib {

struct Image {
    int width = 0, height = 0;
    std::vector<float> rgb;  ///< [W/(sr m^2)], height x width x 3, row 0 on top

    Image() = default;
    Image(int w, int h)
        : width(w), height(h), rgb(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3, 0.f) {}

    std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
    Color at(std::size_t pixel) const { return {rgb[3 * pixel], rgb[3 * pixel + 1], rgb[3 * pixel + 2]}; }
    void set(std::size_t pixel, const Color& c) {
        for (std::size_t k = 0; k < 3; ++k)
            rgb[3 * pixel + k] = c[static_cast<Eigen::Index>(k)];
    }
    /// Adds an image of the same size.
    Image& operator+=(const Image& other);
    bool same_size(const Image& other) const { return width == other.width && height == other.height; }
    /// The number of values that are not finite.
    std::size_t non_finite_values() const;
};

/// Names of the images of techniques begin with this.
inline constexpr std::string_view technique_layer_prefix = "technique_";

/// Names of the images of estimated bias end with this.
inline constexpr std::string_view bias_layer_suffix = "bias";

/// An image as the sum of its components. A component that the method cannot simulate, or that the scene cannot have,
/// may be absent.
struct ComponentImages {
    int width = 0, height = 0;
    std::array<std::optional<Image>, component_count> parts;
    /// Images of single techniques, by name (technique_layer_prefix), for methods that keep them apart; each is a share
    /// of the sum, or would be one.
    std::vector<std::pair<std::string, Image>> techniques = {};
    /// How far the components lie above the truth on average, as estimated by methods that blur light; noisy. A component
    /// without an entry is not blurred.
    std::array<std::optional<Image>, component_count> bias = {};

    const std::optional<Image>& operator[](Component c) const { return parts[static_cast<std::size_t>(index_of(c))]; }
    std::optional<Image>& operator[](Component c) { return parts[static_cast<std::size_t>(index_of(c))]; }
    /// The sum of the components that are present.
    Image total() const;
    /// The sum of the components' biases; empty if there is none.
    std::optional<Image> total_bias() const;
};

}  // namespace gib
