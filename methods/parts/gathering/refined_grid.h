#pragma once
// The pixels that the overture looks at: a grid of equal steps, along and across, which is refined where that may find
// something new. A pixel is settled if the cache serves what its path has reached and what lies half a step around it. A
// finer grid leaves out the pixels among settled ones.

#include <cstddef>
#include <vector>

namespace gib {

class RefinedGrid {
public:
    RefinedGrid(std::size_t width, std::size_t height) : width_(width), height_(height), settled_(width * height, 0) {}

    std::size_t width() const { return width_; }
    std::size_t height() const { return height_; }
    /// The distance of the grid's pixels [pixels].
    std::size_t step() const { return step_; }

    /// Whether the pixel is one that this grid adds to the coarser ones and that does not lie among settled ones.
    bool looks_at(std::size_t x, std::size_t y) const {
        return x % step_ == 0 && y % step_ == 0 && !is_coarser(x, y) && !settled_[y * width_ + x];
    }
    /// Whether the next grid leaves out pixels among settled ones. Between the pixels of the coarser grids there may be
    /// small objects that no path has reached, so that these are refined as a whole.
    bool next_leaves_out() const { return step_ <= finest_whole && step_ > 1; }
    /// Sets whether the pixel y width + x is settled. Different pixels may be set at the same time.
    void settle(std::size_t pixel, bool is_settled) { settled_[pixel] = is_settled ? 1 : 0; }

    /// Goes on to half the step; the pixels of the finer grid that lie among settled ones become settled themselves.
    /// False after the finest grid.
    bool refine() {
        const bool leaves_out = next_leaves_out();
        step_ /= 2;
        if (!leaves_out) return step_ > 0;
        for (std::size_t y = 0; y < height_; y += step_)
            for (std::size_t x = 0; x < width_; x += step_)
                if (!is_coarser(x, y)) settle(y * width_ + x, is_among_settled(x, y));
        return true;
    }

private:
    static constexpr std::size_t coarsest = 32, finest_whole = 4;

    bool is_coarser(std::size_t x, std::size_t y) const {
        return step_ < coarsest && x % (2 * step_) == 0 && y % (2 * step_) == 0;
    }
    /// Whether the pixels of the coarser grid around this one are all there and settled.
    bool is_among_settled(std::size_t x, std::size_t y) const {
        const std::size_t coarse = 2 * step_;
        const std::size_t left = x / coarse * coarse, right = x == left ? left : left + coarse;
        const std::size_t top = y / coarse * coarse, bottom = y == top ? top : top + coarse;
        if (right >= width_ || bottom >= height_) return false;
        const auto is_settled = [&](std::size_t column, std::size_t row) {
            return settled_[row * width_ + column] != 0;
        };
        return is_settled(left, top) && is_settled(right, top) && is_settled(left, bottom) && is_settled(right, bottom);
    }

    std::size_t width_, height_, step_ = coarsest;
    std::vector<char> settled_;
};

}  // namespace gib
