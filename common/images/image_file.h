#pragma once
// Images on disk. OpenEXR writes them; OpenImageIO reads them (image_library.h).

#include "common/core/files.h"
#include "common/images/image.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// An image file as named layers; the layer "" is R,G,B, "direct" is direct.R,direct.G,direct.B.
struct LayeredImage {
    std::vector<std::pair<std::string, Image>> layers;  ///< in the order of the file, all of one size
    std::map<std::string, std::string> metadata;        ///< string attributes

    /// The layer of that name; null if there is none.
    const Image* find(const std::string& layer) const;
};

/// Writes a one-part float32 EXR, compressed by run lengths without loss, or not at all with Flush::later, which is for a
/// user who waits; the file appears whole or not at all. Throws RunError.
void write_exr(const std::string& path, const LayeredImage& image, Flush flush = Flush::now);

/// Writes an EXR file that another process reads at once and that is then removed. The file is uncompressed and not
/// flushed to disk, which is ten times as fast; a crash may leave a part of it. Throws RunError.
void write_scratch_exr(const std::string& path, const LayeredImage& image);

/// Reads EXR, PFM, HDR or any other format that OpenImageIO reads, as float. A layer is R,G,B or a single grey
/// channel; the metadata are the string attributes. Throws InputError if the file is missing or is not an image.
LayeredImage read_image(const std::string& path);

/// The string attributes of an EXR file. Only the header is read; empty if there is no such file or if it is
/// not an EXR file.
std::optional<std::map<std::string, std::string>> exr_attributes(const std::string& path);

/// The name of the layer that holds the estimated bias of a component's layer.
std::string bias_layer_of(std::string_view layer);
/// The layers of a render: the sum of its components as R,G,B (layer ""), each component that is present, and the
/// estimated bias of the sum ("bias") and of components.
LayeredImage layers_of(ComponentImages image);
/// The inverse of layers_of(): the component layers of a file. The layer "", the sum, is left out; a file without
/// component layers gives no component.
ComponentImages components_in(const LayeredImage& image);

/// An 8-bit sRGB PNG file in memory. Values are multiplied by `exposure` and clipped at 1. Throws RunError.
std::vector<std::uint8_t> encode_png(const Image& image, float exposure);

}  // namespace gib
