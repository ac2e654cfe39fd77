#include "common/image_file.h"

#include "common/error.h"
#include "common/files.h"
#include "common/srgb.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

namespace gib {

namespace {

constexpr std::array<const char*, 3> rgb_names = {"R", "G", "B"};

std::string channel_name(const std::string& layer, const std::string& channel) {
    return layer.empty() ? channel : layer + "." + channel;
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

/// The whole file in memory, so that writing it to disk is one step that succeeds or fails as one.
std::string encode_exr(const LayeredImage& image) {
    if (image.layers.empty()) throw std::invalid_argument("an EXR file needs a layer");
    const Image& first = image.layers[0].second;
    Imf::Header header(first.width, first.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [key, value] : image.metadata)
        header.insert(key, Imf::StringAttribute(value));
    Imf::FrameBuffer pixels;
    constexpr std::size_t pixel_bytes = 3 * sizeof(float);
    for (const auto& [name, layer] : image.layers) {
        if (!layer.same_size(first)) throw std::invalid_argument("the layers of an EXR file differ in size");
        for (std::size_t k = 0; k < 3; ++k) {
            const std::string channel = channel_name(name, rgb_names[k]);
            header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
            // OpenEXR's interface for writing takes a pointer to mutable data and does not write to it.
            char* base = reinterpret_cast<char*>(const_cast<float*>(layer.rgb.data() + k));
            pixels.insert(channel, Imf::Slice(Imf::FLOAT, base, pixel_bytes,
                                              pixel_bytes * static_cast<std::size_t>(layer.width)));
        }
    }
    Imf::StdOSStream stream;
    {
        Imf::OutputFile file(stream, header);
        file.setFrameBuffer(pixels);
        file.writePixels(first.height);
    }  // the destructor writes the table of offsets
    return stream.str();
}

/// A file as it is stored: interleaved channels of the whole data window.
struct RawImage {
    OIIO::ImageSpec spec;
    std::vector<float> values;
};

RawImage read_raw(const std::string& path) {
    const SourceLocation where{path, 0, 0};
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) throw InputError(where, "no such file");
    if (std::filesystem::is_directory(path, ignored)) throw InputError(where, "this is a folder, not an image");
    const auto file = OIIO::ImageInput::open(path);
    if (!file) throw InputError(where, "not an image that can be read: " + OIIO::geterror());
    RawImage raw{file->spec(), {}};
    if (raw.spec.deep) throw InputError(where, "a deep image; only flat ones are supported");
    if (raw.spec.depth > 1) throw InputError(where, "a volume, not an image");
    if (raw.spec.width < 1 || raw.spec.height < 1) throw InputError(where, "the image has no pixels");
    raw.values.resize(raw.spec.image_pixels() * static_cast<std::size_t>(raw.spec.nchannels));
    if (!file->read_image(0, 0, 0, raw.spec.nchannels, OIIO::TypeDesc::FLOAT, raw.values.data()))
        throw InputError(where, "the image is damaged: " + file->geterror());
    if (file->seek_subimage(1, 0)) throw InputError(where, "the file has several parts; one is supported");
    OIIO::geterror();  // what the search for a second part left behind
    return raw;
}

/// Cuts what lies outside the display window (overscan). A picture of a part only cannot be compared with a whole one.
void require_display_window(const OIIO::ImageSpec& spec, const std::string& path) {
    const bool covered = spec.x <= spec.full_x && spec.y <= spec.full_y &&
                         spec.x + spec.width >= spec.full_x + spec.full_width &&
                         spec.y + spec.height >= spec.full_y + spec.full_height;
    if (!covered)
        throw InputError({path, 0, 0}, "the data window of " + size_text(spec.width, spec.height) +
                                           " pixels does not cover the display window of " +
                                           size_text(spec.full_width, spec.full_height) + ": a cropped image");
}

/// Three channels (or one, three times) as an image of the display window.
Image take_channels(const RawImage& raw, const std::array<int, 3>& channels) {
    const OIIO::ImageSpec& spec = raw.spec;
    Image image(spec.full_width, spec.full_height);
    const bool srgb = spec.get_string_attribute("oiio:ColorSpace") == "sRGB" && !spec.format.is_floating_point();
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const auto row = static_cast<std::size_t>(y + spec.full_y - spec.y);
            const auto column = static_cast<std::size_t>(x + spec.full_x - spec.x);
            const std::size_t from =
                (row * static_cast<std::size_t>(spec.width) + column) * static_cast<std::size_t>(spec.nchannels);
            const std::size_t to =
                3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
            for (std::size_t k = 0; k < 3; ++k) {
                const float v = raw.values[from + static_cast<std::size_t>(channels[k])];
                image.rgb[to + k] = srgb ? linear_from_srgb(v) : v;
            }
        }
    return image;
}

int channel_index(const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

/// The layers that a file's channels form: those with R, G and B, or with Y alone. In the order of the file, "" first.
std::vector<std::pair<std::string, std::array<int, 3>>> layers_among(const std::vector<std::string>& names) {
    std::vector<std::pair<std::string, std::array<int, 3>>> layers;
    for (const std::string& name : names) {
        const std::size_t dot = name.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : name.substr(0, dot);
        const std::string channel = dot == std::string::npos ? name : name.substr(dot + 1);
        std::array<int, 3> channels{};
        for (std::size_t k = 0; k < 3; ++k)
            channels[k] = channel_index(names, channel_name(layer, rgb_names[k]));
        const bool colour = std::all_of(channels.begin(), channels.end(), [](int c) { return c >= 0; });
        // Y beside RY and BY is luminance of a colour image, which Y alone would turn grey.
        const bool chroma = channel_index(names, channel_name(layer, "RY")) >= 0;
        const bool grey = !colour && !chroma && (channel == "Y" || names.size() == 1);
        if (grey) channels.fill(channel_index(names, name));
        if (grey || (colour && channel == "R")) layers.emplace_back(layer, channels);
    }
    std::stable_partition(layers.begin(), layers.end(), [](const auto& layer) { return layer.first.empty(); });
    return layers;
}

}  // namespace

const Image* LayeredImage::find(const std::string& layer) const {
    for (const auto& [name, image] : layers)
        if (name == layer) return &image;
    return nullptr;
}

void write_exr(const std::string& path, const LayeredImage& image) {
    std::string content;
    try {
        content = encode_exr(image);
    } catch (const std::exception& e) {
        throw RunError(path + ": " + e.what());
    }
    write_file(path, content);
}

LayeredImage read_image(const std::string& path) {
    const RawImage raw = read_raw(path);
    require_display_window(raw.spec, path);
    const auto layers = layers_among(raw.spec.channelnames);
    if (layers.empty()) {
        std::string names;
        for (const auto& name : raw.spec.channelnames)
            names += (names.empty() ? "" : ", ") + name;
        throw InputError({path, 0, 0}, "no channels R,G,B or Y; the image has " + names);
    }
    LayeredImage image;
    for (const auto& [name, channels] : layers)
        image.layers.emplace_back(name, take_channels(raw, channels));
    // Some renderers name the only layer ("ViewLayer.Combined.R"): then that is the image.
    if (image.layers.size() == 1) image.layers[0].first = "";
    for (const auto& attribute : raw.spec.extra_attribs)
        if (attribute.type() == OIIO::TypeDesc::STRING && attribute.name().rfind("oiio:", 0) != 0)
            image.metadata[attribute.name().string()] = attribute.get_string();
    return image;
}

LayeredImage layers_of(const ComponentImages& image) {
    LayeredImage file;
    file.layers.emplace_back("", image.total());
    for (Component c : all_components)
        if (image[c]) file.layers.emplace_back(std::string(name_of(c)), *image[c]);
    return file;
}

ComponentImages components_in(const LayeredImage& image) {
    ComponentImages result;
    if (image.layers.empty()) return result;
    result.width = image.layers[0].second.width;
    result.height = image.layers[0].second.height;
    for (Component c : all_components)
        if (const Image* layer = image.find(std::string(name_of(c)))) result[c] = *layer;
    return result;
}

std::vector<std::uint8_t> encode_png(const Image& image, float exposure) {
    std::vector<std::uint8_t> bytes(image.rgb.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const float v = image.rgb[i] * exposure;
        // Written so that NaN becomes black: a picture shows what is there, the tables count it.
        const float clipped = v > 0 ? std::min(v, 1.f) : 0.f;
        bytes[i] = static_cast<std::uint8_t>(std::lround(255.f * srgb_from_linear(clipped)));
    }
    std::vector<std::uint8_t> png;
    OIIO::Filesystem::IOVecOutput memory(png);
    const auto output = OIIO::ImageOutput::create("memory.png");
    OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (!output || !output->set_ioproxy(&memory) || !output->open("memory.png", spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) || !output->close())
        throw RunError("encoding a PNG image: " + (output ? output->geterror() : OIIO::geterror()));
    return png;
}

}  // namespace gib
