#include "common/warp.h"

namespace gib {

DiscreteDistribution::DiscreteDistribution(const std::vector<double>& weights) {
    for (double w : weights)
        total_ += w;
    if (!(total_ > 0)) return;
    double sum = 0;
    for (double w : weights) {
        sum += w;
        cumulative_.push_back(static_cast<float>(sum / total_));
    }
    // Rounding must not leave a gap at the end that no item owns, nor give it to an item of weight zero.
    for (std::size_t i = weights.size(); i-- > 0;) {
        cumulative_[i] = 1.f;
        if (weights[i] > 0) break;
    }
    // The probability is that of the rounded interval, which is what is sampled.
    for (std::size_t i = 0; i < cumulative_.size(); ++i)
        probability_.push_back(i == 0 ? cumulative_[0] : cumulative_[i] - cumulative_[i - 1]);
}

DiscreteDistribution::Choice DiscreteDistribution::search(float u) const {
    const auto it = std::upper_bound(cumulative_.begin(), cumulative_.end(), u);
    const auto i = static_cast<std::size_t>(it - cumulative_.begin());
    const float lower = i == 0 ? 0.f : cumulative_[i - 1];
    const float width = cumulative_[i] - lower;
    return {i, probability_[i], std::min((u - lower) / width, 1.f - unit_roundoff)};
}

}  // namespace gib
