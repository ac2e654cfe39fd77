#pragma once
// Whether methods agree: means of images over seeds.

#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <gtest/gtest.h>

#include <map>

namespace gib::test {

/// Over seeds, the mean of a channel of a component, and of its estimated bias.
struct MeanAndBias {
    Moments mean, bias;
};

/// By component and channel.
inline std::map<std::pair<Component, int>, MeanAndBias> moments_of(const LoadedScene& scene, const std::string& label,
                                                                   std::uint32_t passes = 256) {
    constexpr std::uint64_t seeds = 16;
    std::map<std::pair<Component, int>, MeanAndBias> moments;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const ComponentImages image = render(scene, label, passes, seed);
        for (Component c : all_components)
            for (int k = 0; k < 3; ++k) {
                if (!image[c]) continue;
                MeanAndBias& of_channel = moments[{c, k}];
                of_channel.mean.add(mean_of(*image[c])[k]);
                const auto& bias = image.bias[static_cast<std::size_t>(index_of(c))];
                of_channel.bias.add(bias ? mean_of(*bias)[k] : 0);
            }
    }
    return moments;
}

/// Expects that all have the same means as the first, which is unbiased. Each comparison of at most 15 fails by chance
/// with a probability of 1e-5 (Student's t of 30 degrees of freedom beyond 5.2); a difference of 5 standard errors is about
/// 1 % here. The interval of a method that knows its bias is wider by it.
inline void expect_same_means(const LoadedScene& scene, const std::vector<std::string>& labels,
                              std::uint32_t passes = 256) {
    const auto expected = moments_of(scene, labels.front(), passes);
    for (std::size_t i = 1; i < labels.size(); ++i)
        for (const auto& [key, moments] : moments_of(scene, labels[i], passes)) {
            const Moments& other = expected.at(key).mean;
            const double error = std::hypot(moments.mean.standard_error(), other.standard_error());
            const double bias = std::abs(moments.bias.mean());
            EXPECT_NEAR(moments.mean.mean(), other.mean(), 5.2 * error + bias + 1e-7)
                << labels[i] << ", " << name_of(key.first) << ' ' << key.second << ", bias " << bias;
            // A bias that hides everything would make this test a formality.
            EXPECT_LE(bias, 0.03 * other.mean() + 5.2 * moments.bias.standard_error() + 1e-7) << labels[i];
        }
}

}  // namespace gib::test
