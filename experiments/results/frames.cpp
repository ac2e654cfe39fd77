#include "experiments/results/frames.h"

#include "common/core/error.h"
#include "common/images/image_file.h"

#include <fmt/format.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>

namespace gib {

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

}  // namespace

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

}  // namespace gib
