// The library gib_images, which implements the interface of common/images/image_library.h with OpenImageIO.
#include "common/images/image_library.h"

#include "common/core/error.h"
#include "common/core/memory_limit.h"
#include "common/openimageio/linear_reader.h"

#include <OpenImageIO/filesystem.h>
#include <cstdint>

namespace gib {

namespace {

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

    LinearImage read_linear(const std::string& path, bool raw) const override { return gib::read_linear(path, raw); }
};

}  // namespace

}  // namespace gib

extern "C" __attribute__((visibility("default"))) const gib::ImageLibrary* gib_image_library() {
    static const gib::OiioLibrary library;
    return &library;
}
