#pragma once
// Does an image differ from a reference by more than noise? Every channel of blocks of 8 x 8 and 64 x 64 pixels and of
// the whole image; and are the means shown to agree? z_test.cpp has the derivation.

#include "experiments/metrics/reference_image.h"
#include "experiments/metrics/statistics.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

struct ZTestLimits {
    double alpha = 0.01;    ///< bounds the probability that any hypothesis is rejected although all are true
    double margin = 0.002;  ///< means agree if their relative deviation is shown to lie within this
};

/// From small to large. Sizes that are not multiples of 8 are cut evenly: their blocks are 6 to 11 pixels wide.
inline constexpr std::size_t scale_count = 3;
inline constexpr std::array<const char*, scale_count> scale_names = {"8 x 8 blocks", "64 x 64 blocks", "whole image"};

/// One hypothesis: the mean of a block's channel is that of the reference.
struct BlockTest {
    int x = 0, y = 0, width = 0, height = 0;  ///< [pixels], row 0 on top
    std::size_t channel = 0;
    double deviation = 0;  ///< of the test's mean from the reference's [W/(sr m^2)]
    double t = 0;          ///< deviation / its standard error; infinite where that is 0 and the deviation is not
    double p = 1;          ///< P(|T| >= |t|) if the hypothesis is true
};

/// The mean of the whole image's channel minus the reference's, relative to the mean of the reference's total.
struct MeanDeviation {
    double value = 0;
    std::optional<Interval> interval;  ///< 95 %; empty where nothing is known of the noise
    double reference_share = 0;        ///< the reference's part of the variance, as far as its standard error is known
};

/// The tests of one layer, the total or a component.
struct LayerZTest {
    std::array<std::vector<BlockTest>, scale_count> tests;  ///< every block and channel
    std::array<MeanDeviation, 3> means;
    /// Variance of the block means of the test's replicates over what it is if pixels are independent, at most; 1: it
    /// is that. The largest of the channels.
    double shared_noise = 1;
};

/// `x`: the test, with its standard error and replicates (as groups) if there are any; `r_total`: the reference's
/// total. All are finite and of one size, not empty.
LayerZTest z_test(const ReferenceLayer& x, const ReferenceLayer& r, const Image& r_total);

/// The decision over all layers, with Holm's correction at each scale.
struct ZTestVerdict {
    struct Scale {
        std::size_t hypotheses = 0, rejected = 0;
        BlockTest largest;      ///< the one with the smallest p
        std::string layer;      ///< of `largest`
        double adjusted_p = 1;  ///< of `largest`, corrected for all hypotheses of all scales: rejected if below alpha
    };
    std::array<Scale, scale_count> scales;
    bool differs = false;      ///< a hypothesis is rejected
    bool means_agree = false;  ///< the intervals of the total's three channels lie within the margin
    bool accepted() const { return !differs && means_agree; }
};

/// The first layer is the total. The places of `largest` are those of the first layer that has the smallest p.
ZTestVerdict verdict_of(const std::vector<std::pair<std::string, LayerZTest>>& layers, const ZTestLimits& limits);

}  // namespace gib
