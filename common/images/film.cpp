#include "common/images/film.h"

#include "common/core/memory_limit.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <stdexcept>

namespace gib {

namespace {

/// Whether all numbers are finite, by their exponents: one branch for all of them.
bool is_finite(const PixelSample& sample) {
    constexpr std::uint32_t exponent = 0x7f800000u;
    bool all = true;
    for (const Color& part : sample.parts)
        for (int k = 0; k < 3; ++k)
            all &= (std::bit_cast<std::uint32_t>(part[k]) & exponent) != exponent;
    return all;
}

}  // namespace

Film::Film(int width, int height, const std::vector<Component>& accumulated, const std::vector<Component>& black)
    : width_(width), height_(height), black_(black) {
    const auto summed = static_cast<double>(accumulated.size());
    const double shown = summed + static_cast<double>(black.size());
    // A value needs memory for its sum in double, for the image in float, and for the layers and their total.
    const double of_a_value = sizeof(double) * summed + sizeof(float) * (2 * shown + 1);
    require_memory(3.0 * width * height * of_a_value, fmt::format("a film of {} x {} pixels", width, height));
    for (Component c : accumulated)
        sums_[static_cast<std::size_t>(index_of(c))].assign(
            static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3, 0.0);
}

void Film::add(std::size_t pixel, std::uint32_t pass, const PixelSample& sample) {
    if (!is_finite(sample)) return non_finite_.note(pass, pixel);
    for (std::size_t c = 0; c < sums_.size(); ++c) {
        if (is_black(sample.parts[c])) continue;
        if (sums_[c].empty()) throw std::logic_error("a sample holds light of a component that the plan left out");
        for (std::size_t k = 0; k < 3; ++k)
            sums_[c][3 * pixel + k] += static_cast<double>(sample.parts[c][static_cast<Eigen::Index>(k)]);
    }
}

ComponentImages Film::mean(std::uint64_t samples) const {
    const auto count = static_cast<double>(samples);
    ComponentImages images;
    images.width = width_;
    images.height = height_;
    for (Component c : black_)
        images[c] = Image(width_, height_);
    for (std::size_t c = 0; c < sums_.size(); ++c) {
        if (sums_[c].empty()) continue;
        Image image(width_, height_);
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            image.rgb[i] = static_cast<float>(sums_[c][i] / count);
        images.parts[c] = std::move(image);
    }
    return images;
}

NonFinite Film::non_finite() const { return non_finite_.value(); }

}  // namespace gib
