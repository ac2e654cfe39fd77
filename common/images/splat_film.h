#pragma once
// A film for light that arrives in any pixel from any thread. Sums are in fixed point, so that they do not depend on
// the order of the additions.

#include "common/images/film.h"

#include <atomic>
#include <cstdint>
#include <vector>

namespace gib {

/// An image to which all threads may add. Sums are multiples of 2^-64 `unit`, and are exact up to 2^62 `unit`; a unit
/// near the image's mean therefore leaves room for both dim pixels and bright samples.
class FixedPointImage {
public:
    FixedPointImage() = default;
    /// Throws InputError if there is not enough memory.
    FixedPointImage(int width, int height, double unit);

    bool empty() const { return sums_.empty(); }
    /// Whether add() can hold the value: it is finite and not too large.
    bool holds(const Color& value) const;
    void add(std::size_t pixel, const Color& value);
    /// Fetches what add() will need.
    void prefetch(std::size_t pixel) const {
        if (empty()) return;
        __builtin_prefetch(&sums_[3 * pixel], 1);
        __builtin_prefetch(&sums_[3 * pixel + 2], 1);
    }
    /// The sums divided by `count`.
    Image mean(double count) const;

private:
    struct Sum {
        std::atomic<std::uint64_t> fraction = 0;  ///< [2^-64 unit]
        std::atomic<std::uint64_t> whole = 0;     ///< [unit], in two's complement

        void add(double units);
        double units() const;
    };

    int width_ = 0, height_ = 0;
    double unit_ = 1;
    std::vector<Sum> sums_;
};

class SplatFilm {
public:
    /// Components as for Film, the unit as for FixedPointImage. Throws InputError if there is not enough memory.
    SplatFilm(int width, int height, const std::vector<Component>& accumulated, double unit);

    /// Adds light to a pixel. Light that is not finite, or larger than the sums hold, is counted and dropped. Throws
    /// std::logic_error for light in a component that is not accumulated.
    void add(std::size_t pixel, std::uint32_t pass, const PixelSample& light);
    /// Fetches what add() will need, long before it is called: sums in memory take longer than all else there.
    void prefetch(std::size_t pixel, Component component) const {
        sums_[static_cast<std::size_t>(index_of(component))].prefetch(pixel);
    }
    /// Adds the sums divided by `count` to the images.
    void add_mean(double count, ComponentImages& images) const;
    NonFinite non_finite() const;

private:
    std::array<FixedPointImage, component_count> sums_;
    NonFiniteCount non_finite_;
};

}  // namespace gib
