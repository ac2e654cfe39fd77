#pragma once
// Mean and variance of the images of groups, by value.

#include "common/core/math.h"
#include "common/images/image.h"

#include <numeric>
#include <vector>

namespace gib {

inline double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
inline double mean_of(const std::vector<double>& values) { return sum_of(values) / static_cast<double>(values.size()); }

/// Mean over the groups, and the variance of this mean, of each value.
struct GroupMoments {
    std::vector<double> mean, variance;
};
inline GroupMoments moments_of(const std::vector<ComponentImages>& groups, Component c) {
    const std::size_t size = groups.front()[c]->rgb.size();
    const auto n = static_cast<double>(groups.size());
    GroupMoments moments{std::vector<double>(size), std::vector<double>(size)};
    for (std::size_t i = 0; i < size; ++i) {
        double sum = 0, squares = 0;
        for (const ComponentImages& group : groups)
            sum += double{group[c]->rgb[i]};
        moments.mean[i] = sum / n;
        for (const ComponentImages& group : groups)
            squares += sqr(double{group[c]->rgb[i]} - moments.mean[i]);
        moments.variance[i] = squares / ((n - 1) * n);
    }
    return moments;
}

}  // namespace gib
