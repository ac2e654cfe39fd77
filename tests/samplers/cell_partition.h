#pragma once
// A rectangle cut into cells that hold equal shares of a sample.

#include "tests/samplers/sampled_density.h"

#include <span>

namespace gib::test {

/// A complete binary tree of cuts at medians, across x and y in turn. The cells of a coarser partition are unions of
/// neighbours in the order of the leaves.
class CellPartition {
public:
    /// Makes at most 2^max_levels cells, each with at least `least` points.
    CellPartition(const Domain& domain, std::vector<Vec2d> points, int max_levels, std::size_t least);

    int levels() const { return levels_; }
    std::size_t cells() const { return std::size_t{1} << levels_; }
    std::size_t cell_of(const Vec2d& point) const;
    /// The boxes that a cell is cut into for integration. They are fine where the points are: each has few points, no
    /// break inside, and at most a given part of the domain's size.
    std::vector<Rectangle> boxes(std::size_t cell) const;

private:
    void cut(std::size_t node, int level, const Rectangle& area, std::size_t begin, std::size_t end);

    struct Leaf {
        Rectangle area;
        std::size_t begin, end;  ///< range of its points
    };

    Domain domain_;
    std::vector<Vec2d> points_;
    int levels_ = 0;
    std::vector<double> cuts_;  ///< cuts of the inner nodes; the children of i are 2 i + 1 and 2 i + 2
    std::vector<Leaf> leaves_;
};

}  // namespace gib::test
