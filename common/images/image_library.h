#pragma once
// The interface to OpenImageIO. It is implemented by a library of its own (common/openimageio/), which is loaded when
// an image is first read: OpenImageIO brings 240 other libraries along, and a program that loads them starts in
// 0.27 s instead of 0.02 s. All other code about image files is in texture_bitmap and image_file.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gib {

/// An image as linear floats, see ImageLibrary::read_linear().
struct LinearImage {
    int width, height, channels;  ///< channels: 1 or 3
    std::vector<float> values;    ///< height x width x channels, row 0 on top
};

/// The content of an image file as it is stored, before any decoding.
struct StoredImage {
    struct Window {
        int x, y, width, height;
    };
    Window data, display;
    std::vector<std::string> channels;
    std::vector<float> values;                    ///< of the data window, interleaved
    bool srgb;                                    ///< whether the values are encoded in sRGB
    std::map<std::string, std::string> metadata;  ///< string attributes
};

class ImageLibrary {
public:
    virtual ~ImageLibrary() = default;
    /// Throws InputError if the file is missing, is not an image or has several parts.
    virtual StoredImage read_image(const std::string& path) const = 0;
    /// A PNG file in memory. `rgb` holds height x width x 3 bytes in sRGB, row 0 on top. Throws RunError.
    virtual std::vector<std::uint8_t> encode_png(int width, int height, const std::vector<std::uint8_t>& rgb) const = 0;
    /// Reads an image file with one grey channel or with R, G and B. Alpha and other channels are left out, and colours
    /// are never multiplied by alpha. By Mitsuba's rule, 8- and 16-bit integers are decoded as sRGB whatever the file
    /// says, and floats are linear; if `raw` is true, integers become fractions of their range. The image is the file's
    /// data window. Throws InputError with the file's name if the file is missing, is not an image, is damaged, has
    /// several parts, subsampled colour, primaries other than sRGB's or a value that is not finite.
    virtual LinearImage read_linear(const std::string& path, bool raw) const = 0;
};

/// The library, which the first call loads. Throws RunError if it cannot be loaded.
const ImageLibrary& image_library();

/// The name and the type of the function that the library exports.
inline constexpr const char* image_library_entry = "gib_image_library";
using ImageLibraryEntry = const ImageLibrary*();

}  // namespace gib
