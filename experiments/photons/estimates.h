#pragma once
// The images of a method, for several numbers k of photons in an estimate, beside the light that it stores: what a page says
// the method estimates at a place.

#include "common/reader/scene_file.h"
#include "experiments/measuring/measure.h"
#include "experiments/metrics/reference_image.h"
#include "methods/method.h"

#include <map>
#include <string>
#include <vector>

namespace gib {

struct EstimateWork {
    const LoadedScene& scene;
    const ConfiguredMethod& method;
    std::uint64_t seed = 1;
    std::uint32_t passes;        ///< of each image; a run that converges ends earlier
    bool varies_k = true;        ///< false: only the method's own image is made
    WorkObserver observer = {};  ///< is told of the progress
};

struct Estimates {
    std::vector<std::string> k;                ///< ascending; empty: the method takes no number of photons
    std::size_t own = 0;                       ///< index of the method's own image
    std::vector<ComponentImages> images;       ///< by k; of a method without k its own alone
    std::uint32_t passes = 0;                  ///< of its own image
    std::uint64_t emitted = 0;                 ///< photons emitted for its own image
    std::map<std::string, double> radii = {};  ///< largest radius of a look-up in each map at the start [scene units]
    std::int64_t gather = 0;                   ///< rays in place of look-ups in the global map
};

/// Renders the images, each as `gibench render` does with as many passes: at a quarter of the method's own k, at half of it,
/// at it, and at two and four times as many.
Estimates estimates_of(const EstimateWork& work);

/// The pixels of an image that a page keeps: all, or evenly spaced ones.
struct PixelGrid {
    int width, height;  ///< of the image
    int columns, rows;

    /// At most `most` pixels, 1 or more.
    PixelGrid(int image_width, int image_height, int most);
    std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
    int x(std::size_t i) const { return static_cast<int>(i) % columns * width / columns; }
    int y(std::size_t i) const { return static_cast<int>(i) / columns * height / rows; }
};

}  // namespace gib
