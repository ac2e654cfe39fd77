#pragma once
// Whether methods agree: sequential tests of the means of their images over seeds.

#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <tuple>
#include <vector>

namespace gib::test {

/// The mean of a channel of a component of one image, and of its estimated bias.
struct MeanAndBias {
    double mean = 0, bias = 0;
};
/// By component and channel.
using Means = std::map<std::pair<Component, int>, MeanAndBias>;

inline Means means_of(const ComponentImages& image) {
    Means means;
    for (Component c : all_components)
        for (int k = 0; k < 3 && image[c]; ++k) {
            const auto& bias = image.bias[static_cast<std::size_t>(index_of(c))];
            means[{c, k}] = {mean_of(*image[c])[k], bias ? mean_of(*bias)[k] : 0};
        }
    return means;
}

/// Means by seed. Each seed is rendered when it is first asked for.
class SeedMeans {
public:
    explicit SeedMeans(std::function<Means(std::uint64_t seed)> of_seed) : of_seed_(std::move(of_seed)) {}
    const Means& operator[](std::uint64_t seed) {
        while (seen_.size() < seed)
            seen_.push_back(of_seed_(seen_.size() + 1));
        return seen_[seed - 1];
    }

private:
    std::function<Means(std::uint64_t)> of_seed_;
    std::vector<Means> seen_;
};

inline SeedMeans seed_means(const LoadedScene& scene, const std::string& label, std::uint32_t passes = 256) {
    return SeedMeans([=, &scene](std::uint64_t seed) { return means_of(render(scene, label, passes, seed)); });
}

/// The same for a scene's XML. All tests of a process share the renders.
inline SeedMeans& shared_means(const std::string& xml, const std::string& label, std::uint32_t passes = 256) {
    static std::map<std::string, LoadedScene> scenes;
    static std::map<std::tuple<std::string, std::string, std::uint32_t>, SeedMeans> means;
    auto scene = scenes.find(xml);
    if (scene == scenes.end()) scene = scenes.emplace(xml, scene_of(xml)).first;
    return means.try_emplace({xml, label, passes}, seed_means(scene->second, label, passes)).first->second;
}

/// A look at the means over the first seeds: they agree if they differ by at most this many standard errors.
struct Look {
    std::uint64_t seeds;
    double errors;
};

/// A comparison that agrees at a look is settled; one that does not agree at the last look has failed. All earlier looks
/// can only settle it, so it fails by chance with at most the probability of the last look: Student's t of 19 to 38 degrees
/// of freedom exceeds 5.2 with a probability of 5e-5 to 7e-6. (One look at 16 seeds: 1.1e-4 to 1.3e-5.)
///
/// Power: let s^2 be the sum of both variances over seeds. One look at 16 seeds and 5.2 errors notices a difference of
/// 7.97 s / sqrt(16) with a probability of 99 % if both variances are equal, and one of 8.37 s / sqrt(16) if one of them is 0,
/// as P(|T| < 5.2) is 0.01 there for the noncentral T = (d + s Z / sqrt(n)) / sqrt(S_1^2 / n + S_2^2 / n) of this d. The same
/// differences are missed by the four looks below with these probabilities, by numerical integration over both chi-square
/// laws; the sum bounds that of missing them at all, so that what is noticed with 99 % has not grown:
///
///     variances     4 seeds   6 seeds   9 seeds   20 seeds   sum
///     one is 0      0.0030    0.0025    0.0020    0.0008     0.0082
///     1 to 4        0.0033    0.0027    0.0020    0.0007     0.0087
///     equal         0.0037    0.0027    0.0019    0.0007     0.0091
///
/// The known bias is held to 3 % of the mean: early looks allow for no error of it, so that they miss a bias of 3 % and
/// 8.37 s / sqrt(16) with a probability below 1e-4; the last judges it by 16 seeds and 5.2 errors.
///
/// Where the means are the same, these looks settle 68 to 72, 88 to 91, 98 and all of the comparisons.
inline constexpr std::array<Look, 4> looks = {{{4, 1.2}, {6, 1.9}, {9, 2.8}, {20, 5.2}}};

/// Expects that both have the same mean over seeds, but for the bias that `found` knows and the share `allowed` of the mean.
inline void expect_same_means(SeedMeans& expected, SeedMeans& found, const std::string& what, double allowed = 0) {
    Means open = found[1];
    for (const auto& [seeds, errors] : looks)
        std::erase_if(open, [&, n = seeds, most = errors](const auto& entry) {
            const auto& key = entry.first;
            const auto over = [&](std::uint64_t count, SeedMeans& means, double MeanAndBias::*number) {
                Moments moments;
                for (std::uint64_t seed = 1; seed <= count; ++seed)
                    moments.add(means[seed].at(key).*number);
                return moments;
            };
            const bool last = n == looks.back().seeds;
            const std::uint64_t of_bias = last ? 16 : n;
            const Moments truth = over(n, expected, &MeanAndBias::mean), mean = over(n, found, &MeanAndBias::mean),
                          bias = over(of_bias, found, &MeanAndBias::bias);
            const double error = std::hypot(mean.standard_error(), truth.standard_error());
            const double known = std::abs(bias.mean()), rounding = 1e-7 + allowed * mean.mean();
            // Early looks leave out the bias, whose estimate has a noise of its own.
            const bool agrees = std::abs(mean.mean() - truth.mean()) <= most * error + (last ? known : 0) + rounding;
            // A bias that hides everything would make this test a formality.
            const bool small = known <= 0.03 * over(of_bias, expected, &MeanAndBias::mean).mean() +
                                            (last ? most : 0) * bias.standard_error() + 1e-7;
            EXPECT_TRUE(!last || (agrees && small))
                << what << ", " << name_of(key.first) << ' ' << key.second << ": " << mean.mean() << " instead of "
                << truth.mean() << " +- " << error << ", bias " << known;
            return agrees && small;
        });
}

/// Expects that all labels have the same means as the first, which is unbiased.
inline void expect_same_means(const LoadedScene& scene, const std::vector<std::string>& labels,
                              std::uint32_t passes = 256) {
    SeedMeans expected = seed_means(scene, labels.front(), passes);
    for (std::size_t i = 1; i < labels.size(); ++i) {
        SeedMeans found = seed_means(scene, labels[i], passes);
        expect_same_means(expected, found, labels[i]);
    }
}
inline void expect_same_means(const std::string& xml, const std::vector<std::string>& labels) {
    for (std::size_t i = 1; i < labels.size(); ++i)
        expect_same_means(shared_means(xml, labels.front()), shared_means(xml, labels[i]), labels[i]);
}

}  // namespace gib::test
