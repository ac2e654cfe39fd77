#pragma once
// The film adds up samples by pixel and component, in double. Different threads may add to different pixels.

#include "common/images/image.h"
#include "common/images/non_finite.h"

#include <array>
#include <vector>

namespace gib {

/// One sample of a pixel: radiance [W/(sr m^2)] by component.
struct PixelSample {
    std::array<Color, component_count> parts;

    PixelSample() { parts.fill(Color::Zero()); }
    Color& operator[](Component c) { return parts[static_cast<std::size_t>(index_of(c))]; }
    const Color& operator[](Component c) const { return parts[static_cast<std::size_t>(index_of(c))]; }
};

class Film {
public:
    /// `accumulated` are the components that samples may hold; only these take memory. `black` are further components
    /// that the image shows as black, because the method can simulate them but this scene cannot have them. Throws
    /// InputError if there is not enough memory for the images.
    Film(int width, int height, const std::vector<Component>& accumulated, const std::vector<Component>& black);

    /// Adds the sample of `pixel` (row-major index) in `pass` (counted from 0). Throws std::logic_error for light in
    /// a component that is not accumulated, which is a mistake of the plan.
    void add(std::size_t pixel, std::uint32_t pass, const PixelSample& sample);
    /// The mean over `samples` samples of each pixel [W/(sr m^2)].
    ComponentImages mean(std::uint64_t samples) const;
    NonFinite non_finite() const;

private:
    int width_, height_;
    std::array<std::vector<double>, component_count> sums_;
    std::vector<Component> black_;
    NonFiniteCount non_finite_;
};

}  // namespace gib
