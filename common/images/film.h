#pragma once
// Accumulates samples per pixel and component, in double. Pixels are independent: different threads may add to
// different ones.

#include "common/images/image.h"

#include <atomic>
#include <cstdint>
#include <mutex>

namespace gib {

/// One sample of a pixel: radiance [W/(sr m^2)] by component.
struct PixelSample {
    std::array<Color, component_count> parts;

    PixelSample() { parts.fill(Color::Zero()); }
    Color& operator[](Component c) { return parts[static_cast<std::size_t>(index_of(c))]; }
    const Color& operator[](Component c) const { return parts[static_cast<std::size_t>(index_of(c))]; }
};

/// Samples that were not finite: counted, dropped (they count as black), and the first can be reproduced.
struct NonFinite {
    std::uint64_t count = 0;
    std::uint32_t first_pass = 0;
    std::uint64_t first_pixel = 0;
};

class Film {
public:
    /// `accumulated`: the components that samples may hold; only they are allocated. `black`: further ones that the
    /// image shows, because the method can simulate them, though this scene cannot have them.
    Film(int width, int height, const std::vector<Component>& accumulated, const std::vector<Component>& black);

    /// Adds the sample of `pixel` (row-major index) in `pass` (counts from 0). Light in a component that is not
    /// accumulated is a mistake of the plan: std::logic_error.
    void add(std::size_t pixel, std::uint32_t pass, const PixelSample& sample);
    /// The mean over `passes` samples of each pixel.
    ComponentImages mean(std::uint32_t passes) const;
    NonFinite non_finite() const;

private:
    int width_, height_;
    std::array<std::vector<double>, component_count> sums_;
    std::vector<Component> black_;
    mutable std::mutex non_finite_mutex_;
    NonFinite non_finite_;
};

}  // namespace gib
