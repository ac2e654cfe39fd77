#include "methods/metropolis/primary_sample.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gib {

namespace {

constexpr float smallest_step = 1.f / 1024, largest_step = 1.f / 64;  // those of Kelemen et al., section 4.2

/// A number moved by a step whose length is distributed as 1 / length between the two limits, up for u >= 1/2 and down
/// for others, on the circle [0, 1) (section 4.2).
float perturbed(float number, float u) {
    const float v = 2 * u - (u >= 0.5f ? 1.f : 0.f);
    static const float log2_of_range = std::log2(largest_step / smallest_step);
    const float step = largest_step * std::exp2(-log2_of_range * v);
    const float moved = u >= 0.5f ? number + step : number - step;
    return std::min(moved - std::floor(moved), 1 - std::numeric_limits<float>::epsilon() / 2);
}

}  // namespace

void PrimarySample::propose(bool is_large) {
    ++trial_;
    ++state_;
    last_large_before_ = last_large_;
    if (is_large) last_large_ = state_;
}

void PrimarySample::reject() {
    for (const auto& [key, before] : changed_) {
        if (before) blocks_.at(key) = *before;
        else blocks_.erase(key);
    }
    changed_.clear();
    last_large_ = last_large_before_;
    --state_;
}

EightFloats PrimarySample::hashed(std::uint64_t key, std::uint32_t step) const {
    const Sampler numbers(PointSet::independent, combine_keys(trial_ == 0 ? first_ : mutations_, trial_), key, step);
    return numbers.at_vertex(0).all();
}

EightFloats PrimarySample::block(std::uint64_t path_key, std::uint32_t index) {
    const std::uint64_t key = combine_keys(path_key, index);
    const auto [place, is_new] = blocks_.try_emplace(key);
    Block& block = place->second;
    if (!is_new && block.state == state_) return block.numbers;
    changed_.emplace_back(key, is_new ? std::nullopt : std::optional(block));
    // Numbers that no state has asked for since the last large step are uniform, however often they were perturbed.
    if (is_new || block.state < last_large_) block = {hashed(key, 0), state_};
    for (std::uint32_t step = 1; block.state < state_; ++step, ++block.state) {
        const EightFloats u = hashed(key, step);
        for (std::size_t i = 0; i < 8; ++i)
            block.numbers[i] = perturbed(block.numbers[i], u[i]);
    }
    return block.numbers;
}

}  // namespace gib
