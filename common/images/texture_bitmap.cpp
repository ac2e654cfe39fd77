#include "common/images/texture_bitmap.h"

#include "common/core/memory_limit.h"
#include "common/core/reject.h"
#include "common/images/image_library.h"

#include <fmt/format.h>
#include <algorithm>
#include <atomic>
#include <cstdint>

namespace gib {

struct TextureCache::Tiles {
    std::unique_ptr<TileCache> files;
    std::atomic<std::int64_t> resident_bytes;  ///< the bytes that bitmaps may still keep in memory
};

TextureCache::TextureCache(double megabytes) : tiles_(std::make_unique<Tiles>()) {
    tiles_->files = image_library().tile_cache(megabytes, Bitmap::tile_size);
    // The remaining quarter is for the images that are paged.
    tiles_->resident_bytes = static_cast<std::int64_t>(0.75 * 1024 * 1024 * megabytes);
}

TextureCache::~TextureCache() = default;

TileCache& Bitmap::files() const { return *cache_->tiles_->files; }

Bitmap::Bitmap(std::shared_ptr<TextureCache> cache, const std::string& path, bool raw, const std::string& channel)
    : cache_(std::move(cache)) {
    const auto reader = image_library().open_image(path, raw, channel);
    const ImageReader& file = *reader;
    width_ = file.width();
    height_ = file.height();
    channels_ = file.channels();
    tiles_across_ = (width_ + tile_size - 1) / tile_size;
    const TileCache::File added = files().add(path, raw, channel);
    file_ = added.handle;
    tile_width_ = added.tile_width;
    measure(file, path);
    keep_in_memory();
}

Bitmap::~Bitmap() {
    for (void* held : held_)
        files().release(held);
}

/// Computes mean, minimum and maximum. Rows are read in the file's order, so that the cache never seeks backwards
/// while it fills.
void Bitmap::measure(const ImageReader& file, const std::string& path) {
    // A damaged header may announce rows that do not fit into memory.
    require_memory(1.0 * sizeof(float) * width_ * tile_size * channels_,
                   fmt::format("a texture of {} x {} pixels", width_, height_), {path, 0, 0});
    std::vector<float> values(static_cast<std::size_t>(width_) * tile_size * static_cast<std::size_t>(channels_));
    Colord sum = Colord::Zero();
    minimum_ = Color::Constant(infinity);
    maximum_ = Color::Constant(-infinity);
    for (int y = 0; y < height_; y += tile_size) {
        const int end = std::min(y + tile_size, height_);
        try {
            files().read_rows(file_, width_, y, end, values.data());
        } catch (const RunError& error) {
            file.read_rows(y, end, values.data());  // throws the error without the cache's words
            throw InputError({path, 0, 0}, error.what());
        }
        const int count = (end - y) * width_;
        for (int i = 0; i < count; ++i) {
            const Color c = color_at(values.data() + i * channels_);
            if (!c.isFinite().all())
                reject({path, 0, 0}, "the pixel in column {}, row {} is not finite", i % width_, y + i / width_);
            sum += c.cast<double>();
            minimum_ = minimum_.min(c);
            maximum_ = maximum_.max(c);
        }
    }
    mean_ = (sum / (static_cast<double>(width_) * height_)).cast<float>();
}

void Bitmap::keep_in_memory() {
    const int tiles_down = (height_ + tile_size - 1) / tile_size;
    const std::int64_t bytes = std::int64_t{tiles_across_} * tiles_down * tile_size * tile_size * channels_ *
                               static_cast<std::int64_t>(sizeof(float));
    auto& available = cache_->tiles_->resident_bytes;
    if (available.fetch_sub(bytes) < bytes) {
        available += bytes;
        return;
    }
    for (int y = 0; y < height_; y += tile_size)
        for (int x = 0; x < width_; x += tile_size) {
            const TileCache::Tile tile = files().tile_at(file_, x, y);
            held_.push_back(tile.handle);
            resident_.push_back(tile.texels);
        }
}

Color Bitmap::paged_texel(int x, int y) const {
    const TileCache::Tile tile = files().tile_at(file_, x, y);
    const Color c = color_at(tile.texels + offset_in_tile(x, y));
    files().release(tile.handle);
    return c;
}

}  // namespace gib
