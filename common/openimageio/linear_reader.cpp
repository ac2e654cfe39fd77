#include "common/openimageio/linear_reader.h"

#include "common/color/srgb.h"
#include "common/core/memory_limit.h"
#include "common/core/reject.h"

#include <OpenImageIO/imageio.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

namespace gib {

namespace {

/// The index of a channel of the only layer: that of "R", or of "Layer.R" if no second layer has an R. -1 if
/// there is none.
int find_channel(const std::vector<std::string>& names, const std::string& channel) {
    int found = -1;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == channel) return static_cast<int>(i);
        if (!names[i].ends_with("." + channel)) continue;
        if (found >= 0) return -1;
        found = static_cast<int>(i);
    }
    return found;
}

/// The indices of the channels to read: R, G and B, or one grey channel.
std::vector<int> choose_channels(const OIIO::ImageSpec& spec, const SourceLocation& where) {
    const auto& names = spec.channelnames;
    const std::vector<int> rgb{find_channel(names, "R"), find_channel(names, "G"), find_channel(names, "B")};
    if (std::all_of(rgb.begin(), rgb.end(), [](int c) { return c >= 0; })) return rgb;
    // Y beside RY and BY is the luminance of a colour image; Y alone would make it grey.
    if (find_channel(names, "RY") >= 0)
        throw InputError(where, "an image of luminance and subsampled chroma; only R,G,B or one channel is supported");
    if (const int grey = find_channel(names, "Y"); grey >= 0 && find_channel(names, "Z") < 0) return {grey};
    if (names.size() == 1) return {0};
    reject(where, "no channels R,G,B or Y of one layer; the image has {}", fmt::join(names, ", "));
}

/// Throws InputError for primaries other than sRGB's: their colours would need a matrix and would be
/// wrong without it.
void require_srgb_primaries(const OIIO::ImageSpec& spec, const SourceLocation& where) {
    constexpr std::array<float, 8> srgb = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
    std::array<float, 8> primaries = srgb;
    if (!spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), primaries.data())) return;
    for (std::size_t i = 0; i < srgb.size(); ++i)
        if (!(std::abs(primaries[i] - srgb[i]) <= 1e-3f))
            throw InputError(where, "the file's chromaticities are not those of sRGB");
}

}  // namespace

std::unique_ptr<OIIO::ImageInput> open_file(const std::string& path, const OIIO::ImageSpec* config) {
    const SourceLocation where{path, 0, 0};
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) throw InputError(where, "no such file");
    if (std::filesystem::is_directory(path, ignored)) throw InputError(where, "this is a folder, not an image");
    auto file = OIIO::ImageInput::open(path, config);
    if (!file) throw InputError(where, "not an image that can be read: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = file->spec();
    if (spec.deep) throw InputError(where, "a deep image; only flat ones are supported");
    if (spec.depth > 1) throw InputError(where, "a volume, not an image");
    if (spec.width < 1 || spec.height < 1) throw InputError(where, "the image has no pixels");
    return file;
}

void require_one_part(OIIO::ImageInput& file, const SourceLocation& where) {
    if (file.seek_subimage(1, 0)) throw InputError(where, "the file has several parts; one is supported");
    OIIO::geterror();  // clears the error message of the search for a second part
    file.geterror();
}

LinearImage read_linear(const std::string& path, bool raw) {
    const SourceLocation where{path, 0, 0};
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are stored, not multiplied by alpha
    const auto file = open_file(path, &config);
    require_one_part(*file, where);
    const OIIO::ImageSpec& spec = file->spec();
    const std::vector<int> channels = choose_channels(spec, where);
    require_srgb_primaries(spec, where);
    const auto [first, last] = std::minmax_element(channels.begin(), channels.end());
    const std::size_t pixels = spec.image_pixels(), stride = static_cast<std::size_t>(*last - *first + 1);
    LinearImage image{spec.width, spec.height, static_cast<int>(channels.size()), {}};
    // A damaged header may announce more than the file can hold.
    require_memory_for_image(static_cast<double>(pixels) * static_cast<double>(stride + channels.size()), spec.width,
                             spec.height, image.channels, where);
    std::vector<float> stored(pixels * stride);
    if (!file->read_image(0, 0, *first, *last + 1, OIIO::TypeDesc::FLOAT, stored.data()))
        throw InputError(where, "the image is damaged: " + file->geterror());
    const bool bytes = spec.format == OIIO::TypeDesc::UINT8;
    const bool srgb = !raw && (bytes || spec.format == OIIO::TypeDesc::UINT16);
    std::array<float, 256> decoded;  // the linear values of bytes
    for (std::size_t i = 0; i < decoded.size(); ++i)
        decoded[i] = linear_from_srgb(static_cast<float>(i) / 255);
    image.values.reserve(pixels * channels.size());
    for (std::size_t i = 0; i < pixels; ++i)
        for (const int channel : channels) {
            const float v = stored[i * stride + static_cast<std::size_t>(channel - *first)];
            if (!std::isfinite(v))
                reject(where, "the pixel in column {}, row {} is not finite", i % static_cast<std::size_t>(spec.width),
                       i / static_cast<std::size_t>(spec.width));
            const auto byte = static_cast<std::size_t>(bytes ? v * 255 + 0.5f : 0.f);
            image.values.push_back(!srgb ? v : bytes ? decoded[byte] : linear_from_srgb(v));
        }
    return image;
}

}  // namespace gib
