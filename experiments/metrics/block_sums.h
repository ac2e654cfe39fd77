#pragma once
// One channel of two images, added up over blocks of pixels: radiance, and what is known of its noise.

#include "experiments/metrics/reference_image.h"

#include <cstddef>
#include <vector>

namespace gib {

/// The variance of a sum, and how well it is known.
struct Variance {
    double value = 0;
    double spread = 0;  ///< value^2 / degrees of freedom, which adds up over independent sums; 0: known exactly

    double degrees() const;
    void add(const Variance& other);
    /// Keeps the degrees of freedom; 1 if there was no variance.
    void raise_to(double least);
};

/// One of the two images in a block.
struct BlockSide {
    double sum = 0;              ///< of the radiance [W/(sr m^2)]
    Variance variance;           ///< of `sum` by the standard error, if pixels are independent
    std::vector<double> groups;  ///< sums of the replicates

    void add(const BlockSide& other);
    /// The variance of the mean of `groups`, pixels independent or not; from 2 groups on.
    double scatter() const;
};

struct BlockSums {
    double pixels = 0;
    BlockSide x, r;
    Variance difference;  ///< of x.sum - r.sum if pixels are independent
    double degrees = 0;   ///< of freedom of `difference`
    bool equal = true;    ///< in every pixel: images of independent noise never are

    void add(const BlockSums& other);
};

/// Cuts 0 ... size - 1 into parts as even as can be.
struct Cuts {
    int size = 1, count = 1;
    static Cuts with_edge(int size, int edge);
    int begin(int part) const { return static_cast<int>(static_cast<long long>(part) * size / count); }
};

/// Blocks of pixels, or of smaller blocks; row by row, row 0 on top.
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
    /// visit(x, y) for every cell of block i.
    template <typename Visit>
    void for_each_in(std::size_t i, const Visit& visit) const {
        for (int y = rows.begin(row(i)); y < rows.begin(row(i) + 1); ++y)
            for (int x = columns.begin(column(i)); x < columns.begin(column(i) + 1); ++x)
                visit(x, y);
    }
};

/// Without a standard error of both, the difference's variance is found from its scatter within the block.
std::vector<BlockSums> sums_in_blocks(const ReferenceLayer& x, const ReferenceLayer& r, std::size_t channel,
                                      const Grid& grid);

/// Sums over blocks of blocks.
std::vector<BlockSums> merged(const std::vector<BlockSums>& blocks, const Grid& grid, const Grid& larger);

}  // namespace gib
