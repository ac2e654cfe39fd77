#pragma once
// What the bench takes from OpenImageIO. It stands in a library of its own (common/openimageio/), which is loaded when
// a scene first reads an image: OpenImageIO brings 240 other libraries along, and a program that loads them starts in
// 0.27 s instead of 0.02 s. Everything else about images is in linear_file and texture_bitmap.

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gib {

/// An open image file, as linear_file.h describes it.
class ImageReader {
public:
    virtual ~ImageReader() = default;
    virtual int width() const = 0;
    virtual int height() const = 0;
    virtual int channels() const = 0;  ///< 1 or 3
    /// Rows [begin, end), interleaved, to `values`. Throws InputError for damaged data. Safe from several threads.
    virtual void read_rows(int begin, int end, float* values) const = 0;
};

/// Image files as square tiles of linear floats in a limited memory. Safe from several threads; all throw RunError for
/// what cannot be read.
class TileCache {
public:
    virtual ~TileCache() = default;

    struct File {
        void* handle;
        int tile_width;  ///< texels from one row of a tile to the next
    };
    /// Throws InputError, as open_image() does.
    virtual File add(const std::string& path, bool raw) = 0;
    /// Whole rows [begin, end) of an image `width` texels wide, interleaved.
    virtual void read_rows(void* file, int width, int begin, int end, float* values) = 0;

    struct Tile {
        void* handle;
        const float* texels;  ///< interleaved; valid until the tile is released
    };
    virtual Tile tile_at(void* file, int x, int y) = 0;
    virtual void release(void* tile) = 0;
};

/// A file as it is stored.
struct StoredImage {
    struct Window {
        int x, y, width, height;
    };
    Window data, display;
    std::vector<std::string> channels;
    std::vector<float> values;                    ///< of the data window, interleaved
    bool srgb;                                    ///< encoded so
    std::map<std::string, std::string> metadata;  ///< string attributes
};

class ImageLibrary {
public:
    virtual ~ImageLibrary() = default;
    /// Throws InputError if the file is missing, is not an image or has several parts.
    virtual StoredImage read_image(const std::string& path) const = 0;
    /// `rgb`: bytes in sRGB, interleaved. Throws RunError.
    virtual std::vector<std::uint8_t> encode_png(int width, int height, const std::vector<std::uint8_t>& rgb) const = 0;
    /// Throws InputError, as LinearFile says.
    virtual std::unique_ptr<ImageReader> open_image(const std::string& path, bool raw) const = 0;
    virtual std::unique_ptr<TileCache> tile_cache(double megabytes, int tile_size) const = 0;
};

/// Loaded by the first call. Throws RunError if it cannot be.
const ImageLibrary& image_library();

/// What the library exports under this name.
inline constexpr const char* image_library_entry = "gib_image_library";
using ImageLibraryEntry = const ImageLibrary*();

}  // namespace gib
