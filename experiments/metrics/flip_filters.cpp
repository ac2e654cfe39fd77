#include "experiments/metrics/flip_filters.h"

#include "common/core/math.h"
#include "common/core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace gib {

namespace {

constexpr std::size_t rows_per_task = 16;

/// Calls body(y) for every row, in parallel.
void for_rows(int height, const std::function<void(int)>& body) {
    parallel_blocks(static_cast<std::size_t>(height), rows_per_task,
                    [&](std::size_t begin, std::size_t end, std::size_t) {
                        for (std::size_t y = begin; y < end; ++y)
                            body(static_cast<int>(y));
                    });
}

int radius_of(const Kernel& kernel) { return static_cast<int>(kernel.size() / 2); }

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
Kernel normalised(const std::vector<double>& weights) {
    double positive = 0, negative = 0;
    for (const double w : weights)
        (w > 0 ? positive : negative) += std::abs(w);
    Kernel kernel;
    for (const double w : weights)
        kernel.push_back(static_cast<float>(w > 0 ? w / positive : w < 0 ? w / negative : 0));
    return kernel;
}

/// Removes outer weights that are too small to change a sum of floats.
Kernel trimmed(Kernel kernel) {
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

}  // namespace

Plane filtered_along_rows(const Plane& plane, const Kernel& kernel) {
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

Plane filtered_along_columns(const Plane& plane, const Kernel& kernel) {
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
    const Kernel smooth = normalised(samples_of(radius, gaussian));
    const Kernel first = normalised(samples_of(radius, [&](double x) { return -x * gaussian(x); }));
    const Kernel second =
        normalised(samples_of(radius, [&](double x) { return (sqr(x / deviation) - 1) * gaussian(x); }));
    const Plane smooth_rows = filtered_along_rows(luminance, smooth);
    const auto magnitude = [&](const Kernel& derivative) {
        return length_of(filtered_along_columns(filtered_along_rows(luminance, derivative), smooth),
                         filtered_along_columns(smooth_rows, derivative));
    };
    return {magnitude(first), magnitude(second)};
}

}  // namespace gib
