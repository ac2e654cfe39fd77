#include "experiments/program/compare_words.h"

#include "common/color/srgb.h"
#include "common/core/math.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/metrics/z_statistic.h"
#include "experiments/results/pictures.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace gib {

namespace {

Image scaled(Image image, double factor) {
    for (float& value : image.rgb)
        value = static_cast<float>(static_cast<double>(value) * factor);
    return image;
}

/// The image with pixel (x, y) from (columns(x), rows(y)).
Image turned(const Image& image, bool mirrored, bool upside_down) {
    Image result(image.width, image.height);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const int from_x = mirrored ? image.width - 1 - x : x, from_y = upside_down ? image.height - 1 - y : y;
            const auto place = [&](int column, int row) {
                return static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(column);
            };
            result.set(place(x, y), image.at(place(from_x, from_y)));
        }
    return result;
}

Image with_red_and_blue_swapped(Image image) {
    for (std::size_t p = 0; p < image.pixels(); ++p)
        std::swap(image.rgb[3 * p], image.rgb[3 * p + 2]);
    return image;
}

/// The squared relative error that is left after the image is scaled by its own brightness.
double scaled_error2(const Image& image, const ReferenceLayer& reference, const Denominators& denominators) {
    const double factor = brightness(image, reference.mean, denominators.epsilon()).factor;
    const Image& total = denominators.plain();
    double sum = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        sum += sqr(double{image.rgb[i]} / factor - double{reference.mean.rgb[i]}) /
               (sqr(double{total.rgb[i]}) + denominators.epsilon());
    return sum / static_cast<double>(image.rgb.size());
}

/// How the image would fit better; empty if it does not, by half of the squared error at least.
std::string better_fit(const Image& image, const ReferenceLayer& reference, const Denominators& denominators) {
    const double plain = scaled_error2(image, reference, denominators);
    std::string best;
    double least = plain / 2;
    for (const auto& [name, other] : {std::pair("upside down", turned(image, false, true)),
                                      {"mirrored left to right", turned(image, true, false)},
                                      {"turned by 180 degrees", turned(image, true, true)},
                                      {"with red and blue swapped", with_red_and_blue_swapped(image)}})
        if (const double error2 = scaled_error2(other, reference, denominators); error2 < least) {
            least = error2;
            best = name;
        }
    return best;
}

Image without_srgb_curve(Image image) {
    for (float& value : image.rgb)
        value = linear_from_srgb(value);
    return image;
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// How unlike the image is to any multiple of the reference: the median distance of log(image / reference), of each
/// block of 8 x 8 pixels and each channel, from the median. Values with a 0 in `counts` are left out. Empty for less
/// than 8 numbers.
std::optional<double> spread_of_ratios(const Image& image, const Image& reference, const std::vector<char>& counts) {
    const Grid grid = Grid::with_edge(reference.width, reference.height, z_block_edge);
    std::vector<double> logs;
    for (std::size_t b = 0; b < grid.size(); ++b)
        for (std::size_t k = 0; k < 3; ++k) {
            double of_image = 0, of_reference = 0;
            grid.for_each_in(b, [&](int x, int y) {
                const std::size_t i = 3 * static_cast<std::size_t>(y * reference.width + x) + k;
                if (counts[i] == 0) return;
                of_image += double{image.rgb[i]};
                of_reference += double{reference.rgb[i]};
            });
            if (of_image > 0 && of_reference > 0) logs.push_back(std::log(of_image / of_reference));
        }
    if (logs.size() < 8) return std::nullopt;
    const double middle = median_of(logs);
    for (double& log : logs)
        log = std::abs(log - middle);
    return median_of(logs);
}

bool is_grey(const Image& image) {
    for (std::size_t p = 0; p < image.pixels(); ++p)
        if (image.rgb[3 * p] != image.rgb[3 * p + 1] || image.rgb[3 * p] != image.rgb[3 * p + 2]) return false;
    return true;
}

}  // namespace

bool Brightness::differs() const { return std::abs(factor - 1) > std::max(0.01, 4 * deviation); }

// A ratio of weighted sums over blocks, whose variance is that of its residuals (Cochran 1977, "Sampling Techniques",
// section 6.4). Every block has the weight of its mean in the reference, which has much less noise than a pixel: with a
// weight 1 / r for each pixel, the noise of r would make equal images "too bright".
Brightness brightness(const Image& image, const Image& reference, double epsilon) {
    struct Block {
        double image = 0, reference = 0, values = 0;
    };
    const Grid grid = Grid::with_edge(reference.width, reference.height, z_block_edge);
    std::vector<Block> blocks(grid.size());
    for (std::size_t b = 0; b < blocks.size(); ++b)
        grid.for_each_in(b, [&](int x, int y) {
            const auto pixel = static_cast<std::size_t>(y * reference.width + x);
            for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
                blocks[b].image += double{image.rgb[i]};
                blocks[b].reference += double{reference.rgb[i]};
                ++blocks[b].values;
            }
        });
    const auto weight = [&](const Block& b) { return 1 / std::sqrt(sqr(b.reference / b.values) + epsilon); };
    double of_image = 0, of_reference = 0, variance = 0;
    for (const Block& block : blocks) {
        of_image += weight(block) * block.image;
        of_reference += weight(block) * block.reference;
    }
    if (!(of_image > 0) || !(of_reference > 0)) return {};
    const double factor = of_image / of_reference;
    for (const Block& block : blocks)
        variance += sqr(weight(block) * (block.image - factor * block.reference));
    return {factor, std::sqrt(variance) / of_reference};
}

// Without the curve the spread falls to that of the noise. Over seven scenes and curves of exposures from 1/4 to 16,
// clipped or not, it fell to 0.01 to 0.3 of what it was, wherever the noise of blocks was small. Of right images it
// grew, and of images with fog over them (a constant added) it fell to 0.25 at most.
bool has_srgb_curve(const Image& image, const Image& reference) {
    constexpr double least_contrast = 0.02, most_left = 0.25;
    if (image.non_finite_values() > 0) return false;
    // Values of 1 are clipped ones if none is above.
    constexpr float white = 0.999f;
    const bool is_clipped = std::ranges::max(image.rgb) <= 2 - white;
    std::vector<char> counts(image.rgb.size());
    std::ranges::transform(image.rgb, counts.begin(), [&](float v) { return !is_clipped || v < white ? 1 : 0; });
    const auto plain = spread_of_ratios(image, reference, counts);
    const auto linear = spread_of_ratios(without_srgb_curve(image), reference, counts);
    return plain && linear && *plain > least_contrast && *linear < most_left * *plain;
}

std::string comparison_sentence(const std::vector<Image>& images, const ReferenceLayer& reference,
                                const Denominators& denominators) {
    for (const Image& image : images)
        if (image.non_finite_values() > 0) return "values that are not finite have no error";
    std::vector<Image> tests = images;
    std::string text = is_black(mean_image(tests)) ? "black; " : "";
    if (has_srgb_curve(mean_image(tests), reference.mean)) {
        text = "the sRGB curve of displays was applied, which radiance does not have; without it, ";
        std::ranges::transform(tests, tests.begin(), [](const Image& test) { return without_srgb_curve(test); });
    }
    const Image mean = mean_image(tests);
    const Brightness of_mean = brightness(mean, reference.mean, denominators.epsilon());
    const bool is_scaled = of_mean.differs();
    std::vector<Image> compared;
    for (const Image& test : tests)
        compared.push_back(is_scaled ? scaled(test, 1 / of_mean.factor) : test);
    const double error2 = replicate_statistics(compared, reference, denominators).rel_mse_corrected;
    const double resolved = least_resolved(reference, denominators);
    if (is_scaled)
        text += fmt::format("{} times too {}; scaled, ",
                            short_number(of_mean.factor > 1 ? of_mean.factor : 1 / of_mean.factor),
                            of_mean.factor > 1 ? "bright" : "dark");
    if (resolved > 0 && error2 <= resolved)
        text += fmt::format("the rest is within the reference's noise of {} %",
                            percent_text(relative_standard_error(reference, denominators)));
    else text += fmt::format("relative RMSE {} %", percent_text(std::sqrt(at_least_zero(error2))));
    if (const std::string fit = better_fit(mean, reference, denominators); !fit.empty()) text += "; fits better " + fit;
    return text;
}

std::string doubts_about_image(const Image& image, const Image& other) {
    if (image.non_finite_values() > 0) return "";
    if (is_black(image) && !is_black(other)) return "it is black";
    std::string doubts;
    const auto add = [&](const std::string& doubt) { doubts += (doubts.empty() ? "" : "; ") + doubt; };
    const std::set<float> levels(image.rgb.begin(), image.rgb.end());
    if (levels.size() < 2) return "";
    constexpr std::size_t byte_levels = 256;
    if (levels.size() <= byte_levels && image.rgb.size() >= 16 * byte_levels)
        add(fmt::format("it has {} different values only, as an image of 8 bits has", levels.size()));
    // A lamp in the picture has many pixels of one value, too, but so it has in the other image.
    const float largest = *levels.rbegin();
    const float shown = has_srgb_curve(image, other) ? linear_from_srgb(largest) : largest;
    const auto is_largest = std::ranges::count(image.rgb, largest);
    const auto is_above = std::ranges::count_if(other.rgb, [&](float value) { return value > 1.05f * shown; });
    if (largest > 0 && is_largest >= 4 && 2 * is_above >= is_largest)
        add(fmt::format("it is clipped at {}, where the other is brighter", short_number(double{largest})));
    if (is_grey(image) && !is_grey(other)) add("it is grey, and the other has colours");
    return doubts;
}

Image difference_image(const Image& image, const Image& reference, double epsilon) {
    Image difference(image.width, image.height);
    for (std::size_t p = 0; p < image.pixels(); ++p) {
        double mean = 0;
        for (std::size_t i = 3 * p; i < 3 * p + 3; ++i)
            mean += (double{image.rgb[i]} - double{reference.rgb[i]}) /
                    std::sqrt(sqr(double{reference.rgb[i]}) + epsilon) / 3;
        const Color srgb = scale_color(bias_colors(), static_cast<float>(std::isfinite(mean) ? 0.5 + 0.5 * mean : 1));
        difference.set(p, {linear_from_srgb(srgb[0]), linear_from_srgb(srgb[1]), linear_from_srgb(srgb[2])});
    }
    return difference;
}

}  // namespace gib
