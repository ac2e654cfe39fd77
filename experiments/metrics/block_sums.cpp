#include "experiments/metrics/block_sums.h"

#include "common/core/math.h"
#include "experiments/metrics/student_t.h"

#include <algorithm>
#include <limits>

namespace gib {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

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

}  // namespace

double Variance::degrees() const { return spread > 0 ? sqr(value) / spread : infinite; }

void Variance::add(const Variance& other) {
    value += other.value;
    spread += other.spread;
}

void Variance::raise_to(double least) {
    if (!(least > value)) return;
    spread = value > 0 ? spread * sqr(least / value) : sqr(least);
    value = least;
}

void BlockSide::add(const BlockSide& other) {
    sum += other.sum;
    variance.add(other.variance);
    bias += other.bias;
    bias_variance += other.bias_variance;
    groups.resize(other.groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g)
        groups[g] += other.groups[g];
}

double BlockSide::squared_bias() const { return std::max(0.0, sqr(bias) - bias_variance); }

double BlockSide::scatter() const { return sample_mean(groups).variance.variance; }

void BlockSums::add(const BlockSums& other) {
    pixels += other.pixels;
    box.extend(other.box);
    x.add(other.x);
    r.add(other.r);
    difference.add(other.difference);
    degrees = difference.degrees();
    equal = equal && other.equal;
}

Cuts Cuts::with_edge(int size, int edge) { return {size, std::max(1, (size + edge / 2) / edge)}; }

Grid Grid::with_edge(int width, int height, int edge) {
    return {Cuts::with_edge(width, edge), Cuts::with_edge(height, edge)};
}

std::vector<BlockSums> sums_in_blocks(const ReferenceLayer& x, const ReferenceLayer& r, std::size_t channel,
                                      const Grid& grid) {
    std::vector<BlockSums> blocks;
    for (std::size_t i = 0; i < grid.size(); ++i)
        blocks.push_back(sums_in_block(x, r, channel, grid, i));
    return blocks;
}

std::vector<BlockSums> merged(const std::vector<BlockSums>& blocks, const Grid& grid, const Grid& larger) {
    std::vector<BlockSums> sums(larger.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        larger.for_each_in(i, [&](int column, int row) { sums[i].add(blocks[grid.index(column, row)]); });
    return sums;
}

}  // namespace gib
