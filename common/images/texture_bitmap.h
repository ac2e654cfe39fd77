#pragma once
// The texels of image files, in OpenImageIO's tile cache. Small images stay in memory; large ones are paged.

#include "common/core/math.h"

#include <memory>
#include <string>
#include <vector>

namespace gib {

class ImageReader;
class TileCache;

/// The memory that the bitmaps of one scene share.
class TextureCache {
public:
    explicit TextureCache(double megabytes = 1024);
    ~TextureCache();
    TextureCache(const TextureCache&) = delete;
    TextureCache& operator=(const TextureCache&) = delete;

private:
    friend class Bitmap;
    struct Tiles;
    std::unique_ptr<Tiles> tiles_;
};

/// An image of linear colours or greys. Safe to read from several threads.
class Bitmap {
public:
    /// Opens a file; `raw` and `channel` as for ImageLibrary::open_image(). Throws InputError with the file's name if
    /// open_image() refuses the file or a value is not finite.
    Bitmap(std::shared_ptr<TextureCache> cache, const std::string& path, bool raw, const std::string& channel = {});
    ~Bitmap();
    Bitmap(const Bitmap&) = delete;
    Bitmap& operator=(const Bitmap&) = delete;

    int width() const { return width_; }
    int height() const { return height_; }
    bool grey() const { return channels_ == 1; }
    /// Whether the image does not stay in memory, so that look-ups may read the file.
    bool paged() const { return resident_.empty(); }
    /// The texel in column x and row y, row 0 on top. Throws RunError if the file has disappeared since it was opened.
    Color texel(int x, int y) const {
        return paged() ? paged_texel(x, y) : color_at(resident_[tile_index(x, y)] + offset_in_tile(x, y));
    }
    /// Mean, minimum and maximum of each channel over all texels.
    const Color& mean() const { return mean_; }
    const Color& minimum() const { return minimum_; }
    const Color& maximum() const { return maximum_; }

    static constexpr int tile_size = 128;  ///< texels a side

private:
    static constexpr int tile_shift = 7;
    static_assert(1 << tile_shift == tile_size);

    std::size_t tile_index(int x, int y) const {
        return static_cast<std::size_t>((y >> tile_shift) * tiles_across_ + (x >> tile_shift));
    }
    std::size_t offset_in_tile(int x, int y) const {
        const int column = x & (tile_size - 1), row = y & (tile_size - 1);
        return static_cast<std::size_t>((row * tile_width_ + column) * channels_);
    }
    Color color_at(const float* texel) const {
        return channels_ == 1 ? Color(Color::Constant(*texel)) : Color(texel[0], texel[1], texel[2]);
    }
    Color paged_texel(int x, int y) const;
    void measure(const ImageReader& file, const std::string& path);
    void keep_in_memory();
    TileCache& files() const;

    std::shared_ptr<TextureCache> cache_;
    void* file_;  ///< its handle in the cache
    int width_, height_, channels_;
    int tile_width_, tiles_across_;
    std::vector<void*> held_;             ///< the tiles that stay in memory
    std::vector<const float*> resident_;  ///< their texels; empty: the image is paged
    Color mean_, minimum_, maximum_;
};

}  // namespace gib
