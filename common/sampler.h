#pragma once
// Random numbers as a pure function of (seed, index, pass, dimension): nothing is stored between calls, so a pixel, a
// photon or a pass can be replayed alone and the number of threads cannot matter.

#include "common/math.h"

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

namespace gib {

/// Mixes 64 bits so that every input bit changes every output bit with probability near 1/2.
/// Source: Stafford's variant 13 of MurmurHash3's finaliser, as used by SplitMix64 (Steele et al. 2014).
inline std::uint64_t mix64(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// One key out of two; not symmetric.
inline std::uint64_t combine_keys(std::uint64_t a, std::uint64_t b) {
    return mix64(mix64(a + 0x9e3779b97f4a7c15ull) ^ (b + 0xd1b54a32d192ed03ull));
}

/// The top 24 bits as a float in [0, 1): every value is a multiple of 2^-24, and 1 cannot be reached by rounding.
inline float unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

inline std::uint32_t reverse_bits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Owen's nested uniform scrambling of a number given with its bits REVERSED (each bit is flipped by a hash of the bits
/// below it). Source: Laine and Karras 2011, section 3.1; Burley 2020, "Practical Hash-based Owen Scrambling", JCGT
/// 9(4).
inline std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// Sobol's second dimension with reversed bits. Its matrix is Pascal's triangle modulo 2, C(i, j) odd exactly if j's
/// bits are a subset of i's (Lucas), so the product is a sum over supersets, done in five steps.
inline std::uint32_t sobol_second_reversed(std::uint32_t index) {
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 8) & 0x00ff00ffu;
    index ^= (index >> 16) & 0x0000ffffu;
    return index;
}

enum class PointSet {
    independent,  ///< independent random numbers
    sobol         ///< Owen-scrambled Sobol' points over the passes of one pixel, each pair of dimensions shuffled apart
};
inline constexpr std::array<std::string_view, 2> point_set_names = {"independent", "sobol"};

/// Higher dimensions are independent in every set: the integrand is too rough there for a net to help, and a hash is
/// cheaper.
inline constexpr std::uint32_t sobol_dimensions = 20;

/// The random numbers of one path: `index` is its pixel or photon, `pass` its place in the sequence.
class Sampler {
public:
    Sampler(PointSet set, std::uint64_t seed, std::uint64_t index, std::uint32_t pass)
        : sobol_dimensions_(set == PointSet::sobol ? sobol_dimensions : 0),
          pass_(pass),
          sequence_key_(combine_keys(seed, index)),
          pass_key_(combine_keys(sequence_key_, pass)) {}

    /// A number in [0, 1).
    float get_1d(std::uint32_t dimension) const { return get_2d(dimension).x(); }

    /// A point in [0, 1)^2. Different dimensions are independent of each other.
    Vec2 get_2d(std::uint32_t dimension) const {
        const bool sobol = dimension < sobol_dimensions_;
        const std::uint64_t bits = mix64((sobol ? sequence_key_ : pass_key_) + (dimension + 1) * 0x9e3779b97f4a7c15ull);
        const auto low = static_cast<std::uint32_t>(bits);
        const auto high = static_cast<std::uint32_t>(bits >> 32);
        if (!sobol) return {unit_float(low), unit_float(high)};
        // Three scramblings from one hash: of the order of the points, of x, and of y.
        const std::uint32_t index = reverse_bits(scramble_reversed(reverse_bits(pass_), low));
        const std::uint32_t x = reverse_bits(scramble_reversed(index, high));
        const std::uint32_t y =
            reverse_bits(scramble_reversed(sobol_second_reversed(index), (low ^ std::rotl(high, 13)) * 0x9e3779b1u));
        return {unit_float(x), unit_float(y)};
    }

private:
    std::uint32_t sobol_dimensions_;  ///< 0 for independent numbers
    std::uint32_t pass_;
    std::uint64_t sequence_key_, pass_key_;
};

/// The dimensions of a path from the eye or from a light: which number decides what. The same everywhere, so that a
/// value is never used twice.
namespace dimension {
inline constexpr std::uint32_t film = 0;
inline constexpr std::uint32_t lens = 1;
inline constexpr std::uint32_t emission_light = 0;
inline constexpr std::uint32_t emission_position = 1;
inline constexpr std::uint32_t emission_direction = 2;
inline constexpr std::uint32_t first_vertex = 3;
inline constexpr std::uint32_t light_choice = 0;
inline constexpr std::uint32_t light_position = 1;
inline constexpr std::uint32_t bsdf_lobe = 2;
inline constexpr std::uint32_t bsdf_direction = 3;
inline constexpr std::uint32_t roulette = 4;
inline constexpr std::uint32_t per_vertex = 5;
/// Whether the n-th surface with holes on a path is there: first_hole + n.
inline constexpr std::uint32_t first_hole = 0x40000000;
/// The dimension of `what` at vertex number `vertex` (the first surface hit is 0).
inline constexpr std::uint32_t at_vertex(int vertex, std::uint32_t what) {
    return first_vertex + static_cast<std::uint32_t>(vertex) * per_vertex + what;
}
}  // namespace dimension

}  // namespace gib
