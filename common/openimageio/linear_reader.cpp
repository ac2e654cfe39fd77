#include "common/openimageio/linear_reader.h"

#include "common/color/srgb.h"
#include "common/core/reject.h"

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <array>
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

/// The index of the channel that a scene names, in capitals or not.
int named_channel(const OIIO::ImageSpec& spec, const std::string& channel, const SourceLocation& where) {
    const auto& names = spec.channelnames;
    for (const std::string& name : {channel, std::string(OIIO::Strutil::upper(channel))})
        if (const int found = find_channel(names, name); found >= 0) return found;
    reject(where, "no channel '{}' of one layer; the image has {}", channel, fmt::join(names, ", "));
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
    if (!std::filesystem::exists(path, ignored)) throw InputError(path + ": no such file");
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

LinearReader::LinearReader(const std::string& path, bool raw, const std::string& channel) : path_(path) {
    const SourceLocation where{path, 0, 0};
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are stored, not multiplied by alpha
    file_ = open_file(path, &config);
    require_one_part(*file_, where);
    const OIIO::ImageSpec& spec = file_->spec();
    channels_ = channel.empty() ? choose_channels(spec, where) : std::vector<int>{named_channel(spec, channel, where)};
    require_srgb_primaries(spec, where);
    const bool bytes = spec.format == OIIO::TypeDesc::UINT8;
    const bool alpha = channel == "a" || channel == "A";
    srgb_ = !raw && !alpha && (bytes || spec.format == OIIO::TypeDesc::UINT16);
    if (srgb_ && bytes)
        for (int i = 0; i < 256; ++i)
            decoded_.push_back(linear_from_srgb(static_cast<float>(i) / 255));
}

float LinearReader::linear(float v) const {
    if (!srgb_) return v;
    return decoded_.empty() ? linear_from_srgb(v) : decoded_[static_cast<std::size_t>(v * 255 + 0.5f)];
}

void LinearReader::read_rows(int begin, int end, float* values) const {
    const OIIO::ImageSpec& spec = file_->spec();
    const auto [first, last] = std::minmax_element(channels_.begin(), channels_.end());
    const int stride = *last - *first + 1;
    // Rows are extended to whole tiles, because a tile can only be read as a whole.
    const int tile = std::max(spec.tile_height, 1);
    const int from = begin / tile * tile, to = std::min((end + tile - 1) / tile * tile, spec.height);
    const auto row = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(stride);
    std::vector<float> stored(row * static_cast<std::size_t>(to - from));
    const bool read = spec.tile_width > 0
                          ? file_->read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + from, spec.y + to, spec.z,
                                              spec.z + 1, *first, *last + 1, OIIO::TypeDesc::FLOAT, stored.data())
                          : file_->read_scanlines(0, 0, spec.y + from, spec.y + to, spec.z, *first, *last + 1,
                                                  OIIO::TypeDesc::FLOAT, stored.data());
    if (!read) throw InputError({path_, 0, 0}, "the image is damaged: " + file_->geterror());
    const float* pixel = stored.data() + row * static_cast<std::size_t>(begin - from);
    const auto count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(end - begin);
    for (std::size_t i = 0; i < count; ++i, pixel += stride)
        for (const int channel : channels_)
            *values++ = linear(pixel[channel - *first]);
}

}  // namespace gib
