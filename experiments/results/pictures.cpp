#include "experiments/results/pictures.h"

#include "common/color/srgb.h"
#include "common/core/error.h"
#include "common/core/files.h"
#include "common/images/image_digest.h"
#include "common/images/image_file.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>

namespace gib {

using nlohmann::json;

namespace {

std::string frame_folder(const ResultFolder& folder, const std::string& cell_name) {
    return folder.cell_folder(cell_name) + "/frames";
}

std::string frame_path(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes) {
    return frame_folder(folder, cell_name) + "/" + std::to_string(passes) + ".exr";
}

/// The value as a half float; a value outside the range in which halves have full precision is kept.
float rounded(float v) {
    constexpr float least = 6.103515625e-5f, largest = 65504.f;
    const float size = std::abs(v);
    return size >= least && size <= largest ? static_cast<float>(Eigen::half(v)) : v;
}

std::string record_path(const ResultFolder& folder, const std::string& cell_name) {
    return folder.cell_folder(cell_name) + "/flip.json";
}

/// The facts in a record beside the value: digests of its two images and of the map's file. The last is null if there
/// is no map, because there is no value.
json facts_of(const Image& total, const Image& r_total, const std::string& map) {
    return {{"image", image_digest({{{"", total}}, {}})},
            {"reference", image_digest({{{"", r_total}}, {}})},
            {"map", std::filesystem::exists(map) ? json(file_hash(map)) : json(nullptr)}};
}

bool is_flip(const json& value) {
    return value.is_null() || (value.is_number() && value.get<double>() >= 0 && value.get<double>() <= 1);
}

/// The stored record. Null if there is none, if it or the map is damaged, or if it is not about these images.
json stored_record(const std::string& path, const Image& total, const Image& r_total, const std::string& map) {
    if (!std::filesystem::exists(path)) return nullptr;
    try {
        json record = read_sealed_json(path);
        if (record.is_null() || !is_flip(record.at("flip"))) return nullptr;
        const json facts = facts_of(total, r_total, map);
        for (const auto& [name, fact] : facts.items())
            if (record.at(name) != fact) return nullptr;
        return record;
    } catch (const json::exception&) {
        return nullptr;
    } catch (const InputError&) {
        return nullptr;
    }
}

/// Measures FLIP and writes its map. Empty, and nothing is written, if an image is not finite.
std::optional<double> measure_flip(const Image& total, const Image& r_total, const std::string& map_file) {
    if (total.non_finite_values() + r_total.non_finite_values() > 0) return std::nullopt;
    const FlipMap map = hdr_flip(total, r_total);
    const auto png = encode_png(flip_image(map), 1.f);
    write_file(map_file, {reinterpret_cast<const char*>(png.data()), png.size()});
    return map.mean();
}

}  // namespace

Color scale_color(ColorScale steps, float t) {
    const float position = std::clamp(t, 0.f, 1.f) * static_cast<float>(steps.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(position), steps.size() - 2);
    const float share = position - static_cast<float>(i);
    return steps[i] * (1 - share) + steps[i + 1] * share;
}

float exposure_for(const Image& image) {
    constexpr double middle = 0.3;  // linear; 0.58 in sRGB
    double mean = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i)
        mean += static_cast<double>(luminance(image.at(i)));
    mean /= static_cast<double>(std::max<std::size_t>(image.pixels(), 1));
    return std::isfinite(mean) && mean > 0 ? static_cast<float>(middle / mean) : 1.f;
}

ColorScale error_colors() {
    static const std::array<Color, 5> colors = {Color(0.0f, 0.0f, 0.02f), Color(0.34f, 0.06f, 0.43f),
                                                Color(0.73f, 0.21f, 0.33f), Color(0.98f, 0.55f, 0.04f),
                                                Color(0.99f, 1.0f, 0.64f)};
    return colors;
}

ColorScale magma_colors() {
    static const std::array<Color, 16> colors = {
        Color(0.001462f, 0.000466f, 0.013866f), Color(0.043830f, 0.033830f, 0.141886f),
        Color(0.123833f, 0.067295f, 0.295879f), Color(0.232077f, 0.059889f, 0.437695f),
        Color(0.341482f, 0.080564f, 0.492631f), Color(0.445163f, 0.122724f, 0.506901f),
        Color(0.550287f, 0.161158f, 0.505719f), Color(0.658483f, 0.196027f, 0.490253f),
        Color(0.767398f, 0.233705f, 0.457755f), Color(0.868793f, 0.287728f, 0.409303f),
        Color(0.944006f, 0.377643f, 0.365136f), Color(0.981000f, 0.498428f, 0.369734f),
        Color(0.994738f, 0.624350f, 0.427397f), Color(0.997228f, 0.747981f, 0.516859f),
        Color(0.993170f, 0.870024f, 0.626189f), Color(0.987053f, 0.991438f, 0.749504f)};
    return colors;
}

ColorScale bias_colors() {
    static const std::array<Color, 5> colors = {Color(0.02f, 0.19f, 0.38f), Color(0.26f, 0.58f, 0.76f),
                                                Color(0.97f, 0.97f, 0.97f), Color(0.84f, 0.38f, 0.30f),
                                                Color(0.40f, 0.00f, 0.12f)};
    return colors;
}

Image flip_image(const FlipMap& map) {
    const ColorScale colors = magma_colors();
    Image image(map.width, map.height);
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const Color srgb = scale_color(colors, map.values[i]);
        image.set(i, {linear_from_srgb(srgb[0]), linear_from_srgb(srgb[1]), linear_from_srgb(srgb[2])});
    }
    return image;
}

Image flip_values(const Image& picture) {
    constexpr int steps = 256;
    std::array<Color, steps> table;
    for (int i = 0; i < steps; ++i)
        table[static_cast<std::size_t>(i)] =
            scale_color(magma_colors(), static_cast<float>(i) / static_cast<float>(steps - 1));
    Image values(picture.width, picture.height);
    for (std::size_t p = 0; p < picture.pixels(); ++p) {
        const Color linear = picture.at(p);
        const Color color(srgb_from_linear(linear[0]), srgb_from_linear(linear[1]), srgb_from_linear(linear[2]));
        const auto nearest =
            std::ranges::min_element(table, {}, [&](const Color& step) { return (color - step).square().sum(); });
        values.set(p, Color::Constant(static_cast<float>(nearest - table.begin()) / static_cast<float>(steps - 1)));
    }
    return values;
}

int reduction_for(int width, int height, int largest) {
    return std::max(1, (std::max(width, height) + largest - 1) / largest);
}

Image reduced(const Image& image, int factor) {
    if (factor <= 1) return image;
    Image small((image.width + factor - 1) / factor, (image.height + factor - 1) / factor);
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            std::array<double, 3> sum{};
            int count = 0;
            for (int v = y * factor; v < std::min((y + 1) * factor, image.height); ++v)
                for (int u = x * factor; u < std::min((x + 1) * factor, image.width); ++u, ++count)
                    for (std::size_t k = 0; k < 3; ++k)
                        sum[k] += double{image.rgb[3 * static_cast<std::size_t>(v * image.width + u) + k]};
            for (std::size_t k = 0; k < 3; ++k)
                small.rgb[3 * static_cast<std::size_t>(y * small.width + x) + k] = static_cast<float>(sum[k] / count);
        }
    return small;
}

bool keeps_frame(std::uint64_t seed, std::uint32_t passes, std::uint32_t last_passes) {
    return seed == 1 && passes < last_passes && std::has_single_bit(passes);
}

void write_frame(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes, const Image& total) {
    ResultFolder::make(frame_folder(folder, cell_name));
    Image frame = reduced(total, reduction_for(total.width, total.height, frame_size));
    std::ranges::transform(frame.rgb, frame.rgb.begin(), rounded);
    write_exr(frame_path(folder, cell_name, passes), {{{"", std::move(frame)}}, {}});
}

std::optional<Image> read_frame(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes,
                                std::string* damage) {
    const std::string path = frame_path(folder, cell_name, passes);
    if (!std::filesystem::exists(path)) return std::nullopt;
    try {
        const LayeredImage file = read_image(path);
        return file.layers.front().second;
    } catch (const InputError&) {
        if (damage) *damage = fmt::format("{}: it cannot be read", path);
        return std::nullopt;
    }
}

bool has_frame(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes) {
    return std::filesystem::exists(frame_path(folder, cell_name, passes));
}

void forget_frames(const ResultFolder& folder, const std::string& cell_name) {
    std::filesystem::remove_all(frame_folder(folder, cell_name));
}

std::optional<double> cell_flip(const ResultFolder& folder, const std::string& cell_name, const Image& total,
                                const Image& r_total) {
    const std::string path = record_path(folder, cell_name), map = folder.flip_map(cell_name);
    json record = stored_record(path, total, r_total, map);
    if (record.is_null()) {
        forget_flip(folder, cell_name);
        const auto flip = measure_flip(total, r_total, map);
        record = facts_of(total, r_total, map);
        record["flip"] = flip ? json(*flip) : json(nullptr);
        write_sealed_json(path, record);  // last, so that a record implies a complete map
    }
    const json& flip = record["flip"];
    return flip.is_number() ? std::optional(flip.get<double>()) : std::nullopt;
}

void forget_flip(const ResultFolder& folder, const std::string& cell_name) {
    std::filesystem::remove(record_path(folder, cell_name));
    std::filesystem::remove(folder.flip_map(cell_name));
}

}  // namespace gib
