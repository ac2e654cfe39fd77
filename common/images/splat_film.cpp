#include "common/images/splat_film.h"

#include "common/core/memory_limit.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace gib {

namespace {

constexpr double largest = 0x1p62;  ///< limit of the magnitude of one addition [units]

}  // namespace

FixedPointImage::FixedPointImage(int width, int height, double unit) : width_(width), height_(height), unit_(unit) {
    const auto values = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3;
    require_memory(static_cast<double>(sizeof(Sum) * values),
                   fmt::format("a film of light paths of {} x {} pixels", width, height));
    sums_ = std::vector<Sum>(values);
}

void FixedPointImage::Sum::add(double units) {
    double floor = std::floor(units), rest = units - floor;
    if (rest >= 1) {  // by rounding, just below a whole number
        floor += 1;
        rest = 0;
    }
    const auto low = static_cast<std::uint64_t>(rest * 0x1p64);
    auto high = static_cast<std::uint64_t>(static_cast<std::int64_t>(floor));
    if (low != 0 && fraction.fetch_add(low, std::memory_order_relaxed) + low < low) ++high;  // the carry
    if (high != 0) whole.fetch_add(high, std::memory_order_relaxed);
}

double FixedPointImage::Sum::units() const {
    return static_cast<double>(static_cast<std::int64_t>(whole.load())) +
           static_cast<double>(fraction.load()) * 0x1p-64;
}

bool FixedPointImage::holds(const Color& value) const { return ((value.cast<double>() / unit_).abs() < largest).all(); }

void FixedPointImage::add(std::size_t pixel, const Color& value) {
    for (std::size_t k = 0; k < 3; ++k)
        sums_[3 * pixel + k].add(double{value[static_cast<Eigen::Index>(k)]} / unit_);
}

Image FixedPointImage::mean(double count) const {
    Image image(width_, height_);
    for (std::size_t i = 0; i < sums_.size(); ++i)
        image.rgb[i] = static_cast<float>(sums_[i].units() * (unit_ / count));
    return image;
}

SplatFilm::SplatFilm(int width, int height, const std::vector<Component>& accumulated, double unit) {
    for (Component c : accumulated)
        sums_[static_cast<std::size_t>(index_of(c))] = FixedPointImage(width, height, unit);
}

void SplatFilm::add(std::size_t pixel, std::uint32_t pass, const PixelSample& light) {
    for (std::size_t c = 0; c < sums_.size(); ++c) {
        if (is_black(light.parts[c])) continue;
        if (!sums_[c].holds(light.parts[c])) return non_finite_.note(pass, pixel);
        if (sums_[c].empty()) throw std::logic_error("a light path has light of a component that the plan left out");
    }
    for (std::size_t c = 0; c < sums_.size(); ++c)
        if (!is_black(light.parts[c])) sums_[c].add(pixel, light.parts[c]);
}

void SplatFilm::add_mean(double count, ComponentImages& images) const {
    for (std::size_t c = 0; c < sums_.size(); ++c) {
        if (sums_[c].empty()) continue;
        const Image mean = sums_[c].mean(count);
        for (std::size_t i = 0; i < mean.rgb.size(); ++i)
            images.parts[c]->rgb[i] += mean.rgb[i];
    }
}

NonFinite SplatFilm::non_finite() const { return non_finite_.value(); }

}  // namespace gib
