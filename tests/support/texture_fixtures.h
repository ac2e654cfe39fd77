#pragma once
// Writes image files of every kind that textures are read from.

#include "tests/support/scene_text.h"

#include <OpenImageIO/imageio.h>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace gib::test {

struct FileFormat {
    OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT;  ///< stored type; integers store fractions of their range
    int tile = 0;                                 ///< [texels a side]; 0: stored in rows
    std::vector<std::string> channels;            ///< their names; empty: the file format's own
    std::vector<float> chromaticities;
};

/// Writes `values` (height x width x channels) without multiplying them by alpha, and returns the path. The path's
/// ending chooses the file format.
inline std::string write_image(const std::string& path, int width, int height, int channels,
                               const std::vector<float>& values, const FileFormat& format = {}) {
    OIIO::ImageSpec spec(width, height, channels, format.type);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (path.ends_with(".exr")) spec.attribute("compression", "none");
    if (!format.channels.empty()) spec.channelnames = format.channels;
    if (!format.chromaticities.empty())
        spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), format.chromaticities.data());
    if (format.tile > 0) spec.tile_width = spec.tile_height = format.tile;
    const auto file = OIIO::ImageOutput::create(path);
    EXPECT_TRUE(file && file->open(path, spec)) << path << ": " << OIIO::geterror();
    EXPECT_TRUE(file->write_image(OIIO::TypeDesc::FLOAT, values.data())) << path << ": " << file->geterror();
    EXPECT_TRUE(file->close());
    return path;
}

/// Values in [0, 1), no two alike.
inline std::vector<float> random_values(int width, int height, int channels, unsigned seed = 1) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform;
    std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                              static_cast<std::size_t>(channels));
    for (float& v : values)
        v = uniform(generator);
    return values;
}

/// The fraction in [0, 1] that an 8-bit value stands for.
inline float byte(int value) { return static_cast<float>(value) / 255; }

}  // namespace gib::test
