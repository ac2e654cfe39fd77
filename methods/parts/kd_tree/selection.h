#pragma once
// Selection of the k-th smallest element without branches that depend on the data, since std::nth_element mispredicts
// every other comparison.

#include <algorithm>
#include <array>
#include <cstddef>

namespace gib {

/// Does the same as std::nth_element for elements whose keys all differ: *kth becomes the element that sorting would
/// put there, with the smaller ones before it and the larger ones behind it. key(element) is an unsigned integer. It
/// takes about 1.5 n comparisons for large n: the first pivot, from a sample, lies a little beyond the k-th element
/// and cuts the larger part off; the second pivot cuts off the rest. The resulting order depends only on the order
/// given. Source: Floyd and Rivest 1975, "Expected time bounds for selection".
template <typename T, typename Key>
void select_kth(T* begin, T* kth, T* end, const Key& key) {
    constexpr std::ptrdiff_t sorted_size = 3, small = 256, medium = 2048, largest_sample = 127;
    for (int rounds = 100; end - begin > sorted_size; --rounds) {
        if (rounds == 0) {  // the samples have misled the search
            std::nth_element(begin, kth, end, [&](const T& a, const T& b) { return key(a) < key(b); });
            return;
        }
        // The pivot comes from a sample at equal steps. Its rank there is that of the k-th element, moved by about a
        // standard deviation towards the far end. It is never the lowest of the sample, so some element is smaller
        // than it, and neither part is empty (the pivot itself belongs to the upper one).
        const std::ptrdiff_t n = end - begin;
        auto pivot = key(begin[n / 2]);
        if (n < small) {
            const auto a = key(*begin), b = key(end[-1]);
            pivot = std::max(std::min(a, b), std::min(std::max(a, b), pivot));
        } else {
            const std::ptrdiff_t sample = n < medium ? 9 : largest_sample;
            const std::ptrdiff_t margin = n < medium ? 1 : 8;
            std::array<decltype(pivot), largest_sample> keys;
            for (std::ptrdiff_t i = 0; i < sample; ++i)
                keys[static_cast<std::size_t>(i)] = key(begin[(2 * i + 1) * n / (2 * sample)]);
            const std::ptrdiff_t expected = (kth - begin) * sample / n;
            const std::ptrdiff_t rank = std::clamp<std::ptrdiff_t>(
                2 * (kth - begin) < n ? expected + margin : expected - margin, 1, sample - 1);
            std::nth_element(keys.begin(), keys.begin() + rank, keys.begin() + sample);
            pivot = keys[static_cast<std::size_t>(rank)];
        }
        T* middle = begin;
        for (T* i = begin; i < end; ++i) {
            const T element = *i;
            *i = *middle;
            *middle = element;
            middle += key(element) < pivot ? 1 : 0;
        }
        if (kth < middle) end = middle;
        else begin = middle;
    }
    std::sort(begin, end, [&](const T& a, const T& b) { return key(a) < key(b); });
}

}  // namespace gib
