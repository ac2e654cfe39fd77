#pragma once
// Images on disk: written by OpenEXR, read by OpenImageIO (image_library).

#include "common/images/image.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// An image file as named layers; the layer "" is R,G,B, "direct" is direct.R,direct.G,direct.B.
struct LayeredImage {
    std::vector<std::pair<std::string, Image>> layers;  ///< in the order of the file, all of one size
    std::map<std::string, std::string> metadata;        ///< string attributes

    const Image* find(const std::string& layer) const;
};

/// Writes a one-part float32 EXR with ZIP compression; the file appears whole or not at all. Throws RunError.
void write_exr(const std::string& path, const LayeredImage& image);

/// The same for a file that another process reads at once and that is then removed: uncompressed and not flushed to
/// disk, which is ten times as quick. A crash may leave a part of it.
void write_scratch_exr(const std::string& path, const LayeredImage& image);

/// Reads EXR, PFM, HDR (or whatever OpenImageIO reads) as float; R,G,B or a single grey channel. Throws InputError if
/// the file is missing or is not an image; metadata are the string attributes.
LayeredImage read_image(const std::string& path);

/// The layers of a render: the sum as R,G,B and each component that is there.
LayeredImage layers_of(const ComponentImages& image);
/// The inverse; a file without component layers gives none. The total is the layer "".
ComponentImages components_in(const LayeredImage& image);

/// An 8-bit sRGB PNG in memory, clipped at 1 after multiplication with `exposure`.
std::vector<std::uint8_t> encode_png(const Image& image, float exposure);

}  // namespace gib
