#pragma once
// Sums over blocks of pixels of one channel of two images x and r: the radiance, and the variance of its noise. The z
// test (z_statistic.h) compares these sums.

#include "experiments/metrics/reference_image.h"

#include <cstddef>
#include <vector>

namespace gib {

/// The variance of a sum, and the uncertainty of that variance.
struct Variance {
    double value = 0;
    double spread = 0;  ///< value^2 / (degrees of freedom), additive over independent sums; 0: exactly known

    double degrees() const;  ///< degrees of freedom by Welch and Satterthwaite; infinite if exactly known
    void add(const Variance& other);
    /// Raises `value` to `least` if it is smaller. The degrees of freedom stay as they are, or become 1 if there was
    /// no variance.
    void raise_to(double least);
};

/// The sums of one of the two images over a block.
struct BlockSide {
    double sum = 0;              ///< sum of the radiance [W/(sr m^2)]
    Variance variance;           ///< variance of `sum`, from the standard errors of the pixels, taken as independent
    std::vector<double> groups;  ///< the sum of each replicate [W/(sr m^2)]; empty without replicates
    double bias = 0;             ///< estimated bias of `sum`
    double bias_variance = 0;    ///< variance of this estimate

    /// How much the bias adds to the mean square of the sum's deviation from the truth.
    double squared_bias() const;
    void add(const BlockSide& other);
    /// The variance of the mean of `groups`, which also holds if pixels share noise. NaN with fewer than 2 groups.
    double scatter() const;
};

/// The sums of both images over a block.
struct BlockSums {
    double pixels = 0;
    Eigen::AlignedBox2i box;  ///< box around the pixels, both ends included
    BlockSide x, r;
    Variance difference;  ///< variance of x.sum - r.sum, with pixels taken as independent
    double degrees = 0;   ///< degrees of freedom of `difference`
    bool equal = true;    ///< x = r in every pixel, which images of independent noise never are

    void add(const BlockSums& other);
};

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

/// The sums of one channel over every block. If both images have a standard error, the variance of the difference is
/// the sum of their variances; otherwise it comes from the scatter of x - r within the block.
std::vector<BlockSums> sums_in_blocks(const ReferenceLayer& x, const ReferenceLayer& r, std::size_t channel,
                                      const Grid& grid);

/// Adds up the blocks of `grid` within each block of `larger`.
std::vector<BlockSums> merged(const std::vector<BlockSums>& blocks, const Grid& grid, const Grid& larger);

}  // namespace gib
