#include "common/texture_bitmap.h"

#include "common/error.h"
#include "common/linear_file.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <algorithm>
#include <atomic>
#include <cstdint>

namespace gib {

namespace {

/// What the cache reads: linear floats instead of the file's encoding, so that filtering comes after decoding.
class LinearInput final : public OIIO::ImageInput {
public:
    static OIIO::ImageInput* create() { return new LinearInput; }
    const char* format_name() const override { return "gibench-linear"; }
    int supports(OIIO::string_view feature) const override { return feature == "procedural"; }
    bool open(const std::string& name, OIIO::ImageSpec& spec) override { return open(name, spec, {}); }
    bool open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override {
        return reported([&] {
            file_ = std::make_unique<LinearFile>(config.get_string_attribute("gib:path"),
                                                 config.get_int_attribute("gib:raw") != 0);
            m_spec = OIIO::ImageSpec(file_->width(), file_->height(), file_->channels(), OIIO::TypeDesc::FLOAT);
            spec = m_spec;
        });
    }
    bool close() override {
        file_.reset();
        return true;
    }
    bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
        return read_native_scanlines(subimage, miplevel, y, y + 1, z, data);
    }
    bool read_native_scanlines(int subimage, int miplevel, int begin, int end, int, void* data) override {
        if (subimage != 0 || miplevel != 0) return false;
        return reported([&] { file_->read_rows(begin, end, static_cast<float*>(data)); });
    }

private:
    template <typename F>
    bool reported(F&& read) {
        try {
            read();
            return true;
        } catch (const std::exception& e) {
            errorfmt("{}", e.what());
            return false;
        }
    }
    std::unique_ptr<LinearFile> file_;
};

OIIO::ImageCache::ImageHandle* image(void* handle) { return static_cast<OIIO::ImageCache::ImageHandle*>(handle); }
OIIO::ImageCache::Tile* tile(void* handle) { return static_cast<OIIO::ImageCache::Tile*>(handle); }

}  // namespace

struct TextureCache::Tiles {
    OIIO::ImageCache* cache = OIIO::ImageCache::create(false);
    std::atomic<std::int64_t> resident_bytes;  ///< what bitmaps may still keep for good
};

TextureCache::TextureCache(double megabytes) : tiles_(std::make_unique<Tiles>()) {
    tiles_->cache->attribute("max_memory_MB", static_cast<float>(megabytes));
    tiles_->cache->attribute("autotile", Bitmap::tile_size);
    tiles_->cache->attribute("automip", 0);
    // The rest is for the images that are paged.
    tiles_->resident_bytes = static_cast<std::int64_t>(0.75 * 1024 * 1024 * megabytes);
}

TextureCache::~TextureCache() { OIIO::ImageCache::destroy(tiles_->cache); }

Bitmap::Bitmap(std::shared_ptr<TextureCache> cache, const std::string& path, bool raw) : cache_(std::move(cache)) {
    const LinearFile file(path, raw);
    width_ = file.width();
    height_ = file.height();
    channels_ = file.channels();
    tiles_across_ = (width_ + tile_size - 1) / tile_size;
    OIIO::ImageCache& images = *cache_->tiles_->cache;
    OIIO::ImageSpec config;
    config.attribute("gib:path", path);
    config.attribute("gib:raw", raw ? 1 : 0);
    const OIIO::ustring name(path + (raw ? " (raw)" : " (linear)"));
    images.add_file(name, LinearInput::create, &config);
    handle_ = images.get_image_handle(name);
    OIIO::ImageSpec spec;
    if (!handle_ || !images.get_imagespec(image(handle_), nullptr, spec))
        throw InputError({path, 0, 0}, images.geterror());
    tile_width_ = spec.tile_width;
    measure(path);
    keep_in_memory();
}

Bitmap::~Bitmap() {
    for (void* held : held_)
        cache_->tiles_->cache->release_tile(tile(held));
}

/// Reads every row in the file's order, so that the cache never seeks backwards while it fills.
void Bitmap::measure(const std::string& path) {
    OIIO::ImageCache& images = *cache_->tiles_->cache;
    std::vector<float> values(static_cast<std::size_t>(width_) * tile_size * static_cast<std::size_t>(channels_));
    Colord sum = Colord::Zero();
    minimum_ = Color::Constant(infinity);
    maximum_ = Color::Constant(-infinity);
    for (int y = 0; y < height_; y += tile_size) {
        const int end = std::min(y + tile_size, height_);
        if (!images.get_pixels(image(handle_), nullptr, 0, 0, 0, width_, y, end, 0, 1, OIIO::TypeDesc::FLOAT,
                               values.data()))
            throw InputError({path, 0, 0}, images.geterror());
        const int count = (end - y) * width_;
        for (int i = 0; i < count; ++i) {
            const Color c = color_at(values.data() + i * channels_);
            if (!c.allFinite())
                throw InputError({path, 0, 0}, fmt::format("the pixel in column {}, row {} is not finite", i % width_,
                                                           y + i / width_));
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
    OIIO::ImageCache& images = *cache_->tiles_->cache;
    for (int y = 0; y < height_; y += tile_size)
        for (int x = 0; x < width_; x += tile_size) {
            OIIO::TypeDesc format;
            auto* pinned = images.get_tile(image(handle_), nullptr, 0, 0, x, y, 0);
            if (!pinned) throw RunError(images.geterror());
            held_.push_back(pinned);
            resident_.push_back(static_cast<const float*>(images.tile_pixels(pinned, format)));
        }
}

Color Bitmap::paged_texel(int x, int y) const {
    OIIO::ImageCache& images = *cache_->tiles_->cache;
    auto* pinned = images.get_tile(image(handle_), nullptr, 0, 0, x, y, 0);
    if (!pinned) throw RunError("reading a texture: " + images.geterror());
    OIIO::TypeDesc format;
    const Color c = color_at(static_cast<const float*>(images.tile_pixels(pinned, format)) + offset_in_tile(x, y));
    images.release_tile(pinned);
    return c;
}

}  // namespace gib
