#include "common/images/image_file.h"

#include "common/color/cie.h"
#include "common/color/srgb.h"
#include "common/core/descriptor.h"
#include "common/core/error.h"
#include "common/core/files.h"
#include "common/images/image_library.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <fcntl.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <tuple>

namespace gib {

namespace {

constexpr std::array<const char*, 3> rgb_names = {"R", "G", "B"};
constexpr std::array<const char*, 3> xyz_names = {"X", "Y", "Z"};

/// A layer of a file: the indices of its three channels (for grey, one channel three times).
struct StoredLayer {
    std::string name;
    std::array<int, 3> channels;
    bool is_xyz = false;  ///< CIE 1931 XYZ instead of R, G, B
};

std::string channel_name(const std::string& layer, const std::string& channel) {
    return layer.empty() ? channel : layer + "." + channel;
}

std::string size_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

/// OpenEXR's view of the content of a file.
class ExrStream final : public Imf::OStream {
public:
    explicit ExrStream(FileContent& content) : Imf::OStream(""), content_(content) {}
    void write(const char data[], int size) override { content_.write({data, static_cast<std::size_t>(size)}); }
    std::uint64_t tellp() override { return content_.position(); }
    void seekp(std::uint64_t position) override { content_.seek(position); }

private:
    FileContent& content_;
};

void encode_exr(FileContent& content, const LayeredImage& image, Imf::Compression compression) {
    if (image.layers.empty()) throw std::invalid_argument("an EXR file needs a layer");
    const Image& first = image.layers[0].second;
    Imf::Header header(first.width, first.height);
    header.compression() = compression;
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
    ExrStream stream(content);
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(pixels);
    file.writePixels(first.height);
    // The destructor of `file` writes the table of offsets.
}

/// Throws InputError if the data window does not cover the display window: a cropped image cannot be compared with a
/// whole one. Pixels outside the display window (overscan) are allowed; take_channels() leaves them out.
void require_display_window(const StoredImage& stored, const std::string& path) {
    const auto& [data, display] = std::tie(stored.data, stored.display);
    const bool covered = data.x <= display.x && data.y <= display.y &&
                         data.x + data.width >= display.x + display.width &&
                         data.y + data.height >= display.y + display.height;
    if (!covered)
        throw InputError({path, 0, 0}, "the data window of " + size_text(data.width, data.height) +
                                           " pixels does not cover the display window of " +
                                           size_text(display.width, display.height) + ": a cropped image");
}

/// A layer as an image of the display window, in linear RGB.
Image take_channels(const StoredImage& stored, const StoredLayer& layer) {
    const auto& [data, display] = std::tie(stored.data, stored.display);
    Image image(display.width, display.height);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const auto row = static_cast<std::size_t>(y + display.y - data.y);
            const auto column = static_cast<std::size_t>(x + display.x - data.x);
            const std::size_t from = (row * static_cast<std::size_t>(data.width) + column) * stored.channels.size();
            const std::size_t to =
                3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
            Color value;
            for (std::size_t k = 0; k < 3; ++k) {
                const float v = stored.values[from + static_cast<std::size_t>(layer.channels[k])];
                value[static_cast<Eigen::Index>(k)] = stored.srgb ? linear_from_srgb(v) : v;
            }
            if (layer.is_xyz) value = rgb_of_xyz(value.cast<double>()).cast<float>();
            std::copy(value.begin(), value.end(), image.rgb.begin() + static_cast<std::ptrdiff_t>(to));
        }
    return image;
}

int channel_index(const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

/// Gives channels `r`, `g`, `b` their usual names, unless the file has these, too.
void name_in_capitals(std::vector<std::string>& channels) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
        std::string name = channels[i];
        const bool is_letter = name.size() == 1 || (name.size() > 1 && name[name.size() - 2] == '.');
        if (!is_letter || std::string_view("rgb").find(name.back()) == std::string_view::npos) continue;
        name.back() = static_cast<char>(name.back() - 'a' + 'A');
        if (channel_index(channels, name) < 0) channels[i] = std::move(name);
    }
}

/// Whether the program reads the layers of this name itself: the image, a component, or a standard error, bias or group.
bool is_read_by_name(const std::string& layer) {
    const std::string first = layer.substr(0, layer.find('_'));
    return layer.empty() || component_named(first) || first == "stderr" || first == bias_layer_suffix ||
           first.starts_with("group");
}

/// The layers that a file's channels form. A layer has channels R, G and B, or X, Y and Z, or Y without X; the only channel
/// of a file is grey whatever its name, but for X. Layers are in the order of the file, with "" first. Throws InputError for
/// an incomplete layer that would be missed.
std::vector<StoredLayer> layers_among(const std::vector<std::string>& names, const std::string& path) {
    std::vector<StoredLayer> layers;
    for (const std::string& name : names) {
        const std::size_t dot = name.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : name.substr(0, dot);
        const std::string channel = dot == std::string::npos ? name : name.substr(dot + 1);
        const auto channels = [&](const std::array<const char*, 3>& wanted) {
            std::array<int, 3> found{};
            for (std::size_t k = 0; k < 3; ++k)
                found[k] = channel_index(names, channel_name(layer, wanted[k]));
            return found;
        };
        const auto complete = [](const std::array<int, 3>& found) {
            return std::all_of(found.begin(), found.end(), [](int c) { return c >= 0; });
        };
        const auto rgb = channels(rgb_names), xyz = channels(xyz_names);
        if (complete(rgb)) {
            if (channel == "R") layers.push_back({layer, rgb});
            continue;
        }
        if (complete(xyz)) {
            if (channel == "X") layers.push_back({layer, xyz, true});
            continue;
        }
        // Y beside RY and BY, or beside X, is a part of a colour; Y alone would make it grey.
        const bool part = xyz[0] >= 0 || channel_index(names, channel_name(layer, "RY")) >= 0;
        const int index = channel_index(names, name);
        if (!part && (channel == "Y" || names.size() == 1)) layers.push_back({layer, {index, index, index}});
        else if (is_read_by_name(layer) && (channel == "R" || channel == "G" || channel == "B" || channel == "X"))
            throw InputError({path, 0, 0},
                             "the layer '" + layer + "' has a channel " + channel + ", but not all of R,G,B or X,Y,Z");
    }
    std::stable_partition(layers.begin(), layers.end(), [](const auto& layer) { return layer.name.empty(); });
    return layers;
}

/// As encode_exr(), for the file `path`: all errors are RunErrors that name it.
void encode_for(const std::string& path, FileContent& content, const LayeredImage& image,
                Imf::Compression compression) {
    try {
        encode_exr(content, image, compression);
    } catch (const RunError&) {
        throw;
    } catch (const std::exception& e) {
        throw RunError(path + ": " + e.what());
    }
}

}  // namespace

const Image* LayeredImage::find(const std::string& layer) const {
    for (const auto& [name, image] : layers)
        if (name == layer) return &image;
    return nullptr;
}

void write_exr(const std::string& path, const LayeredImage& image, Flush flush) {
    // Noise leaves little to compress: for a render of the Cornell box with six layers of 256 x 256 pixels, ZIP takes
    // 69 ms for 1.57 MB, and run lengths take 9 ms for 2.08 MB. Who does not wait for the disk does not wait for that
    // either, and gets 4.72 MB.
    const Imf::Compression compression = flush == Flush::now ? Imf::RLE_COMPRESSION : Imf::NO_COMPRESSION;
    write_file(
        path, [&](FileContent& content) { encode_for(path, content, image, compression); }, flush);
}

void write_scratch_exr(const std::string& path, const LayeredImage& image) {
    const auto fail = [&] { throw RunError(path + ": cannot write: " + std::strerror(errno)); };
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    if (file.get() < 0) fail();
    FileContent content(file.get(), path);
    encode_for(path, content, image, Imf::NO_COMPRESSION);
    content.flush();
    if (!file.close()) fail();
}

LayeredImage read_image(const std::string& path) {
    StoredImage stored = image_library().read_image(path);
    require_display_window(stored, path);
    name_in_capitals(stored.channels);
    const auto layers = layers_among(stored.channels, path);
    if (layers.empty()) {
        std::string names;
        for (const auto& name : stored.channels)
            names += (names.empty() ? "" : ", ") + name;
        throw InputError({path, 0, 0}, "no channels R,G,B or Y; the image has " + names);
    }
    LayeredImage image;
    for (const StoredLayer& layer : layers)
        image.layers.emplace_back(layer.name, take_channels(stored, layer));
    // Some renderers give the only layer a name ("ViewLayer.Combined.R"); this layer is the image.
    if (image.layers.size() == 1) image.layers[0].first = "";
    image.metadata = stored.metadata;
    return image;
}

std::optional<std::map<std::string, std::string>> exr_attributes(const std::string& path) {
    std::map<std::string, std::string> attributes;
    try {
        const Imf::InputFile file(path.c_str());
        for (auto entry = file.header().begin(); entry != file.header().end(); ++entry)
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&entry.attribute()))
                attributes[entry.name()] = text->value();
    } catch (const std::exception&) {
        return std::nullopt;
    }
    return attributes;
}

std::string bias_layer_of(std::string_view layer) { return std::string(layer) + "_" + std::string(bias_layer_suffix); }

LayeredImage layers_of(ComponentImages image) {
    LayeredImage file;
    const auto add = [&file](std::string name, std::optional<Image>& layer) {
        if (layer) file.layers.emplace_back(std::move(name), std::move(*layer));
    };
    file.layers.emplace_back("", image.total());
    auto total_bias = image.total_bias();
    for (Component c : all_components)
        add(std::string(name_of(c)), image[c]);
    add(std::string(bias_layer_suffix), total_bias);
    for (Component c : all_components)
        add(bias_layer_of(name_of(c)), image.bias[static_cast<std::size_t>(index_of(c))]);
    std::move(image.techniques.begin(), image.techniques.end(), std::back_inserter(file.layers));
    return file;
}

ComponentImages components_in(const LayeredImage& image) {
    ComponentImages result;
    if (image.layers.empty()) return result;
    result.width = image.layers[0].second.width;
    result.height = image.layers[0].second.height;
    for (Component c : all_components) {
        if (const Image* layer = image.find(std::string(name_of(c)))) result[c] = *layer;
        if (const Image* layer = image.find(bias_layer_of(name_of(c))))
            result.bias[static_cast<std::size_t>(index_of(c))] = *layer;
    }
    for (const auto& layer : image.layers)
        if (layer.first.starts_with(technique_layer_prefix)) result.techniques.push_back(layer);
    return result;
}

std::vector<std::uint8_t> encode_png(const Image& image, float exposure) {
    std::vector<std::uint8_t> bytes(image.rgb.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const float v = image.rgb[i] * exposure;
        // NaN becomes black in the picture; the tables of an experiment count it.
        const float clipped = std::isgreater(v, 0.f) ? std::min(v, 1.f) : 0.f;
        bytes[i] = static_cast<std::uint8_t>(std::lround(255.f * srgb_from_linear(clipped)));
    }
    return image_library().encode_png(image.width, image.height, bytes);
}

}  // namespace gib
