#pragma once
// Compares pictures that should have the same distribution: replicates of each, and the
// probability of their difference.

#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include "experiments/metrics/student_t.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace gib::test {

/// A picture is reduced to this many numbers: the mean of each channel, of each component, and of each quarter.
inline constexpr std::size_t numbers_of_a_picture = 3 + component_count + 4;

inline std::vector<double> numbers_of(const ComponentImages& images) {
    const Image total = images.total();
    const Colord mean = mean_of(total);
    std::vector<double> numbers(mean.begin(), mean.end());
    for (std::size_t c = 0; c < component_count; ++c) {
        const auto& image = images[static_cast<Component>(c)];
        numbers.push_back(image ? mean_of(*image).mean() : 0.0);
    }
    const std::size_t first_quarter = numbers.size();
    numbers.resize(first_quarter + 4);
    const auto width = static_cast<std::size_t>(total.width);
    for (std::size_t i = 0; i < total.pixels(); ++i) {
        const std::size_t right = i % width >= width / 2,
                          lower = i / width >= static_cast<std::size_t>(total.height) / 2;
        numbers[first_quarter + 2 * lower + right] += static_cast<double>(total.at(i).mean());
    }
    for (std::size_t q = first_quarter; q < numbers.size(); ++q)
        numbers[q] *= 4.0 / static_cast<double>(total.pixels());
    return numbers;
}

/// A number of a picture over seeds.
struct PictureNumber : Moments {
    Moments bias;  ///< as the images estimate it; 0 without such an estimate
};

/// The numbers_of() renders with `seeds` successive seeds, which are independent.
inline std::vector<PictureNumber> replicates(const LoadedScene& scene, const std::string& label, std::uint32_t passes,
                                             std::uint64_t first_seed, std::uint64_t seeds) {
    std::vector<PictureNumber> moments(numbers_of_a_picture);
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
        const ComponentImages images = render(scene, label, passes, seed, 1);
        const auto numbers = numbers_of(images);
        const auto biases = numbers_of({images.width, images.height, images.bias});
        for (std::size_t i = 0; i < moments.size(); ++i) {
            moments[i].add(numbers[i]);
            moments[i].bias.add(biases[i]);
        }
    }
    return moments;
}

/// The relative difference of two means that rounding explains: some hundred operations in float.
inline constexpr double picture_rounding = 1e-5;

/// P(|T| >= t) of Welch's t-test (1947) for the hypothesis that the mean of a is `scale` times the mean of b, up to
/// `bias`. Under
/// the hypothesis both sides have the same law, so the difference of their means over equally many seeds is
/// symmetric, whatever that law is. The tails of t are then, if anything, lighter than Student's (Efron 1969):
/// fireflies cause no false alarms.
inline double welch_probability(const Moments& a, const Moments& b, double scale = 1, double bias = 0) {
    const double va = a.standard_error() * a.standard_error(), vb = std::pow(scale * b.standard_error(), 2);
    const double allowed = bias + picture_rounding * std::max(std::abs(a.mean()), std::abs(scale * b.mean()));
    const double difference = std::max(std::abs(a.mean() - scale * b.mean()) - allowed, 0.0);
    if (difference == 0) return 1;
    if (va + vb == 0) return 0;
    const auto n = static_cast<double>(a.count() - 1), m = static_cast<double>(b.count() - 1);
    const double degrees = (va + vb) * (va + vb) / (va * va / n + vb * vb / m);
    return student_t_tail(difference / std::sqrt(va + vb), std::max(degrees, 1.0));
}

/// Fisher's (1925) combination of independent probabilities p: -2 sum ln p is chi-square with two degrees of freedom
/// for each p. The tail of that law is a sum of Poisson probabilities.
inline double fisher_probability(const std::vector<double>& probabilities) {
    double x = 0;
    for (const double p : probabilities)
        x -= std::log(std::max(p, 1e-300));
    double term = std::exp(-x), tail = 0;
    for (std::size_t i = 0; i < probabilities.size(); ++i) {
        tail += term;
        term *= x / static_cast<double>(i + 1);
    }
    return std::min(tail, 1.0);
}

}  // namespace gib::test
