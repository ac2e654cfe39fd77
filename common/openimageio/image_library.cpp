// The library gib_images, which implements the interface of common/images/image_library.h with OpenImageIO.
#include "common/images/image_library.h"

#include "common/core/error.h"
#include "common/core/memory_limit.h"
#include "common/openimageio/linear_reader.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagecache.h>
#include <cstdint>

namespace gib {

namespace {

/// The image format that OpenImageIO's cache reads: linear floats instead of the file's encoding, so that values are
/// decoded before they are filtered.
class LinearInput final : public OIIO::ImageInput {
public:
    static OIIO::ImageInput* create() { return new LinearInput; }
    const char* format_name() const override { return "gibench-linear"; }
    int supports(OIIO::string_view feature) const override { return feature == "procedural"; }
    bool open(const std::string& name, OIIO::ImageSpec& spec) override { return open(name, spec, {}); }
    bool open(const std::string&, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override {
        return reported([&] {
            file_ = std::make_unique<LinearReader>(config.get_string_attribute("gib:path"),
                                                   config.get_int_attribute("gib:raw") != 0,
                                                   config.get_string_attribute("gib:channel"));
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
    std::unique_ptr<LinearReader> file_;
};

OIIO::ImageCache::ImageHandle* image(void* handle) { return static_cast<OIIO::ImageCache::ImageHandle*>(handle); }
OIIO::ImageCache::Tile* tile(void* handle) { return static_cast<OIIO::ImageCache::Tile*>(handle); }

class OiioTileCache final : public TileCache {
public:
    OiioTileCache(double megabytes, int tile_size) : images_(OIIO::ImageCache::create(false)) {
        images_->attribute("max_memory_MB", static_cast<float>(megabytes));
        images_->attribute("autotile", tile_size);
        images_->attribute("automip", 0);
    }
    ~OiioTileCache() override { OIIO::ImageCache::destroy(images_); }
    OiioTileCache(const OiioTileCache&) = delete;
    OiioTileCache& operator=(const OiioTileCache&) = delete;

    File add(const std::string& path, bool raw, const std::string& channel) override {
        OIIO::ImageSpec config;
        config.attribute("gib:path", path);
        config.attribute("gib:raw", raw ? 1 : 0);
        config.attribute("gib:channel", channel);
        const OIIO::ustring name(path + (raw ? " (raw)" : " (linear)") + channel);
        images_->add_file(name, LinearInput::create, &config);
        OIIO::ImageCache::ImageHandle* file = images_->get_image_handle(name);
        OIIO::ImageSpec spec;
        if (!file || !images_->get_imagespec(file, nullptr, spec)) throw InputError({path, 0, 0}, images_->geterror());
        return {file, spec.tile_width};
    }

    void read_rows(void* file, int width, int begin, int end, float* values) override {
        if (!images_->get_pixels(image(file), nullptr, 0, 0, 0, width, begin, end, 0, 1, OIIO::TypeDesc::FLOAT, values))
            throw RunError(images_->geterror());
    }

    Tile tile_at(void* file, int x, int y) override {
        auto* pinned = images_->get_tile(image(file), nullptr, 0, 0, x, y, 0);
        if (!pinned) throw RunError("reading a texture: " + images_->geterror());
        OIIO::TypeDesc format;
        return {pinned, static_cast<const float*>(images_->tile_pixels(pinned, format))};
    }
    void release(void* pinned) override { images_->release_tile(tile(pinned)); }

private:
    OIIO::ImageCache* images_;
};

class OiioLibrary final : public ImageLibrary {
public:
    StoredImage read_image(const std::string& path) const override {
        const auto file = open_file(path);
        const SourceLocation where{path, 0, 0};
        const OIIO::ImageSpec& spec = file->spec();
        // The values are in memory twice, as they are read and as layers. A damaged header may announce more than the
        // file can hold.
        require_memory_for_image(2.0 * static_cast<double>(spec.image_pixels()) * spec.nchannels, spec.width,
                                 spec.height, spec.nchannels, where);
        StoredImage image{
            .data = {.x = spec.x, .y = spec.y, .width = spec.width, .height = spec.height},
            .display = {.x = spec.full_x, .y = spec.full_y, .width = spec.full_width, .height = spec.full_height},
            .channels = spec.channelnames,
            .values = std::vector<float>(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels)),
            .srgb = spec.get_string_attribute("oiio:ColorSpace") == "sRGB" && !spec.format.is_floating_point(),
            .metadata = {}};
        for (const auto& attribute : spec.extra_attribs)
            if (attribute.type() == OIIO::TypeDesc::STRING && attribute.name().rfind("oiio:", 0) != 0)
                image.metadata[attribute.name().string()] = attribute.get_string();
        if (!file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.values.data()))
            throw InputError(where, "the image is damaged: " + file->geterror());
        require_one_part(*file, where);
        return image;
    }

    std::vector<std::uint8_t> encode_png(int width, int height, const std::vector<std::uint8_t>& rgb) const override {
        std::vector<std::uint8_t> png;
        OIIO::Filesystem::IOVecOutput memory(png);
        const auto output = OIIO::ImageOutput::create("memory.png");
        OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
        spec.attribute("oiio:ColorSpace", "sRGB");
        if (!output || !output->set_ioproxy(&memory) || !output->open("memory.png", spec) ||
            !output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) || !output->close())
            throw RunError("encoding a PNG image: " + (output ? output->geterror() : OIIO::geterror()));
        return png;
    }

    std::unique_ptr<ImageReader> open_image(const std::string& path, bool raw,
                                            const std::string& channel) const override {
        return std::make_unique<LinearReader>(path, raw, channel);
    }
    std::unique_ptr<TileCache> tile_cache(double megabytes, int tile_size) const override {
        return std::make_unique<OiioTileCache>(megabytes, tile_size);
    }
};

}  // namespace

}  // namespace gib

extern "C" __attribute__((visibility("default"))) const gib::ImageLibrary* gib_image_library() {
    static const gib::OiioLibrary library;
    return &library;
}
