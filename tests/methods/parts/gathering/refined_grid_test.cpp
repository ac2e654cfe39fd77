// The grid of pixels that fills the irradiance cache.
#include "methods/parts/gathering/refined_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace gib::refined_grid_test {
namespace {

/// How often each pixel was looked at, if looks settle the pixels for which `is_served` holds.
std::vector<int> looks(std::size_t width, std::size_t height,
                       const std::function<bool(std::size_t x, std::size_t y)>& is_served) {
    RefinedGrid grid(width, height);
    std::vector<int> count(width * height, 0);
    do {
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                if (!grid.looks_at(x, y)) continue;
                ++count[y * width + x];
                grid.settle(y * width + x, is_served(x, y));
            }
    } while (grid.refine());
    return count;
}

TEST(RefinedGrid, LooksOnceAtEachPixelIfNothingIsServed) {
    const auto count = looks(50, 37, [](std::size_t, std::size_t) { return false; });
    EXPECT_EQ(count, std::vector<int>(count.size(), 1));
}

// If the last row and column of the image lie on the grid of step 4, only that grid and the coarser ones are looked at.
// Beyond it the grid of step 2 looks at what the coarser one does not surround.
TEST(RefinedGrid, LooksAtEveryFourthPixelIfAllAreServed) {
    const auto all = [](std::size_t, std::size_t) { return true; };
    const auto count = looks(65, 33, all), wider = looks(67, 33, all);
    for (std::size_t y = 0; y < 33; ++y)
        for (std::size_t x = 0; x < 67; ++x) {
            const int expected = x % 4 == 0 && y % 4 == 0 ? 1 : 0;
            if (x < 65) {
                EXPECT_EQ(count[y * 65 + x], expected) << x << ' ' << y;
            }
            EXPECT_EQ(wider[y * 67 + x], x == 66 && y % 2 == 0 ? 1 : expected) << x << ' ' << y;
        }
}

TEST(RefinedGrid, LooksAtEachPixelAroundOneThatIsNotServed) {
    const auto count = looks(65, 65, [](std::size_t x, std::size_t y) { return x != 32 || y != 32; });
    for (std::size_t y = 0; y < 65; ++y)
        for (std::size_t x = 0; x < 65; ++x) {
            // At step 2 the pixels up to 2 away have (32, 32) as a corner of their cell. They are served, so at step 1
            // only the pixels beside (32, 32) have a corner that is not.
            const bool at_two = x % 2 == 0 && y % 2 == 0 && x > 29 && x < 35 && y > 29 && y < 35;
            const bool at_one = x > 30 && x < 34 && y > 30 && y < 34;
            EXPECT_EQ(count[y * 65 + x], (x % 4 == 0 && y % 4 == 0) || at_two || at_one ? 1 : 0) << x << ' ' << y;
        }
}

}  // namespace
}  // namespace gib::refined_grid_test
