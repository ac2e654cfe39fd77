#include "experiments/metrics/flip.h"

#include "common/core/error.h"
#include "common/core/math.h"
#include "common/core/parallel.h"
#include "experiments/metrics/robust_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace gib {

namespace {

constexpr std::size_t pixels_per_task = 4096;

/// The matrix from linear RGB (sRGB primaries, D65) to XYZ relative to white. Every row sums to 1, so that white is
/// (1, 1, 1).
Eigen::Matrix3d xyz_of_rgb() {
    Eigen::Matrix3d m;
    m << 0.412386563, 0.357591491, 0.180450490,  //
        0.212636822, 0.715182982, 0.072180196,   //
        0.019330620, 0.119197164, 0.950372587;
    return (m.array().colwise() / m.array().rowwise().sum()).matrix();
}

/// The matrix from XYZ relative to white to (Y, X - Y, Y - Z). These are YCxCz without its factors and its offset,
/// which commute with linear filters whose weights sum to 1.
Eigen::Matrix3d opponent_of_xyz() {
    Eigen::Matrix3d m;
    m << 0, 1, 0,  //
        1, -1, 0,  //
        0, 1, -1;
    return m;
}

using OpponentImage = std::array<Plane, 3>;  // in the order of OpponentChannel

OpponentImage opponent_image(const Image& image) {
    const Eigen::Matrix3f m = (opponent_of_xyz() * xyz_of_rgb()).cast<float>();
    const Plane empty(image.width, image.height);
    OpponentImage result{empty, empty, empty};
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const Vec3 v = m * image.at(i).matrix();
        for (std::size_t k = 0; k < 3; ++k)
            result[k].values[i] = v[static_cast<int>(k)];
    }
    return result;
}

/// The nonlinear curve of CIELab, which is linear below t = (6 / 29)^3.
float lightness_curve(float t) {
    constexpr float delta = 6.f / 29.f;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * sqr(delta)) + 4.f / 29.f;
}

/// CIELab from XYZ relative to white. a* and b* are scaled by L* / 100, because colours look less saturated in the
/// dark (the Hunt effect).
Vec3 hunt_lab(const Vec3& xyz) {
    const float x = lightness_curve(xyz[0]), y = lightness_curve(xyz[1]), z = lightness_curve(xyz[2]);
    const float lightness = 116 * y - 16;
    return {lightness, 0.01f * lightness * 500 * (x - y), 0.01f * lightness * 200 * (y - z)};
}

/// The HyAB distance, which suits large colour differences: it
/// adds the distance in lightness and the distance in chroma.
float hyab(const Vec3& a, const Vec3& b) {
    return std::abs(a[0] - b[0]) + std::sqrt(sqr(a[1] - b[1]) + sqr(a[2] - b[2]));
}

/// The visible colours: the image filtered with the contrast sensitivity of each channel, in CIELab
/// with the Hunt effect.
std::vector<Vec3> seen_colors(const OpponentImage& image, double pixels_per_degree) {
    const Plane y = contrast_filtered(image[0], OpponentChannel::achromatic, pixels_per_degree);
    const Plane xy = contrast_filtered(image[1], OpponentChannel::red_green, pixels_per_degree);
    const Plane yz = contrast_filtered(image[2], OpponentChannel::blue_yellow, pixels_per_degree);
    const Eigen::Matrix3d to_xyz = xyz_of_rgb();
    const Eigen::Matrix3f from_rgb = to_xyz.cast<float>();
    const Eigen::Matrix3f to_rgb = (opponent_of_xyz() * to_xyz).inverse().cast<float>();
    std::vector<Vec3> colors(y.values.size());
    parallel_blocks(colors.size(), pixels_per_task, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            // Filtered colours may lie outside of the range of a screen.
            const Vec3 rgb = to_rgb * Vec3(y.values[i], xy.values[i], yz.values[i]);
            colors[i] = hunt_lab(from_rgb * rgb.cwiseMax(0.f).cwiseMin(1.f));
        }
    });
    return colors;
}

/// Maps a compressed colour difference to [0, 1]. `exponent`, `share` and `knee_error` are q_c, p_c and p_t of
/// Andersson et al. 2020.
class ColorError {
public:
    float operator()(float distance) const {
        const float compressed = std::pow(distance, exponent);
        const float knee = share * largest_;
        if (compressed < knee) return knee_error / knee * compressed;
        return knee_error + (compressed - knee) / (largest_ - knee) * (1 - knee_error);
    }

private:
    static constexpr float exponent = 0.7f, share = 0.4f, knee_error = 0.95f;
    /// The compressed difference of green and blue, the largest that a screen can show.
    float largest_ = std::pow(hyab(hunt_lab(xyz_of_rgb().col(1).cast<float>()),  //
                                   hunt_lab(xyz_of_rgb().col(2).cast<float>())),
                              exponent);
};

void require_comparable(const Image& test, const Image& reference, double pixels_per_degree) {
    if (!test.same_size(reference))
        throw InputError(fmt::format("FLIP compares images of one size, not {} x {} with {} x {} pixels", test.width,
                                     test.height, reference.width, reference.height));
    if (test.pixels() == 0) throw InputError("FLIP needs at least one pixel");
    if (!std::isfinite(pixels_per_degree) || pixels_per_degree < 1)
        throw InputError(fmt::format("FLIP needs one pixel per degree or more, not {:g}", pixels_per_degree));
    for (const Image* image : {&test, &reference})
        if (image->non_finite_values() > 0)
            throw InputError("FLIP is undefined for images with values that are not finite");
}

/// Coefficients of filmic(x) = (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5), Narkowicz's fit to ACES; its exposure of 0.6
/// is multiplied into them.
constexpr double k0 = 0.6 * 0.6 * 2.51, k1 = 0.6 * 0.03, k3 = 0.6 * 0.6 * 2.43, k4 = 0.6 * 0.59, k5 = 0.14;

/// The x >= 0 with filmic(x) = y, for y in [0, 1].
double inverse_filmic(double y) {
    const double a = k0 - k3 * y, half_b = (k1 - k4 * y) / 2, c = -k5 * y;
    return (-half_b + std::sqrt(sqr(half_b) - a * c)) / a;
}

Image displayed(const Image& image, double exposure) {
    const double factor = std::exp2(exposure);
    Image result(image.width, image.height);
    parallel_blocks(image.rgb.size(), pixels_per_task, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i)
            result.rgb[i] = static_cast<float>(filmic(factor * std::max(0.0, double{image.rgb[i]})));
    });
    return result;
}

constexpr std::size_t rows_per_task = 16;

/// Calls body(y) for every row, in parallel.
void for_rows(int height, const std::function<void(int)>& body) {
    parallel_blocks(static_cast<std::size_t>(height), rows_per_task,
                    [&](std::size_t begin, std::size_t end, std::size_t) {
                        for (std::size_t y = begin; y < end; ++y)
                            body(static_cast<int>(y));
                    });
}

int radius_of(const FilterKernel& kernel) { return static_cast<int>(kernel.size() / 2); }

/// Adds weight * values to a row of sums.
void add_row(float* sum, const float* values, float weight, int width) {
    for (int x = 0; x < width; ++x)
        sum[x] += weight * values[x];
}

/// One term a sqrt(pi / b) exp(-(pi x)^2 / b) of a contrast sensitivity filter, with x in degrees.
struct SensitivityTerm {
    double a, b;
};

/// Table 1 of the paper; a second term with a = 0 adds nothing.
constexpr std::array<std::array<SensitivityTerm, 2>, 3> sensitivities = {{
    {{{1, 0.0047}, {0, 1}}},
    {{{1, 0.0053}, {0, 1}}},
    {{{34.1, 0.04}, {13.5, 0.025}}},
}};
constexpr double largest_b = 0.04;

/// f(x) for the integers from -radius to radius.
std::vector<double> samples_of(int radius, const std::function<double(double)>& f) {
    std::vector<double> values;
    for (int x = -radius; x <= radius; ++x)
        values.push_back(f(x));
    return values;
}

/// Scales the weights so that the positive ones sum to 1 and the negative ones to -1.
FilterKernel normalised(const std::vector<double>& weights) {
    double positive = 0, negative = 0;
    for (const double w : weights)
        (w > 0 ? positive : negative) += std::abs(w);
    FilterKernel kernel;
    for (const double w : weights)
        kernel.push_back(static_cast<float>(w > 0 ? w / positive : w < 0 ? w / negative : 0));
    return kernel;
}

/// Removes outer weights that are too small to change a sum of floats.
FilterKernel trimmed(FilterKernel kernel) {
    constexpr float negligible = 1e-9f;
    while (kernel.size() > 1 && kernel.front() < negligible && kernel.back() < negligible) {
        kernel.pop_back();
        kernel.erase(kernel.begin());
    }
    return kernel;
}

Plane length_of(const Plane& a, const Plane& b) {
    Plane length(a.width, a.height);
    for (std::size_t i = 0; i < length.values.size(); ++i)
        length.values[i] = std::sqrt(sqr(a.values[i]) + sqr(b.values[i]));
    return length;
}

/// Both functions repeat the outermost pixels of the image beyond its borders.
Plane filtered_along_rows(const Plane& plane, const FilterKernel& kernel) {
    Plane result(plane.width, plane.height);
    const int radius = radius_of(kernel), width = plane.width;
    for_rows(plane.height, [&](int y) {
        std::vector<float> extended(static_cast<std::size_t>(width + 2 * radius));
        for (int x = 0; x < width + 2 * radius; ++x)
            extended[static_cast<std::size_t>(x)] = plane.row(y)[std::clamp(x - radius, 0, width - 1)];
        for (std::size_t k = 0; k < kernel.size(); ++k)
            add_row(result.row(y), extended.data() + k, kernel[k], width);
    });
    return result;
}

Plane filtered_along_columns(const Plane& plane, const FilterKernel& kernel) {
    Plane result(plane.width, plane.height);
    const int radius = radius_of(kernel);
    for_rows(plane.height, [&](int y) {
        for (std::size_t k = 0; k < kernel.size(); ++k) {
            const int from = std::clamp(y + static_cast<int>(k) - radius, 0, plane.height - 1);
            add_row(result.row(y), plane.row(from), kernel[k], plane.width);
        }
    });
    return result;
}

}  // namespace

double FlipMap::mean() const {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double filmic(double x) { return std::clamp(x * (k0 * x + k1) / (x * (k3 * x + k4) + k5), 0.0, 1.0); }

ExposureRange flip_exposures(const Image& reference) {
    constexpr double shown = 0.85;
    std::vector<float> luminances;
    for (std::size_t i = 0; i < reference.pixels(); ++i)
        luminances.push_back(luminance(reference.at(i).max(0.f)));
    const double largest = luminances.empty() ? 0 : static_cast<double>(*std::ranges::max_element(luminances));
    if (largest == 0) return {0, 0, 2};
    const double darkest = std::ldexp(largest, -24);
    double median = median_of(luminances);
    if (median < darkest) {
        std::erase_if(luminances, [&](float y) { return static_cast<double>(y) < darkest; });
        median = median_of(luminances);
    }
    const double start = std::log2(inverse_filmic(shown) / largest), stop = std::log2(inverse_filmic(shown) / median);
    return {start, stop, std::max(2, static_cast<int>(std::ceil(stop - start)))};
}

FlipMap ldr_flip(const Image& test, const Image& reference, double pixels_per_degree) {
    require_comparable(test, reference, pixels_per_degree);
    const OpponentImage a = opponent_image(test), b = opponent_image(reference);
    const std::vector<Vec3> color_a = seen_colors(a, pixels_per_degree), color_b = seen_colors(b, pixels_per_degree);
    const Features features_a = detected_features(a[0], pixels_per_degree);
    const Features features_b = detected_features(b[0], pixels_per_degree);
    const ColorError color_error;
    FlipMap map{test.width, test.height, std::vector<float>(test.pixels())};
    parallel_blocks(map.values.size(), pixels_per_task, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const float edge = std::abs(features_a.edges.values[i] - features_b.edges.values[i]);
            const float point = std::abs(features_a.points.values[i] - features_b.points.values[i]);
            // The exponent q_f of the paper is 1/2.
            const float feature = std::min(1.f, std::sqrt(std::max(edge, point) * std::numbers::sqrt2_v<float> / 2));
            const float color = std::min(1.f, color_error(hyab(color_a[i], color_b[i])));
            map.values[i] = std::pow(color, 1 - feature);
        }
    });
    return map;
}

FlipMap hdr_flip(const Image& test, const Image& reference, double pixels_per_degree) {
    require_comparable(test, reference, pixels_per_degree);
    const ExposureRange range = flip_exposures(reference);
    FlipMap worst{test.width, test.height, std::vector<float>(test.pixels(), 0.f)};
    for (int i = 0; i < range.count; ++i) {
        const double exposure = range.at(i);
        const FlipMap map = ldr_flip(displayed(test, exposure), displayed(reference, exposure), pixels_per_degree);
        for (std::size_t p = 0; p < map.values.size(); ++p)
            worst.values[p] = std::max(worst.values[p], map.values[p]);
    }
    return worst;
}

std::vector<GaussianTerm> contrast_filter(OpponentChannel channel, double pixels_per_degree) {
    // The radius of all terms is three standard deviations of the widest Gaussian.
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(largest_b / (2 * sqr(std::numbers::pi))) * pixels_per_degree));
    std::vector<GaussianTerm> terms;
    double all = 0;
    for (const auto& [a, b] : sensitivities[static_cast<std::size_t>(channel)]) {
        if (a == 0) continue;
        const auto weights = samples_of(
            radius, [&, b = b](double x) { return std::exp(-sqr(std::numbers::pi * x / pixels_per_degree) / b); });
        // The sum of a two-dimensional Gaussian over the square of pixels is the square of its sum over a line.
        const double sum =
            a * std::sqrt(std::numbers::pi / b) * sqr(std::accumulate(weights.begin(), weights.end(), 0.0));
        terms.push_back({static_cast<float>(sum), trimmed(normalised(weights))});
        all += sum;
    }
    for (auto& term : terms)
        term.share = static_cast<float>(static_cast<double>(term.share) / all);
    return terms;
}

Plane contrast_filtered(const Plane& plane, OpponentChannel channel, double pixels_per_degree) {
    Plane result(plane.width, plane.height);
    for (const auto& [share, kernel] : contrast_filter(channel, pixels_per_degree)) {
        const Plane term = filtered_along_columns(filtered_along_rows(plane, kernel), kernel);
        for (std::size_t i = 0; i < result.values.size(); ++i)
            result.values[i] += share * term.values[i];
    }
    return result;
}

Features detected_features(const Plane& luminance, double pixels_per_degree) {
    constexpr double feature_width = 0.082;  // [degrees], w of the paper
    const double deviation = 0.5 * feature_width * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const auto gaussian = [&](double x) { return std::exp(-sqr(x / deviation) / 2); };
    // Each filter is a derivative along one axis and the Gaussian along the other.
    const FilterKernel smooth = normalised(samples_of(radius, gaussian));
    const FilterKernel first = normalised(samples_of(radius, [&](double x) { return -x * gaussian(x); }));
    const FilterKernel second =
        normalised(samples_of(radius, [&](double x) { return (sqr(x / deviation) - 1) * gaussian(x); }));
    const Plane smooth_rows = filtered_along_rows(luminance, smooth);
    const auto magnitude = [&](const FilterKernel& derivative) {
        return length_of(filtered_along_columns(filtered_along_rows(luminance, derivative), smooth),
                         filtered_along_columns(smooth_rows, derivative));
    };
    return {magnitude(first), magnitude(second)};
}

}  // namespace gib
