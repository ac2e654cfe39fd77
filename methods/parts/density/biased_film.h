#pragma once
// A film for samples that know an estimate of their bias.

#include "common/images/film.h"

namespace gib {

/// One sample of a pixel by component [W/(sr m^2)].
struct BiasedSample {
    PixelSample light;
    PixelSample bias;  ///< an estimate of how far the expected value of `light` lies above the truth
};

class BiasedFilm {
public:
    /// As for Film. `blurred` are the components that may have a bias.
    BiasedFilm(int width, int height, const std::vector<Component>& accumulated, const std::vector<Component>& black,
               const std::vector<Component>& blurred)
        : light_(width, height, accumulated, black), bias_(width, height, blurred, {}) {}

    void add(std::size_t pixel, std::uint32_t pass, const BiasedSample& sample) {
        light_.add(pixel, pass, sample.light);
        bias_.add(pixel, pass, sample.bias);
    }
    ComponentImages mean(std::uint32_t passes) const {
        ComponentImages images = light_.mean(passes);
        images.bias = bias_.mean(passes).parts;
        return images;
    }
    /// Counts the samples of light alone: the bias is made of the same terms, and where it is not finite, neither is the
    /// light.
    NonFinite non_finite() const { return light_.non_finite(); }

private:
    Film light_, bias_;
};

}  // namespace gib
