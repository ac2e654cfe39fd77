#pragma once
// A z test of whether an image differs from a reference by more than noise, for
// every channel of blocks of 8 x 8 and 64 x 64 pixels and of the whole image;
// and whether the means are shown to agree. z_statistic.cpp has the derivation.

#include "common/images/image.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/metrics/statistics.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

struct ZTestLimits {
    double alpha = 0.01;    ///< bounds the probability that any hypothesis is rejected although all are true
    double margin = 0.002;  ///< means agree if their relative deviation is shown to lie within this
};

/// The sizes of blocks, from small to large. An image whose size is not a multiple of 8 is divided evenly, into
/// blocks that are 6 to 11 pixels wide.
inline constexpr std::size_t scale_count = 3;
inline constexpr int z_block_edge = 8;
inline constexpr std::array<const char*, scale_count> scale_names = {"8 x 8 blocks", "64 x 64 blocks", "whole image"};

/// One hypothesis: the mean of a channel over a block is the same in the test and in the reference.
struct BlockTest {
    int x = 0, y = 0, width = 0, height = 0;  ///< [pixels], row 0 on top
    std::size_t channel = 0;
    double deviation = 0;  ///< mean of the test - mean of the reference [W/(sr m^2)]
    double t = 0;          ///< deviation / its standard error; infinite where that is 0 and the deviation is not
    double p = 1;          ///< P(|T| >= |t|) if the hypothesis is true
    /// Whether the 95 % interval of the deviation holds 0. If both images have replicates, the interval is that of the
    /// scatter of their sums, which needs neither the surroundings nor independent pixels: p is too large where these
    /// say more noise.
    bool holds_zero = true;
};

/// The mean of a channel over the whole image minus the reference's, relative to the mean of the reference's total.
struct MeanDeviation {
    double value = 0;
    std::optional<Interval> interval;  ///< 95 %; empty where nothing is known of the noise
    double reference_share = 0;  ///< share of the variance that comes from the reference's standard error, if known
};

/// The tests of one layer, the total or a component.
struct LayerZTest {
    std::array<std::vector<BlockTest>, scale_count> tests;  ///< every block and channel
    std::array<MeanDeviation, 3> means;
    /// An upper bound of the ratio of two variances: that of the block means, from the test's replicates, over that
    /// which independent pixels would have. 1 if the replicates show no shared noise. The largest of the channels.
    double shared_noise = 1;
};

/// `x`: the image to test, with its standard error and its replicates (as groups), if there are any; `r`: the
/// reference; `r_total`: the reference's total. All values must be finite, and all images of one size. `block_edge` is
/// that of the small blocks [pixels]; large ones have 8 x 8 of them.
LayerZTest z_test(const ReferenceLayer& x, const ReferenceLayer& r, const Image& r_total,
                  int block_edge = z_block_edge);

/// The decision over all layers, with Holm's correction at each scale.
struct ZTestVerdict {
    struct Scale {
        std::size_t hypotheses = 0, rejected = 0;
        BlockTest largest;      ///< the test with the smallest p
        std::string layer;      ///< layer of `largest`
        double adjusted_p = 1;  ///< p of `largest`, corrected for all hypotheses of all scales: rejected if below alpha
    };
    std::array<Scale, scale_count> scales;
    bool differs = false;      ///< a hypothesis is rejected
    bool means_agree = false;  ///< the intervals of the total's three channels lie within the margin
    bool accepted() const { return !differs && means_agree; }
};

/// The first of `layers` must be the total. Among several tests with the smallest p, `largest` is the one with the
/// largest |t|; among several of these, the first.
ZTestVerdict verdict_of(const std::vector<std::pair<std::string, LayerZTest>>& layers, const ZTestLimits& limits);

/// Divides the indices 0 to size - 1 into `count` parts whose sizes differ by at most 1.
struct Cuts {
    int size = 1, count = 1;
    /// Parts of about `edge` indices: round(size / edge) of them, at least 1.
    static Cuts with_edge(int size, int edge);
    int begin(int part) const { return static_cast<int>(static_cast<long long>(part) * size / count); }
};

/// Divides an image into blocks of pixels, or a grid of blocks into larger blocks. Blocks are counted row by row from
/// the top.
struct Grid {
    Cuts columns, rows;

    static Grid with_edge(int width, int height, int edge);
    std::size_t size() const { return static_cast<std::size_t>(columns.count) * static_cast<std::size_t>(rows.count); }
    int column(std::size_t i) const { return static_cast<int>(i % static_cast<std::size_t>(columns.count)); }
    int row(std::size_t i) const { return static_cast<int>(i / static_cast<std::size_t>(columns.count)); }
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns.count) +
               static_cast<std::size_t>(column);
    }
    /// Calls visit(x, y) for every pixel, or every smaller block, in block i.
    template <typename Visit>
    void for_each_in(std::size_t i, const Visit& visit) const {
        for (int y = rows.begin(row(i)); y < rows.begin(row(i) + 1); ++y)
            for (int x = columns.begin(column(i)); x < columns.begin(column(i) + 1); ++x)
                visit(x, y);
    }
};

}  // namespace gib
