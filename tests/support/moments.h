#pragma once
// The mean of a sample and its standard error.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gib::test {

class Moments {
public:
    void add(double x) {
        ++count_;
        sum_ += x;
        squares_ += x * x;
        zeros_ += x == 0;
    }
    std::uint64_t count() const { return count_; }
    /// The number of added values that are 0.
    std::uint64_t zeros() const { return zeros_; }
    double mean() const { return mean_of(count_); }
    double standard_error() const { return standard_error_of(count_); }

    /// The mean and the standard error of n numbers: the added ones and zeros.
    double mean_of(std::uint64_t n) const { return sum_ / static_cast<double>(n); }
    double standard_error_of(std::uint64_t n) const {
        const auto size = static_cast<double>(n);
        const double variance = std::max(squares_ / size - mean_of(n) * mean_of(n), 0.0) * size / (size - 1);
        return std::sqrt(variance / size);
    }

private:
    std::uint64_t count_ = 0, zeros_ = 0;
    double sum_ = 0, squares_ = 0;
};

}  // namespace gib::test
