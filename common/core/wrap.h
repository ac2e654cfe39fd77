#pragma once
// The continuation of images and grids beyond their edges.

#include <algorithm>
#include <cmath>

namespace gib {

/// The values beyond the edges: the image again, its mirror image, its outermost cells, or 0 or 1 everywhere.
enum class Wrap { repeat, mirror, clamp, zero, one };

/// The index that stands for every cell beyond the edges, where these have a value of their own.
constexpr int cell_beyond = -1;

/// Whether a constant lies beyond the edges.
inline bool ends_at_edges(Wrap wrap) { return wrap == Wrap::zero || wrap == Wrap::one; }

/// A coordinate reduced to its first period, [0, 1] or, if mirrored, [0, 2], so that no later step leaves the range
/// of int. Where a constant lies beyond the edges, it is reduced to [-1, 2]. A coordinate that is not finite becomes 0.
inline float reduced(float s, Wrap wrap) {
    if (!std::isfinite(s)) return 0;
    if (wrap == Wrap::repeat) return s - std::floor(s);
    if (wrap == Wrap::mirror) return s - 2 * std::floor(s / 2);
    return ends_at_edges(wrap) ? std::clamp(s, -1.f, 2.f) : std::clamp(s, 0.f, 1.f);
}

/// The cell that index `i` stands for in a row of `size` cells, or cell_beyond; i is at most one cell outside the first
/// period.
inline int wrapped(int i, int size, Wrap wrap) {
    if (ends_at_edges(wrap)) return i < 0 || i >= size ? cell_beyond : i;
    if (wrap == Wrap::clamp) return std::clamp(i, 0, size - 1);
    if (wrap == Wrap::repeat) return i < 0 ? i + size : i >= size ? i - size : i;
    if (i < 0) return -1 - i;
    if (i >= 2 * size) return i - 2 * size;
    return i < size ? i : 2 * size - 1 - i;
}

/// Two neighbouring cells along one axis; `weight` is the position between the centres of the first (0) and the
/// second (1).
struct Neighbours {
    int first, second;
    float weight;
};

/// The neighbours of a coordinate that grows by 1 over one image of the texture.
inline Neighbours neighbours(float s, int size, Wrap wrap) {
    const float x = reduced(s, wrap) * static_cast<float>(size) - 0.5f;
    const int i = static_cast<int>(std::floor(x));
    return {wrapped(i, size, wrap), wrapped(i + 1, size, wrap), x - static_cast<float>(i)};
}

/// The cell that holds a coordinate, measured as for neighbours().
inline int nearest_cell(float s, int size, Wrap wrap) {
    return wrapped(static_cast<int>(std::floor(reduced(s, wrap) * static_cast<float>(size))), size, wrap);
}

}  // namespace gib
