#pragma once
// The interface to OpenImageIO. It is implemented by a library of its own (common/openimageio/), which is loaded when
// an image is first read: OpenImageIO brings 240 other libraries along, and a program that loads them starts in
// 0.27 s instead of 0.02 s. All other code about image files is in linear_file, texture_bitmap and image_file.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gib {

/// An open image file that is read as linear floats, see ImageLibrary::open_image().
class ImageReader {
public:
    virtual ~ImageReader() = default;
    virtual int width() const = 0;
    virtual int height() const = 0;
    virtual int channels() const = 0;  ///< 1 or 3
    /// Writes rows [begin, end) to `values`: (end - begin) x width x channels, interleaved. Throws InputError if the
    /// data are damaged. Several threads may call this function.
    virtual void read_rows(int begin, int end, float* values) const = 0;
};

/// Holds image files as square tiles of linear floats in a limited memory. Several threads may call its functions.
/// Unless stated otherwise, they throw RunError if a file cannot be read.
class TileCache {
public:
    virtual ~TileCache() = default;

    struct File {
        void* handle;
        int tile_width;  ///< texels from one row of a tile to the next
    };
    /// Adds a file; `raw` and `channel` as for ImageLibrary::open_image(). Throws InputError as open_image() does.
    virtual File add(const std::string& path, bool raw, const std::string& channel) = 0;
    /// Writes the whole rows [begin, end) of an image that is `width` texels wide to `values`, interleaved.
    virtual void read_rows(void* file, int width, int begin, int end, float* values) = 0;

    struct Tile {
        void* handle;
        const float* texels;  ///< interleaved; valid until the tile is released
    };
    /// The tile that holds texel (x, y). It stays in memory until release() is called with its handle.
    virtual Tile tile_at(void* file, int x, int y) = 0;
    virtual void release(void* tile) = 0;
};

/// The content of an image file as it is stored, before any decoding.
struct StoredImage {
    struct Window {
        int x, y, width, height;
    };
    Window data, display;
    std::vector<std::string> channels;
    std::vector<float> values;                    ///< values of the data window, channels interleaved
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
    /// Opens an image file with one grey channel or with R, G and B. Alpha and other channels are left out, and colours
    /// are never multiplied by alpha. By Mitsuba's rule, 8- and 16-bit integers are decoded as sRGB whatever the file
    /// says, and floats are linear; if `raw` is true, integers become fractions of their range. The image is the file's
    /// data window. If `channel` is not empty, the channel of this name, in capitals or not, is read as the grey one; "a"
    /// or "A" is never decoded. Throws InputError with the file's name if the file is missing, is not an image, has several
    /// parts, subsampled colour, primaries other than sRGB's or no such channel.
    virtual std::unique_ptr<ImageReader> open_image(const std::string& path, bool raw,
                                                    const std::string& channel = {}) const = 0;
    /// A cache of `megabytes` MB, whose tiles have `tile_size` texels a side.
    virtual std::unique_ptr<TileCache> tile_cache(double megabytes, int tile_size) const = 0;
};

/// The library, which the first call loads. Throws RunError if it cannot be loaded.
const ImageLibrary& image_library();

/// The name and the type of the function that the library exports.
inline constexpr const char* image_library_entry = "gib_image_library";
using ImageLibraryEntry = const ImageLibrary*();

}  // namespace gib
