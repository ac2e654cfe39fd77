#pragma once
// The record of samples that are not finite: a film counts and drops them.

#include <cstdint>
#include <mutex>
#include <tuple>

namespace gib {

/// Samples that were not finite. They are counted and dropped (they count as black). With pass and pixel the first
/// can be reproduced.
struct NonFinite {
    std::uint64_t count = 0;
    std::uint32_t first_pass = 0;
    std::uint64_t first_pixel = 0;

    friend NonFinite operator+(const NonFinite& a, const NonFinite& b) {
        if (a.count == 0 || b.count == 0) return a.count == 0 ? b : a;
        const bool first = std::tie(a.first_pass, a.first_pixel) < std::tie(b.first_pass, b.first_pixel);
        NonFinite sum = first ? a : b;
        sum.count = a.count + b.count;
        return sum;
    }
};

/// Counts them over all threads of a film.
class NonFiniteCount {
public:
    void note(std::uint32_t pass, std::uint64_t pixel) {
        const std::scoped_lock lock(mutex_);
        counted_ = counted_ + NonFinite{1, pass, pixel};
    }
    NonFinite value() const {
        const std::scoped_lock lock(mutex_);
        return counted_;
    }

private:
    mutable std::mutex mutex_;
    NonFinite counted_;
};

}  // namespace gib
