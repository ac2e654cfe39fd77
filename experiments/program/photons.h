#pragma once
// `gibench photons`: writes the page that shows the light that a method stores.

#include "common/reader/scene_file.h"

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>

namespace gib {

struct PhotonsOptions {
    std::string scene;
    std::string method;  ///< label
    std::uint64_t seed = 1;
    int threads = 0;
    SceneLoadOptions loading;
    std::size_t most_photons = 200000;  ///< number of photons shown
    std::optional<std::uint32_t>
        passes;             ///< limit on passes; none: that of the label or the scene, but at most default_passes
    std::string reference;  ///< file; empty: the page tells no truth
    std::string out;
};
/// Passes of a method that stores other light in each, and of an image beside light that stays.
inline constexpr std::uint32_t default_passes = 16, default_image_passes = 4, most_passes_shown = 255;
inline constexpr std::size_t most_photons_shown = 5000000;

/// Writes the page and prints what it shows of how much. Returns 0. Throws InputError if the method stores no light.
int show_photons(const PhotonsOptions& options, std::ostream& out);

}  // namespace gib
