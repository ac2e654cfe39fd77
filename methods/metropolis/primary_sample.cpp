#include "methods/metropolis/primary_sample.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gib {

namespace {

constexpr float largest_step = 1.f / 64;  // of Kelemen et al., section 4.2; their smallest is a sixteenth of it

/// Numbers moved by steps whose lengths are distributed as 1 / length between the two limits, up for u >= 1/2 and down
/// for others, on the circle [0, 1) (section 4.2).
EightFloats perturbed(const EightFloats& numbers, const EightFloats& u) {
    const EightFloats v = 2 * u - (u >= 0.5f ? 1.f : 0.f);
    // (2^-v)^4 by the series of exp(-v ln 2), whose error is 2e-5. Steps up and down have the same lengths.
    const EightFloats x = -0.6931472f * v;
    EightFloats power = x * 0 + 1;
    for (const float n : {6.f, 5.f, 4.f, 3.f, 2.f, 1.f})
        power = 1 + x * power * (1 / n);
    const EightFloats step = largest_step * power * power * power * power;
    const EightFloats moved = u >= 0.5f ? numbers + step : numbers - step;
    const EightFloats wrapped = moved < 0.f ? moved + 1.f : moved >= 1.f ? moved - 1.f : moved;
    constexpr float most = 1 - std::numeric_limits<float>::epsilon() / 2;
    return wrapped < most ? wrapped : most;
}

}  // namespace

void PrimarySample::restart() {
    std::fill(table_.begin(), table_.end(), Block());
    changed_.clear();
    state_ = last_large_ = last_large_before_ = 1;
    used_ = 0;
}

void PrimarySample::propose(bool is_large) {
    ++state_;
    last_large_before_ = last_large_;
    if (is_large) last_large_ = state_;
}

void PrimarySample::reject() {
    for (const Block& before : changed_)
        find(before.key) = before;
    changed_.clear();
    last_large_ = last_large_before_;
    --state_;
}

PrimarySample::Block& PrimarySample::find(std::uint64_t key) {
    std::size_t i = key >> 1;
    while (table_[i &= table_.size() - 1].key != key && table_[i].key != 0)
        ++i;
    return table_[i];
}

void PrimarySample::grow() {
    const std::vector<Block> old = std::exchange(table_, std::vector<Block>(2 * table_.size()));
    for (const Block& block : old)
        if (block.key != 0) find(block.key) = block;
}

EightFloats PrimarySample::block(std::uint64_t path_key, std::uint32_t index, const EightFloats& fresh) {
    if (2 * used_ >= table_.size()) grow();
    // One hash of a key that is random already; combine_keys() would take two.
    const std::uint64_t key = mix64(path_key + index * 0x9e3779b97f4a7c15ull) | 1;  // not 0
    Block& block = find(key);
    if (block.state == state_) return block.numbers;
    changed_.push_back({block.numbers, key, block.state});
    used_ += block.key == 0;
    block.key = key;
    // Numbers that no state has asked for since the last large step are uniform, however often they were perturbed.
    if (block.state < last_large_) {
        block.numbers = fresh;
    } else {
        EightFloats u = fresh;
        for (std::uint32_t missed = state_ - block.state; missed > 0; --missed) {
            block.numbers = perturbed(block.numbers, u);
            u = unit_float(mix32(reinterpret_cast<Eight>(u) + missed));
        }
    }
    block.state = state_;
    return block.numbers;
}

}  // namespace gib
