#include "tests/samplers/cell_partition.h"

#include <algorithm>

namespace gib::test {

namespace {

constexpr std::size_t points_per_box = 16;
/// No box is larger than these parts of the domain along x and y, so that density is
/// noticed even where no sample fell.
const Vec2d largest_box(1.0 / 16, 1.0 / 16);

/// The parts of [lower, upper] between the breaks.
std::vector<std::pair<double, double>> parts(double lower, double upper, const std::vector<double>& breaks) {
    std::vector<std::pair<double, double>> result;
    double start = lower;
    for (double b : breaks) {
        if (b <= start || b >= upper) continue;
        result.emplace_back(start, b);
        start = b;
    }
    result.emplace_back(start, upper);
    return result;
}

/// The axis along which halving separates the points best: the one along which they
/// fill the smallest part of the box.
Eigen::Index axis_to_halve(const Rectangle& box, std::span<const Vec2d> points) {
    Vec2d lower = box.upper, upper = box.lower;
    for (const Vec2d& p : points) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    }
    const Vec2d spread = (upper - lower).cwiseQuotient(box.extent());
    return spread.x() <= spread.y() ? 0 : 1;
}

void refine(const Rectangle& box, std::span<Vec2d> points, const Vec2d& largest, int depth,
            std::vector<Rectangle>& boxes) {
    constexpr int max_depth = 100;  // points may coincide
    const Vec2d excess = box.extent().cwiseQuotient(largest);
    const bool too_large = excess.maxCoeff() > 1;
    if ((points.size() <= points_per_box && !too_large) || depth == max_depth) {
        boxes.push_back(box);
        return;
    }
    const Eigen::Index axis =
        points.size() > points_per_box ? axis_to_halve(box, points) : (excess.x() >= excess.y() ? 0 : 1);
    const double middle = 0.5 * (box.lower[axis] + box.upper[axis]);
    const auto split = std::partition(points.begin(), points.end(), [&](const Vec2d& p) { return p[axis] < middle; });
    const auto below = static_cast<std::size_t>(split - points.begin());
    Rectangle half = box;
    half.upper[axis] = middle;
    refine(half, points.first(below), largest, depth + 1, boxes);
    half = box;
    half.lower[axis] = middle;
    refine(half, points.subspan(below), largest, depth + 1, boxes);
}

}  // namespace

CellPartition::CellPartition(const Domain& domain, std::vector<Vec2d> points, int max_levels, std::size_t least)
    : domain_(domain), points_(std::move(points)) {
    while (levels_ < max_levels && points_.size() >> (levels_ + 1) >= least)
        ++levels_;
    cuts_.resize(cells() - 1);
    leaves_.resize(cells());
    cut(0, 0, domain_.bounds(), 0, points_.size());
}

void CellPartition::cut(std::size_t node, int level, const Rectangle& area, std::size_t begin, std::size_t end) {
    if (level == levels_) {
        leaves_[node - cuts_.size()] = {area, begin, end};
        return;
    }
    const Eigen::Index axis = level % 2;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const Vec2d& a, const Vec2d& b) { return a[axis] < b[axis]; });
    cuts_[node] = (*at(middle))[axis];
    Rectangle part = area;
    part.upper[axis] = cuts_[node];
    cut(2 * node + 1, level + 1, part, begin, middle);
    part = area;
    part.lower[axis] = cuts_[node];
    cut(2 * node + 2, level + 1, part, middle, end);
}

std::size_t CellPartition::cell_of(const Vec2d& point) const {
    std::size_t node = 0;
    for (int level = 0; level < levels_; ++level)
        node = 2 * node + (point[level % 2] < cuts_[node] ? 1 : 2);
    return node - cuts_.size();
}

std::vector<Rectangle> CellPartition::boxes(std::size_t cell) const {
    const Leaf& leaf = leaves_[cell];
    const Vec2d largest = domain_.bounds().extent().cwiseProduct(largest_box);
    std::vector<Vec2d> points(points_.begin() + static_cast<std::ptrdiff_t>(leaf.begin),
                              points_.begin() + static_cast<std::ptrdiff_t>(leaf.end));
    std::vector<Rectangle> boxes;
    for (const auto& [x0, x1] : parts(leaf.area.lower.x(), leaf.area.upper.x(), domain_.x_breaks)) {
        for (const auto& [y0, y1] : parts(leaf.area.lower.y(), leaf.area.upper.y(), domain_.y_breaks)) {
            const Rectangle part{{x0, y0}, {x1, y1}};
            const auto inside = std::partition(points.begin(), points.end(), [&part](const Vec2d& p) {
                return (p.array() >= part.lower.array()).all() && (p.array() < part.upper.array()).all();
            });
            refine(part, {points.begin(), inside}, largest, 0, boxes);
        }
    }
    return boxes;
}

}  // namespace gib::test
