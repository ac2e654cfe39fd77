#include "experiments/report/report_pictures.h"

#include "common/core/error.h"
#include "common/images/image_file.h"
#include "experiments/metrics/student_t.h"
#include "experiments/results/judgement.h"
#include "experiments/results/pictures.h"

#include <fmt/format.h>
#include <nettle/base64.h>
#include <zlib.h>
#include <Eigen/Core>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>

namespace gib {

using nlohmann::json;

namespace {

std::string deflated_text(const std::vector<std::uint8_t>& bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::vector<std::uint8_t> packed(size);
    if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 6) != Z_OK)
        throw RunError("an image cannot be compressed for the report");
    packed.resize(size);
    return base64(packed);
}

/// Appends rows of `width` bytes as differences to the left neighbour.
void append_differences(std::span<const std::uint8_t> plane, int width, std::vector<std::uint8_t>& out) {
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const unsigned left = i % static_cast<std::size_t>(width) == 0 ? 0u : plane[i - 1];
        out.push_back(static_cast<std::uint8_t>(plane[i] - left));
    }
}

/// The exponent of the power of two that brings the largest finite value to [2^14, 2^15); halves end at 65504.
int scale_exponent(std::span<const float> values) {
    float largest = 0;
    for (const float v : values)
        if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
    if (largest == 0) return 0;
    int exponent = 0;
    std::frexp(largest, &exponent);
    return 15 - exponent;
}

/// Packs one byte a pixel, as differences to the left neighbour like the high bytes of pack_half().
PackedImage pack_bytes(std::span<const std::uint8_t> values, int width, int height) {
    std::vector<std::uint8_t> bytes;
    append_differences(values, width, bytes);
    return {.width = width, .height = height, .channels = 1, .bytes = true, .text = deflated_text(bytes)};
}

/// The elements of the page that hold images; equal ones are stored once.
class Store {
public:
    /// Adds an image. Returns what the script needs to find and unpack it.
    json add(const PackedImage& image) {
        const auto [entry, is_new] = ids_.try_emplace(image.text, ids_.size());
        if (is_new)
            html_ +=
                fmt::format("<script type=\"text/plain\" id=\"picture-{}\">{}</script>\n", entry->second, image.text);
        return {{"id", fmt::format("picture-{}", entry->second)},
                {"width", image.width},
                {"height", image.height},
                {"channels", image.channels},
                {"bytes", image.bytes},
                {"exponent", image.exponent}};
    }
    json add(const Image& image) {
        json entry = add(pack_half(image.rgb, image.width, image.height, 3));
        entry["black"] = is_black(image);
        return entry;
    }
    const std::string& html() const { return html_; }

private:
    std::map<std::string, std::size_t> ids_;
    std::string html_;
};

/// The stored cells and images of one scene.
struct SceneFiles {
    const Analysis& analysis;
    const ResultFolder& folder;
    const std::string& scene;

    std::vector<const Cell*> cells(const std::string& method) const {
        std::vector<const Cell*> found;
        for (const Cell& cell : analysis.cells)
            if (cell.scene == scene && cell.method == method) found.push_back(&cell);
        return found;
    }
    std::string folder_of(const Cell& cell) const {
        return cell_folder_name(scene, analysis.label_of(cell.method), cell.seed);
    }
    LayeredImage image(const Cell& cell) const { return read_image(folder.cell_image(folder_of(cell))); }
};

/// The bias of each pixel, the mean over channels of (mean of the seeds - r) / sqrt(r^2 + epsilon), and half the width
/// of its 95 % interval, from the scatter of the seeds and the reference's standard error.
struct BiasMap {
    std::vector<float> bias, half_width;
};

BiasMap relative_bias(const SceneFiles& files, const std::vector<const Cell*>& cells, const Judgement& judgement,
                      int reduction) {
    const Image r = reduced(judgement.total().mean, reduction);
    const double epsilon = judgement.epsilon(files.analysis.index.epsilon);
    // The mean over the channels of a difference, relative to the reference's pixel.
    const auto relative = [&](std::size_t pixel, const auto& difference) {
        double sum = 0;
        for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i)
            sum += difference(i) / std::sqrt(sqr(double{r.rgb[i]}) + epsilon) / 3;
        return sum;
    };
    std::vector<std::vector<double>> values(r.pixels());  // by pixel, for each seed
    for (const Cell* cell : cells) {
        const Image x = reduced(judgement.total_of(files.image(*cell)), reduction);
        for (std::size_t p = 0; p < r.pixels(); ++p)
            values[p].push_back(relative(p, [&](std::size_t i) { return double{x.rgb[i]} - double{r.rgb[i]}; }));
    }
    const auto& own = judgement.total().standard_error;
    const Image deviation = own ? reduced(*own, reduction) : Image(r.width, r.height);
    constexpr double unknown = 1e4;  // of one seed, and of a reference without a standard error
    BiasMap map;
    for (std::size_t p = 0; p < r.pixels(); ++p) {
        const SampleMean mean = sample_mean(values[p]);
        // The noise of the channels, and of the pixels that are averaged, is taken for dependent.
        const double of_reference = relative(p, [&](std::size_t i) { return double{deviation.rgb[i]}; });
        const double half = own ? half_width({mean.variance, {sqr(of_reference), INFINITY}}, interval_tail) : unknown;
        map.bias.push_back(static_cast<float>(mean.value));
        map.half_width.push_back(static_cast<float>(std::isfinite(half) ? std::min(half, unknown) : unknown));
    }
    return map;
}

json parts_of(const LayeredImage& file, int reduction, Store& store) {
    const ComponentImages image = components_in(file);
    json parts = json::object();
    for (Component c : all_components)
        if (image[c]) parts[std::string(name_of(c))] = store.add(reduced(*image[c], reduction));
    for (const auto& [name, technique] : image.techniques)
        parts[name] = store.add(reduced(technique, reduction));
    if (const Image* whole = file.find(""); parts.empty() && whole)
        parts[total_name] = store.add(reduced(*whole, reduction));
    return parts;
}

json reference_entry(const Reference& reference, const Judgement& judgement, int reduction, Store& store) {
    json parts = json::object();
    for (Component c : all_components)
        if (reference[c]) parts[std::string(name_of(c))] = store.add(reduced(reference[c]->mean, reduction));
    if (parts.empty()) parts[total_name] = store.add(reduced(judgement.total().mean, reduction));
    return {{"method", nullptr}, {"label", "reference"}, {"parts", parts}};
}

json method_entry(const SceneFiles& files, std::size_t method, const Judgement& judgement, int reduction,
                  Store& store) {
    const std::string& label = files.analysis.index.methods[method];
    const auto cells = files.cells(label);
    if (cells.empty() || cells.front()->seed != 1) return nullptr;
    const Cell& first = *cells.front();
    json entry = {{"method", method},
                  {"label", label},
                  {"parts", parts_of(files.image(first), reduction, store)},
                  {"passes", first.last().passes},
                  {"seconds", first.last().seconds},
                  {"seeds", cells.size()},
                  {"frames", json::array()}};
    const auto bias = relative_bias(files, cells, judgement, reduction);
    const Image size = reduced(judgement.total().mean, reduction);
    entry["bias"] = store.add(pack_half(bias.bias, size.width, size.height, 1));
    entry["bias_half_width"] = store.add(pack_half(bias.half_width, size.width, size.height, 1));
    const std::string map = files.folder.flip_map(files.folder_of(first));
    if (std::filesystem::exists(map)) {
        const Image small = reduced(flip_values(read_image(map).layers.front().second), reduction);
        std::vector<std::uint8_t> bytes(small.pixels());
        for (std::size_t i = 0; i < bytes.size(); ++i)
            bytes[i] = static_cast<std::uint8_t>(std::lround(255.f * std::clamp(small.rgb[3 * i], 0.f, 1.f)));
        entry["flip"] = store.add(pack_bytes(bytes, small.width, small.height));
    }
    return entry;
}

/// The sums of components that the viewer offers: the total that is compared, the sum of all if it differs, and each
/// component. Components that are black in every image are left out.
json layers_of(const Reference& reference, const Judgement& judgement, const json& images) {
    json judged = json::array(), all = json::array();
    for (Component c : all_components) {
        const std::string name(name_of(c));
        const bool used = std::ranges::any_of(images, [&](const json& image) {
            const auto part = image.at("parts").find(name);
            return part != image.at("parts").end() && !part->at("black");
        });
        if (!used) continue;
        all.push_back(name);
        if (judgement.is_resolved(c)) judged.push_back(name);
    }
    json layers = json::array({{{"name", total_name}, {"parts", judged}}});
    if (!reference.unresolved.empty()) layers.push_back({{"name", "all components"}, {"parts", all}});
    if (all.size() > 1)
        for (const auto& name : all)
            layers.push_back({{"name", name}, {"parts", json::array({name})}});
    // The techniques of one path length form a row, as in the pyramid of Veach (1997), figure 10.3.
    std::set<std::string> techniques;
    for (const json& image : images)
        for (const auto& part : image.at("parts").items())
            if (part.key().starts_with(technique_layer_prefix)) techniques.insert(part.key());
    for (const std::string& name : techniques)
        layers.push_back({{"name", name}, {"parts", json::array({name})}});
    return layers;
}

json scene_entry(const SceneFiles& files, int halvings, Store& store) {
    const Reference reference = read_reference(files.folder.reference_image(files.scene));
    const Judgement judgement(reference);
    const Image& r = judgement.total().mean;
    const int reduction = reduction_for(r.width, r.height, frame_size) << halvings;
    const Image size = reduced(r, reduction);
    json images = json::array({reference_entry(reference, judgement, reduction, store)});
    for (std::size_t m = 0; m < files.analysis.index.methods.size(); ++m)
        if (json entry = method_entry(files, m, judgement, reduction, store); !entry.is_null())
            images.push_back(std::move(entry));
    return {{"width", size.width},
            {"height", size.height},
            {"film", {r.width, r.height}},
            {"reduction", reduction},
            {"epsilon", judgement.epsilon(files.analysis.index.epsilon)},
            {"stops", std::log2(exposure_for(reference.total.mean))},
            {"layers", layers_of(reference, judgement, images)},
            {"images", std::move(images)}};
}

/// A frame that may be put into the page.
struct PackedFrame {
    std::string scene;
    std::size_t image;  ///< index among the scene's images
    std::uint32_t passes;
    double seconds;
    PackedImage packed;
};

std::vector<PackedFrame> all_frames(const Analysis& analysis, const ResultFolder& folder, const json& scenes,
                                    int halvings, std::vector<std::string>& damage) {
    std::vector<PackedFrame> frames;
    for (const auto& [scene, entry] : scenes.items())
        for (std::size_t i = 1; i < entry.at("images").size(); ++i) {
            const std::string& label = analysis.index.methods[entry["images"][i]["method"].get<std::size_t>()];
            const SceneFiles files{analysis, folder, scene};
            const Cell& cell = *files.cells(label).front();
            for (const auto& [checkpoint, errors] : cell.checkpoints) {
                if (!keeps_frame(1, checkpoint.passes, cell.last().passes)) continue;
                std::string said;
                const auto image = read_frame(folder, files.folder_of(cell), checkpoint.passes, &said);
                if (!said.empty()) damage.push_back(said + "; the image on the way is left out");
                if (!image) continue;
                const Image small = reduced(*image, 1 << halvings);
                if (small.width != entry["width"] || small.height != entry["height"]) continue;
                frames.push_back({.scene = scene,
                                  .image = i,
                                  .passes = checkpoint.passes,
                                  .seconds = checkpoint.seconds,
                                  .packed = pack_half(small.rgb, small.width, small.height, 3)});
            }
        }
    return frames;
}

/// The smallest number of octaves of passes between two frames of a cell with which all frames take at most `bytes`.
int octaves_apart(const std::vector<PackedFrame>& frames, std::size_t bytes) {
    constexpr int most = 32;  // passes have 32 bits, so that only the first frame is left
    for (int octaves = 1; octaves < most; ++octaves) {
        std::set<std::string_view> texts;
        std::size_t sum = 0;
        for (const PackedFrame& frame : frames)
            if (std::countr_zero(frame.passes) % octaves == 0 && texts.insert(frame.packed.text).second)
                sum += frame.packed.text.size();
        if (sum <= bytes) return octaves;
    }
    return most;
}

std::string note_of(const json& scenes, const std::vector<PackedFrame>& frames, int octaves) {
    std::string note;
    for (const auto& [scene, entry] : scenes.items())
        if (entry["reduction"] > 1)
            note += fmt::format("Images of {0} are shown at 1/{1} of the film's size: means of {1} x {1} pixels. ",
                                scene, entry["reduction"].get<int>());
    if (frames.empty())
        note += "No images on the way were kept in this folder: at every time the final image is shown. ";
    else if (octaves > 15) note += "To keep the page small, only the image after the first pass is kept on the way. ";
    else if (octaves > 1)
        note += fmt::format("To keep the page small, images on the way are those after 1, {}, {}, ... passes. ",
                            1u << octaves, 1u << (2 * octaves));
    return note;
}

}  // namespace

ReportPictures report_pictures(const Analysis& analysis, const ResultFolder& folder, const PictureBudget& budget) {
    constexpr int most_halvings = 4;
    Store store;
    json scenes;
    int halvings = -1;
    do {
        ++halvings;
        store = Store();
        scenes = json::object();
        for (const auto& quality : analysis.references)
            scenes[quality.scene] = scene_entry({analysis, folder, quality.scene}, halvings, store);
    } while (store.html().size() > budget.final_images && halvings < most_halvings);

    std::vector<std::string> damage;
    const auto frames = all_frames(analysis, folder, scenes, halvings, damage);
    const int octaves = octaves_apart(frames, budget.all - std::min(budget.all, store.html().size()));
    for (const PackedFrame& frame : frames)
        if (std::countr_zero(frame.passes) % octaves == 0)
            scenes[frame.scene]["images"][frame.image]["frames"].push_back(
                {{"passes", frame.passes}, {"seconds", frame.seconds}, {"image", store.add(frame.packed)}});
    return {.scenes = scenes, .elements = store.html(), .note = note_of(scenes, frames, octaves), .damage = damage};
}

std::string base64(std::span<const std::uint8_t> bytes) {
    std::string text(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
    base64_encode_raw(text.data(), bytes.size(), bytes.data());
    return text;
}

PackedImage pack_half(std::span<const float> values, int width, int height, int channels) {
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const auto count = static_cast<std::size_t>(channels);
    if (values.size() != pixels * count) throw std::invalid_argument("an image's size is not that of its values");
    PackedImage packed{
        .width = width, .height = height, .channels = channels, .exponent = scale_exponent(values), .text = {}};
    std::vector<std::uint8_t> bytes, low, high(pixels);
    bytes.reserve(2 * values.size());
    low.reserve(values.size());
    for (std::size_t c = 0; c < count; ++c) {
        for (std::size_t i = 0; i < pixels; ++i) {
            const auto half =
                Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(std::ldexp(values[count * i + c], packed.exponent)));
            high[i] = static_cast<std::uint8_t>(half >> 8);
            low.push_back(static_cast<std::uint8_t>(half & 255u));
        }
        append_differences(high, width, bytes);
    }
    bytes.insert(bytes.end(), low.begin(), low.end());
    packed.text = deflated_text(bytes);
    return packed;
}

}  // namespace gib
