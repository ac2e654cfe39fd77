#pragma once
// Images as planes with margins, in which filters need no special case at borders.

#include "common/images/image.h"

#include <cstddef>
#include <vector>

namespace gib {

/// Single channels of an image, with a margin that mirrors it.
class MirroredPlanes {
public:
    MirroredPlanes(int width, int height, int margin, std::size_t count)
        : width_(width), height_(height), margin_(margin), stride_(width + 2 * margin), planes_(count) {
        for (auto& plane : planes_)
            plane.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height + 2 * margin), 0.f);
    }
    std::size_t count() const { return planes_.size(); }
    int width() const { return width_; }
    int height() const { return height_; }
    /// The values of row y from column 0 on; margins have negative indices.
    const float* row(std::size_t plane, int y) const { return planes_[plane].data() + start_of(y); }
    float* row(std::size_t plane, int y) { return planes_[plane].data() + start_of(y); }

    /// Sets a plane to value_of(x, y) within the image and its mirror images around.
    template <typename ValueOf>
    void fill(std::size_t plane, ValueOf&& value_of) {
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                row(plane, y)[x] = value_of(x, y);
        for (int y = -margin_; y < height_ + margin_; ++y)
            for (int x = -margin_; x < width_ + margin_; ++x)
                if (y < 0 || y >= height_ || x < 0 || x >= width_)
                    row(plane, y)[x] = row(plane, mirrored(y, height_))[mirrored(x, width_)];
    }
    void fill(std::size_t plane, const Image& image, int channel, float scale = 1.f) {
        fill(plane, [&](int x, int y) {
            return scale * image.rgb[static_cast<std::size_t>(3 * (y * image.width + x) + channel)];
        });
    }

    /// The mean over a square around (x, y), whose radius is at most the margin.
    float mean_around(std::size_t plane, int x, int y, int radius) const {
        float sum = 0;
        for (int j = y - radius; j <= y + radius; ++j)
            for (int i = x - radius; i <= x + radius; ++i)
                sum += row(plane, j)[i];
        return sum / static_cast<float>((2 * radius + 1) * (2 * radius + 1));
    }

private:
    static int mirrored(int i, int n) {
        const int at = (i % (2 * n) + 2 * n) % (2 * n);
        return at < n ? at : 2 * n - 1 - at;
    }
    std::ptrdiff_t start_of(int y) const { return std::ptrdiff_t{y + margin_} * stride_ + margin_; }

    int width_, height_, margin_, stride_;
    std::vector<std::vector<float>> planes_;
};

}  // namespace gib
