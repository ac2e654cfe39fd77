// Notation: d = x - r in the n pixels of a block, S = sum of d, V = Var S. The hypothesis is E S = 0; the statistic
// is T = S / sqrt(V).
//
// If the test has replicates (or a standard error) and the reference a standard error, V is the sum of both variances
// over the pixels, with the degrees of freedom of Welch and Satterthwaite. Otherwise V = n s^2 with n - 1 degrees of
// freedom, where s^2 is the variance of d around its mean in the block. This V is unbiased if the hypothesis holds
// and pixels are independent. A real difference that varies within the block inflates s and weakens the test;
// replicates do not have this weakness. S and V of larger blocks are sums over the small ones.
//
// Heavy tails make the test conservative if d is symmetric (Efron 1969, "Student's t-test under symmetry conditions";
// Benjamini 1983, "Is the t test really conservative when the parent distribution is long-tailed?"). But the noise of
// path tracing is skewed: a block which rare bright paths have not met yet is too dark AND has too small an s. With s
// alone, path traced images of cornell-glass.xml at 16 samples a pixel are rejected every time. So V is never below the
// value that the surroundings predict: the summed V of the 7 x 7 blocks around, shared out in proportion to the
// variances of the reference or of the test, whichever gives more (one of them has met the rare paths), or evenly if
// the reference has no standard error. Blocks that are too dark are tested with the variance that the hypothesis
// predicts, blocks that are too bright with their own, whose growth with S bounds T. The price is a weaker test where
// the noise of the image varies from block to block in another way than that of the reference.
//
// Replicates show whether pixels share noise, as with photon maps, by the ratio of the variance of their block means
// to the sum of the variances of their pixels. If this ratio is above 1 beyond its own uncertainty, V is multiplied
// by it, and the variance of the whole image is that of the replicates' means.
//
// Means agree if the 95 % interval lies within the margin: two one-sided tests at 2.5 % (Schuirmann 1987). As every
// channel has to pass, no correction for their number is needed.
#include "experiments/metrics/z_statistic.h"

#include "common/core/math.h"
#include "experiments/metrics/student_t.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gib {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Sums over blocks of pixels of one channel of two images x and r: the radiance, and the variance of its noise.

/// The variance of a sum, and the uncertainty of that variance.
struct Variance {
    double value = 0;
    double spread = 0;  ///< value^2 / (degrees of freedom), additive over independent sums; 0: exactly known

    /// Degrees of freedom by Welch and Satterthwaite; infinite if exactly known.
    double degrees() const { return spread > 0 ? sqr(value) / spread : infinite; }
    void add(const Variance& other) {
        value += other.value;
        spread += other.spread;
    }
    /// Raises `value` to `least` if it is smaller. The degrees of freedom stay as they are, or become 1 if there was
    /// no variance.
    void raise_to(double least) {
        if (!(least > value)) return;
        spread = value > 0 ? spread * sqr(least / value) : sqr(least);
        value = least;
    }
};

/// The sums of one of the two images over a block.
struct BlockSide {
    double sum = 0;              ///< sum of the radiance [W/(sr m^2)]
    Variance variance;           ///< variance of `sum`, from the standard errors of the pixels, taken as independent
    std::vector<double> groups;  ///< the sum of each replicate [W/(sr m^2)]; empty without replicates
    double bias = 0;             ///< estimated bias of `sum`
    double bias_variance = 0;    ///< variance of this estimate

    /// How much the bias adds to the mean square of the sum's deviation from the truth.
    double squared_bias() const { return std::max(0.0, sqr(bias) - bias_variance); }
    void add(const BlockSide& other) {
        sum += other.sum;
        variance.add(other.variance);
        bias += other.bias;
        bias_variance += other.bias_variance;
        groups.resize(other.groups.size());
        for (std::size_t g = 0; g < groups.size(); ++g)
            groups[g] += other.groups[g];
    }
    /// The variance of the mean of `groups`, which also holds if pixels share noise. NaN with fewer than 2 groups.
    double scatter() const { return sample_mean(groups).variance.variance; }
};

/// The sums of both images over a block.
struct BlockSums {
    double pixels = 0;
    Eigen::AlignedBox2i box;  ///< box around the pixels, both ends included
    BlockSide x, r;
    Variance difference;  ///< variance of x.sum - r.sum, with pixels taken as independent
    double degrees = 0;   ///< degrees of freedom of `difference`
    bool equal = true;    ///< x = r in every pixel, which images of independent noise never are

    void add(const BlockSums& other) {
        pixels += other.pixels;
        box.extend(other.box);
        x.add(other.x);
        r.add(other.r);
        difference.add(other.difference);
        degrees = difference.degrees();
        equal = equal && other.equal;
    }
};

/// Adds up the blocks of `grid` within each block of `larger`.
std::vector<BlockSums> merged(const std::vector<BlockSums>& blocks, const Grid& grid, const Grid& larger) {
    std::vector<BlockSums> sums(larger.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        larger.for_each_in(i, [&](int column, int row) { sums[i].add(blocks[grid.index(column, row)]); });
    return sums;
}

/// The number of replicates that the standard error comes from. A file without groups is assumed to come from
/// gibench, which uses `reference_groups` of them.
double replicates_of(const ReferenceLayer& layer) {
    return layer.groups.size() > 1 ? static_cast<double>(layer.groups.size()) : reference_groups;
}

void add_pixel(BlockSide& side, const ReferenceLayer& layer, std::size_t i) {
    side.sum += double{layer.mean.rgb[i]};
    if (layer.standard_error) {
        // The spread needs the square of the true variance. The square of a variance that is estimated from m normal
        // values is on average (m + 1) / (m - 1) times as large; so v^2 / (m - 1) becomes v^2 / (m + 1).
        const double v = sqr(double{layer.standard_error->rgb[i]});
        side.variance.add({v, sqr(v) / (replicates_of(layer) + 1)});
    }
    for (const ReferenceLayer& bias : layer.bias) {
        side.bias += double{bias.mean.rgb[i]};
        if (bias.standard_error) side.bias_variance += sqr(double{bias.standard_error->rgb[i]});
    }
    side.groups.resize(layer.groups.size() > 1 ? layer.groups.size() : 0);
    for (std::size_t g = 0; g < side.groups.size(); ++g)
        side.groups[g] += static_cast<double>(layer.groups[g].rgb[i]);
}

/// The variance of the sum of these differences, from their scatter. The degrees of freedom of sums over several
/// blocks come from the fourth moment, because a few pixels may hold most of the variance; for normal noise they are
/// n - 1.
Variance scatter_of(const std::vector<double>& differences) {
    const auto n = static_cast<double>(differences.size());
    double mean = 0, second = 0, fourth = 0;
    for (const double d : differences)
        mean += d / n;
    // One pixel has no scatter, so nothing is known of its noise.
    if (n < 2) return {mean == 0 ? 0 : infinite, 0};
    for (const double d : differences) {
        second += sqr(d - mean);
        fourth += sqr(sqr(d - mean));
    }
    const double value = second * n / (n - 1);
    return {value, std::max(sqr(value) / (n - 1), (fourth - sqr(second) / n) / 2)};
}

BlockSums sums_in_block(const ReferenceLayer& x, const ReferenceLayer& r, std::size_t channel, const Grid& grid,
                        std::size_t block) {
    BlockSums sums;
    std::vector<double> differences;
    grid.for_each_in(block, [&](int column, int row) {
        const std::size_t i = 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(r.mean.width) +
                                   static_cast<std::size_t>(column)) +
                              channel;
        sums.box.extend(Eigen::Vector2i(column, row));
        add_pixel(sums.x, x, i);
        add_pixel(sums.r, r, i);
        differences.push_back(double{x.mean.rgb[i]} - double{r.mean.rgb[i]});
        sums.equal = sums.equal && differences.back() == 0;
    });
    sums.pixels = static_cast<double>(differences.size());
    if (sums.equal) return sums;
    if (x.standard_error && r.standard_error) {
        sums.difference = sums.x.variance;
        sums.difference.add(sums.r.variance);
        // Degrees of freedom that are estimated from few replicates are noisy. They are bounded by those that equal
        // variances in all pixels would have.
        const double fewest = std::min(replicates_of(x), replicates_of(r)) - 1;
        sums.degrees = std::min(sums.difference.degrees(), fewest * sums.pixels);
    } else {
        sums.difference = scatter_of(differences);
        sums.difference.raise_to(sums.x.variance.value + sums.r.variance.value);
        sums.degrees = std::max(1.0, sums.pixels - 1);
    }
    return sums;
}

/// The sums of one channel over every block. If both images have a standard error, the variance of the difference is
/// the sum of their variances; otherwise it comes from the scatter of x - r within the block.
std::vector<BlockSums> sums_in_blocks(const ReferenceLayer& x, const ReferenceLayer& r, std::size_t channel,
                                      const Grid& grid) {
    std::vector<BlockSums> blocks;
    for (std::size_t i = 0; i < grid.size(); ++i)
        blocks.push_back(sums_in_block(x, r, channel, grid, i));
    return blocks;
}

/// Relative difference that rounding alone can cause between the means of float images.
constexpr double rounding = 1e-5;
constexpr int blocks_across = 8;
constexpr int reach = 3;  // [blocks] to each side, of the surroundings of a block

/// Raises the variance of each block to at least its share of the summed variance of the blocks around it. The shares
/// are in proportion to what `weight` gives of the blocks.
template <typename Weight>
void raise_to_surroundings(std::vector<BlockSums>& blocks, const std::vector<double>& variances, const Grid& grid,
                           const Weight& weight) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        double variance = 0, weights = 0;
        const int row = grid.row(i), column = grid.column(i);
        for (int y = std::max(0, row - reach); y <= std::min(grid.rows.count - 1, row + reach); ++y)
            for (int x = std::max(0, column - reach); x <= std::min(grid.columns.count - 1, column + reach); ++x) {
                variance += variances[grid.index(x, y)];
                weights += weight(blocks[grid.index(x, y)]);
            }
        if (weights > 0 && !blocks[i].equal) blocks[i].difference.raise_to(variance / weights * weight(blocks[i]));
    }
}

/// Raises in proportion to the variances of the reference and of the test, as far as known; without the reference's, to
/// the numbers of pixels.
void raise_to_surroundings(std::vector<BlockSums>& blocks, const Grid& grid, bool x_known, bool r_known) {
    std::vector<double> variances;
    for (const BlockSums& block : blocks)
        variances.push_back(block.difference.value);
    const auto raise = [&](const auto& weight) { raise_to_surroundings(blocks, variances, grid, weight); };
    if (!r_known) return raise([](const BlockSums& b) { return b.pixels; });
    raise([](const BlockSums& b) { return b.r.variance.value; });
    if (x_known) raise([](const BlockSums& b) { return b.x.variance.value; });
}

/// The variance of the sums of blocks, from the replicates of one side, over the variance that independent pixels
/// would have. Twice the relative scatter that this ratio has with normal noise is added. The result is 1 if the
/// ratio does not exceed 1 by four times that scatter.
double shared_noise(const std::vector<BlockSums>& blocks, BlockSide BlockSums::*side) {
    const std::size_t replicates = (blocks.front().*side).groups.size();
    if (replicates < 2) return 1;
    double real = 0, independent = 0, squares = 0;
    for (const BlockSums& block : blocks) {
        real += (block.*side).scatter();
        independent += (block.*side).variance.value;
        squares += sqr((block.*side).variance.value);
    }
    if (!(independent > 0)) return 1;
    const double degrees = static_cast<double>(replicates - 1) * sqr(independent) / squares;
    const double ratio = real / independent, scatter = std::sqrt(2 / degrees);
    return ratio > 1 + 4 * scatter ? ratio * (1 + 2 * scatter) : 1;
}

/// The factors by which the variances of the sums of each side exceed those of independent pixels.
struct SharedNoise {
    double x = 1, r = 1;

    /// Each factor, or that of the replicates in larger blocks if it is larger; a factor of 1 stays.
    SharedNoise at_least_in(const std::vector<BlockSums>& blocks) const {
        return {x > 1 ? std::max(x, shared_noise(blocks, &BlockSums::x)) : 1,
                r > 1 ? std::max(r, shared_noise(blocks, &BlockSums::r)) : 1};
    }
    /// The factor for the difference in a block: the mean of both factors, weighted by the variances.
    double of(const BlockSums& block) const {
        const double vx = block.x.variance.value, vr = block.r.variance.value;
        return vx + vr > 0 ? (x * vx + r * vr) / (vx + vr) : 1;
    }
};

/// The variance of the difference in a block and its degrees of freedom, whether or not pixels share noise.
struct NoiseOfBlock {
    double variance, degrees;

    NoiseOfBlock(const BlockSums& block, const SharedNoise& shared) {
        const double c = shared.of(block);
        variance = c * block.difference.value;
        // Pixels that share noise also have fewer degrees of freedom.
        degrees = std::max(1.0, block.degrees / c);
    }
    /// The noise of the whole image. If pixels share noise, its variance is the scatter of the replicates' means,
    /// which needs no assumption. The few degrees of freedom of this scatter are not raised by those of the other
    /// side, which is better known: that would raise them most when the scatter happens to be too small.
    static NoiseOfBlock of_image(const BlockSums& image, const SharedNoise& shared) {
        NoiseOfBlock noise(image, {});
        for (const auto& [c, side] : {std::pair(shared.x, &image.x), std::pair(shared.r, &image.r)}) {
            if (!(c > 1)) continue;
            noise.variance = std::max(0.0, noise.variance - side->variance.value) + side->scatter();
            noise.degrees = std::min(noise.degrees, static_cast<double>(side->groups.size() - 1));
        }
        return noise;
    }
};

/// The part of the mean square of the difference that is no noise: the squares of both biases and of the rounding.
double systematic(const BlockSums& sums, double rounded) {
    return sums.x.squared_bias() + sums.r.squared_bias() + sqr(rounding * rounded);
}

/// BlockTest::holds_zero of a difference with the part of its mean square that is no noise.
bool holds_zero(const BlockSums& sums, double difference, double no_noise, double p) {
    if (sums.x.groups.size() < 2 || sums.r.groups.size() < 2) return p >= interval_tail;
    Variance noise;
    for (const BlockSide* side : {&sums.x, &sums.r})
        noise.add({side->scatter(), sqr(side->scatter()) / static_cast<double>(side->groups.size() - 1)});
    const double v = noise.value + no_noise;
    return difference == 0 ||
           (v > 0 && student_t_tail(std::abs(difference) / std::sqrt(v), noise.degrees()) >= interval_tail);
}

BlockTest tested(const BlockSums& sums, const NoiseOfBlock& noise, std::size_t channel) {
    BlockTest test;
    test.channel = channel;
    test.x = sums.box.min().x();
    test.y = sums.box.min().y();
    test.width = sums.box.sizes().x() + 1;
    test.height = sums.box.sizes().y() + 1;
    const double difference = sums.x.sum - sums.r.sum;
    const double no_noise = systematic(sums, std::max(std::abs(sums.x.sum), std::abs(sums.r.sum)));
    const double v = noise.variance + no_noise;
    test.deviation = difference / sums.pixels;
    if (difference == 0) return test;
    test.t = v > 0 ? difference / std::sqrt(v) : std::copysign(HUGE_VAL, difference);
    test.p = student_t_tail(std::abs(test.t), noise.degrees);
    test.holds_zero = holds_zero(sums, difference, no_noise, test.p);
    return test;
}

MeanDeviation mean_deviation(const BlockSums& image, const NoiseOfBlock& noise, double r_total_sum) {
    MeanDeviation mean;
    const double difference = image.x.sum - image.r.sum;
    mean.reference_share = noise.variance > 0 ? std::min(1.0, image.r.variance.value / noise.variance) : 0;
    const double v = noise.variance + systematic(image, r_total_sum);
    if (r_total_sum == 0) {
        mean.value = difference == 0 ? 0 : std::copysign(HUGE_VAL, difference);
        if (difference == 0 || v == 0) mean.interval = Interval{mean.value, mean.value};
        return mean;
    }
    mean.value = difference / std::abs(r_total_sum);
    const double half = student_t_two_sided(interval_tail, noise.degrees) * std::sqrt(v) / std::abs(r_total_sum);
    if (std::isfinite(half)) mean.interval = Interval{mean.value - half, mean.value + half};
    return mean;
}

double channel_sum(const Image& image, std::size_t channel) {
    double sum = 0;
    for (std::size_t i = channel; i < image.rgb.size(); i += 3)
        sum += double{image.rgb[i]};
    return sum;
}

void test_channel(const ReferenceLayer& x, const ReferenceLayer& r, const Image& r_total, std::size_t channel,
                  int block_edge, LayerZTest& result) {
    const Grid small = Grid::with_edge(r.mean.width, r.mean.height, block_edge);
    const Grid large = Grid::with_edge(small.columns.count, small.rows.count, blocks_across);
    std::vector<BlockSums> blocks = sums_in_blocks(x, r, channel, small);
    raise_to_surroundings(blocks, small, x.standard_error.has_value(), r.standard_error.has_value());

    const SharedNoise shared{shared_noise(blocks, &BlockSums::x), shared_noise(blocks, &BlockSums::r)};
    result.shared_noise = std::max(result.shared_noise, shared.x);
    for (const BlockSums& block : blocks)
        result.tests[0].push_back(tested(block, {block, shared}, channel));
    const std::vector<BlockSums> regions = merged(blocks, small, large);
    const SharedNoise shared_in_regions = shared.at_least_in(regions);
    for (const BlockSums& region : regions)
        result.tests[1].push_back(tested(region, {region, shared_in_regions}, channel));
    const BlockSums image = merged(regions, large, Grid{{large.columns.count, 1}, {large.rows.count, 1}}).front();
    const NoiseOfBlock noise = NoiseOfBlock::of_image(image, shared);
    result.tests[2].push_back(tested(image, noise, channel));
    result.means[channel] = mean_deviation(image, noise, channel_sum(r_total, channel));
}

/// The number of hypotheses that are rejected by the procedure of Holm (1979): in the order of their p, each is
/// compared with alpha over the number of hypotheses that are left.
std::size_t rejected_by_holm(std::vector<double> p, double alpha) {
    std::ranges::sort(p);
    std::size_t rejected = 0;
    while (rejected < p.size() && p[rejected] <= alpha / static_cast<double>(p.size() - rejected))
        ++rejected;
    return rejected;
}

constexpr float least_variance = 1e-4f;

}  // namespace

LayerZTest z_test(const ReferenceLayer& x, const ReferenceLayer& r, const Image& r_total, int block_edge) {
    LayerZTest result;
    for (std::size_t channel = 0; channel < 3; ++channel)
        test_channel(x, r, r_total, channel, block_edge, result);
    return result;
}

ZTestVerdict verdict_of(const std::vector<std::pair<std::string, LayerZTest>>& layers, const ZTestLimits& limits) {
    ZTestVerdict verdict;
    for (std::size_t s = 0; s < scale_count; ++s) {
        ZTestVerdict::Scale& scale = verdict.scales[s];
        std::vector<double> p;
        for (const auto& [name, layer] : layers)
            for (const BlockTest& test : layer.tests[s]) {
                // Among several tests whose p is 0, the one with the largest |t| is kept.
                if (p.empty() || test.p < scale.largest.p ||
                    (test.p == scale.largest.p && std::abs(test.t) > std::abs(scale.largest.t))) {
                    scale.largest = test;
                    scale.layer = name;
                }
                p.push_back(test.p);
            }
        scale.hypotheses = p.size();
        const double all = static_cast<double>(scale_count * p.size());
        scale.adjusted_p = std::min(1.0, all * scale.largest.p);
        scale.rejected = rejected_by_holm(std::move(p), limits.alpha / static_cast<double>(scale_count));
        verdict.differs = verdict.differs || scale.rejected > 0;
    }
    verdict.means_agree = true;
    for (const MeanDeviation& mean : layers.front().second.means) {
        const auto& interval = mean.interval;
        if (!interval || interval->lo < -limits.margin || interval->hi > limits.margin) verdict.means_agree = false;
    }
    return verdict;
}

Cuts Cuts::with_edge(int size, int edge) { return {size, std::max(1, (size + edge / 2) / edge)}; }

Grid Grid::with_edge(int width, int height, int edge) {
    return {Cuts::with_edge(width, edge), Cuts::with_edge(height, edge)};
}

}  // namespace gib
