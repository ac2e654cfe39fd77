#pragma once
// LDR-FLIP as its paper writes it down, in double and by plain sums over square kernels: slow, and independent of the
// shortcuts of experiments/metrics.

#include "common/images/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace gib::test::paper {

/// An image with one value a pixel.
struct Grid {
    int width, height;
    std::vector<double> values;
    double at(int x, int y) const {
        const int column = std::clamp(x, 0, width - 1), line = std::clamp(y, 0, height - 1);
        return values[static_cast<std::size_t>(line * width + column)];
    }
};

/// Weights of the offsets (x, y), both from -radius to radius.
struct SquareKernel {
    int radius;
    std::function<double(int x, int y)> weight;
};

inline Grid filtered(const Grid& grid, const SquareKernel& kernel) {
    Grid result{grid.width, grid.height, {}};
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            double sum = 0;
            for (int dy = -kernel.radius; dy <= kernel.radius; ++dy)
                for (int dx = -kernel.radius; dx <= kernel.radius; ++dx)
                    sum += kernel.weight(dx, dy) * grid.at(x + dx, y + dy);
            result.values.push_back(sum);
        }
    return result;
}

/// Scales the weights so that those of each sign sum to 1 in absolute value.
inline SquareKernel normalised(const SquareKernel& kernel) {
    double positive = 0, negative = 0;
    for (int y = -kernel.radius; y <= kernel.radius; ++y)
        for (int x = -kernel.radius; x <= kernel.radius; ++x) {
            positive += std::max(0.0, kernel.weight(x, y));
            negative += std::max(0.0, -kernel.weight(x, y));
        }
    return {kernel.radius, [=](int x, int y) {
                const double w = kernel.weight(x, y);
                return w > 0 ? w / positive : w < 0 ? w / negative : 0;
            }};
}

inline Eigen::Matrix3d xyz_of_rgb() {
    Eigen::Matrix3d m;
    m << 0.412386563, 0.357591491, 0.180450490, 0.212636822, 0.715182982, 0.072180196, 0.019330620, 0.119197164,
        0.950372587;
    return m;
}
inline Vec3d white() { return xyz_of_rgb() * Vec3d::Ones(); }

/// L, a, b of linear RGB, with Hunt's adjustment.
inline Colord hunt_lab(const Colord& rgb) {
    const Vec3d xyz = (xyz_of_rgb() * rgb.matrix()).cwiseQuotient(white());
    const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (t * 24389 / 27 + 16) / 116; };
    const double lightness = 116 * f(xyz[1]) - 16;
    return {lightness, lightness / 100 * 500 * (f(xyz[0]) - f(xyz[1])),
            lightness / 100 * 200 * (f(xyz[1]) - f(xyz[2]))};
}

inline double hyab(const Colord& a, const Colord& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// The colour error, from 0 to 1, of two colours of hunt_lab.
inline double color_error(const Colord& a, const Colord& b) {
    const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7), knee = 0.4 * largest;
    const double error = std::pow(hyab(a, b), 0.7);
    return error < knee ? 0.95 * error / knee : 0.95 + 0.05 * (error - knee) / (largest - knee);
}

/// The three channels of YCxCz.
inline std::array<Grid, 3> opponent(const Image& image) {
    const Grid empty{image.width, image.height, {}};
    std::array<Grid, 3> channels = {empty, empty, empty};
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const Vec3d xyz = (xyz_of_rgb() * image.at(i).matrix().cast<double>()).cwiseQuotient(white());
        channels[0].values.push_back(116 * xyz[1] - 16);
        channels[1].values.push_back(500 * (xyz[0] - xyz[1]));
        channels[2].values.push_back(200 * (xyz[1] - xyz[2]));
    }
    return channels;
}

inline SquareKernel sensitivity(std::size_t channel, double pixels_per_degree) {
    constexpr std::array<std::array<double, 4>, 3> constants = {
        {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};
    constexpr double pi2 = std::numbers::pi * std::numbers::pi;
    const auto& c = constants[channel];
    const double a1 = c[0], b1 = c[1], a2 = c[2], b2 = c[3];
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi2)) * pixels_per_degree));
    return normalised({radius, [=](int x, int y) {
                           const double d2 = (x * x + y * y) / (pixels_per_degree * pixels_per_degree);
                           return a1 * std::sqrt(std::numbers::pi / b1) * std::exp(-pi2 * d2 / b1) +
                                  a2 * std::sqrt(std::numbers::pi / b2) * std::exp(-pi2 * d2 / b2);
                       }});
}

inline std::vector<Colord> seen(const Image& image, double pixels_per_degree) {
    const auto channels = opponent(image);
    std::array<Grid, 3> f = channels;
    for (std::size_t c = 0; c < 3; ++c)
        f[c] = filtered(channels[c], sensitivity(c, pixels_per_degree));
    std::vector<Colord> colors;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const double y = (f[0].values[i] + 16) / 116;
        const Vec3d xyz = Vec3d(y + f[1].values[i] / 500, y, y - f[2].values[i] / 200).cwiseProduct(white());
        const Vec3d rgb = xyz_of_rgb().inverse() * xyz;
        colors.push_back(hunt_lab(rgb.cwiseMax(0.0).cwiseMin(1.0).array()));
    }
    return colors;
}

/// The strength of a feature at each pixel: the length of the filter's responses along x and, turned, along y.
inline std::vector<double> strength(const Image& image, const SquareKernel& kernel) {
    Grid luminance = opponent(image)[0];
    for (double& v : luminance.values)
        v = (v + 16) / 116;
    const Grid along_x = filtered(luminance, kernel);
    const Grid along_y = filtered(luminance, {kernel.radius, [&](int x, int y) { return kernel.weight(y, x); }});
    std::vector<double> strengths;
    for (std::size_t i = 0; i < luminance.values.size(); ++i)
        strengths.push_back(std::hypot(along_x.values[i], along_y.values[i]));
    return strengths;
}

/// The error of each pixel, from 0 to 1.
inline std::vector<double> flip(const Image& test, const Image& reference, double pixels_per_degree) {
    const double deviation = 0.5 * 0.082 * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const auto gaussian = [=](int x, int y) { return std::exp(-(x * x + y * y) / (2 * deviation * deviation)); };
    const auto edge = normalised({radius, [=](int x, int y) { return -x * gaussian(x, y); }});
    const auto point =
        normalised({radius, [=](int x, int y) { return (x * x / (deviation * deviation) - 1) * gaussian(x, y); }});
    const auto a = seen(test, pixels_per_degree), b = seen(reference, pixels_per_degree);
    const auto edges_a = strength(test, edge), edges_b = strength(reference, edge);
    const auto points_a = strength(test, point), points_b = strength(reference, point);
    std::vector<double> errors;
    for (std::size_t i = 0; i < test.pixels(); ++i) {
        const double difference = std::max(std::abs(edges_a[i] - edges_b[i]), std::abs(points_a[i] - points_b[i]));
        const double feature = std::sqrt(difference / std::numbers::sqrt2);
        errors.push_back(std::pow(color_error(a[i], b[i]), 1 - feature));
    }
    return errors;
}

}  // namespace gib::test::paper
