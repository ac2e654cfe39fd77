#pragma once
// Random numbers as a pure function of (seed, index, pass, dimension). Nothing is stored between calls, so that a
// pixel, a photon or a pass can be replayed alone and the number of threads cannot matter.

#include "common/core/math.h"

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace gib {

/// Mixes 64 bits so that every input bit changes every output bit with probability near 1/2.
/// Source: Stafford's variant 13 of MurmurHash3's finaliser, as used by SplitMix64 (Steele et al. 2014).
inline std::uint64_t mix64(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// Combines two keys into one; their order matters.
inline std::uint64_t combine_keys(std::uint64_t a, std::uint64_t b) {
    return mix64(mix64(a + 0x9e3779b97f4a7c15ull) ^ (b + 0xd1b54a32d192ed03ull));
}

inline std::uint32_t reverse_bits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// The eight numbers that a path takes at a vertex, in one vector register.
using Eight [[gnu::vector_size(32)]] = std::uint32_t;
using EightFloats [[gnu::vector_size(32)]] = float;

/// Mixes 32 bits as mix64() mixes 64. Source: lowbias32 of C. Wellons, "Prospecting for Hash Functions" (2018). Its
/// output bits change with a probability closer to 1/2 than those of MurmurHash3's finaliser.
inline Eight mix32(Eight x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

/// The top 24 bits as a float in [0, 1): every value is a multiple of 2^-24, and 1 cannot be reached by rounding.
inline EightFloats unit_float(const Eight& bits) {
    using EightInts [[gnu::vector_size(32)]] = std::int32_t;
    return __builtin_convertvector(reinterpret_cast<EightInts>(bits >> 8), EightFloats) * 0x1p-24f;
}

/// Reverses the bits of eight numbers by table look-ups of half bytes; the path tracer's rate on the Cornell box
/// rises by 2 %.
inline Eight reverse_bits(const Eight& numbers) {
#ifdef __AVX2__
    const __m256i reversed_bytes =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
    const __m256i reversed_half = _mm256_broadcastsi128_si256(
        _mm_setr_epi8(0x0, 0x8, 0x4, 0xc, 0x2, 0xa, 0x6, 0xe, 0x1, 0x9, 0x5, 0xd, 0x3, 0xb, 0x7, 0xf));
    const __m256i x = _mm256_shuffle_epi8(reinterpret_cast<__m256i>(numbers), reversed_bytes);
    const __m256i half = _mm256_set1_epi8(0xf);
    const __m256i low = _mm256_and_si256(x, half), high = _mm256_and_si256(_mm256_srli_epi16(x, 4), half);
    return reinterpret_cast<Eight>(_mm256_or_si256(_mm256_slli_epi16(_mm256_shuffle_epi8(reversed_half, low), 4),
                                                   _mm256_shuffle_epi8(reversed_half, high)));
#else
    Eight reversed = numbers;
    for (std::size_t i = 0; i < 8; ++i)
        reversed[i] = reverse_bits(numbers[i]);
    return reversed;
#endif
}

/// Owen's nested uniform scrambling of a number given with its bits REVERSED (each bit is flipped by a hash of the bits
/// below it). Source: Laine and Karras 2011, section 3.1; Burley 2020, "Practical Hash-based Owen Scrambling", JCGT
/// 9(4); with the constants of Vegdahl 2021, "Building a Better LK Hash".
inline Eight scramble_reversed(Eight x, const Eight& seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// The second dimension of Sobol's sequence, with reversed bits. Its matrix is Pascal's triangle modulo 2, in which
/// C(i, j) is odd exactly if the bits of j are a subset of those of i (Lucas). The product of matrix and index is
/// therefore a sum over supersets, which takes five steps.
inline Eight sobol_second_reversed(Eight index) {
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 8) & 0x00ff00ffu;
    index ^= (index >> 16) & 0x0000ffffu;
    return index;
}

enum class PointSet {
    independent,  ///< independent random numbers
    sobol  ///< Owen-scrambled Sobol' points over the passes of one pixel, each pair of dimensions in its own order
};

/// The dimensions of a path from the eye or from a light. A dimension is a random point of the unit square; its name
/// says what the point decides. All methods use these names, so that no number is used twice.
namespace dimension {
inline constexpr std::uint32_t film = 0;
inline constexpr std::uint32_t lens = 1;
inline constexpr std::uint32_t stratum = 2;
inline constexpr std::uint32_t emission_light = 0;
inline constexpr std::uint32_t emission_position = 1;
inline constexpr std::uint32_t emission_direction = 2;
/// The dimension that chooses a photon's stratum of wavelengths; for a path from the eye, it is `stratum`.
inline constexpr std::uint32_t photon_stratum = 0x3fffffff;
inline constexpr std::uint32_t first_vertex = 3;
inline constexpr std::uint32_t choices = 0;  ///< x chooses a light, y decides whether the path goes on
inline constexpr std::uint32_t light_position = 1;
inline constexpr std::uint32_t bsdf_lobe = 2;
inline constexpr std::uint32_t bsdf_direction = 3;
inline constexpr std::uint32_t per_vertex = 4;
/// Dimension first_hole + n decides whether the path passes through the n-th surface with a mask that it meets.
inline constexpr std::uint32_t first_hole = 0x40000000;
/// Dimension first_of_stream + n holds number n of a NumberStream, which serves free flights through media and other
/// decisions that take an unknown count of numbers.
inline constexpr std::uint32_t first_of_stream = 0x50000000;
/// The dimension of `what` at vertex number `vertex` (the first surface hit is 0).
inline constexpr std::uint32_t at_vertex(int vertex, std::uint32_t what) {
    return first_vertex + static_cast<std::uint32_t>(vertex) * per_vertex + what;
}
}  // namespace dimension

/// Dimensions from this one on are independent random numbers in every point set: the integrand is too rough there
/// for Sobol' points to help, and a hash is cheaper.
inline constexpr std::uint32_t sobol_dimensions = dimension::at_vertex(4, 0);

/// The random numbers with which a path decides at one of its vertices.
class VertexNumbers {
public:
    explicit VertexNumbers(const EightFloats& numbers) : numbers_(numbers) {}

    float light_choice() const { return numbers_[2 * dimension::choices]; }
    float roulette() const { return numbers_[2 * dimension::choices + 1]; }
    Vec2 light_position() const { return point(dimension::light_position); }
    Vec2 bsdf_lobe() const { return point(dimension::bsdf_lobe); }
    Vec2 bsdf_direction() const { return point(dimension::bsdf_direction); }
    const EightFloats& all() const { return numbers_; }

private:
    Vec2 point(std::uint32_t dimension) const { return {numbers_[2 * dimension], numbers_[2 * dimension + 1]}; }

    static_assert(sizeof(EightFloats) == 2 * dimension::per_vertex * sizeof(float));
    EightFloats numbers_;
};

/// Numbers that are kept instead of hashed, such as the state of a Markov chain. They come in blocks of the size of a
/// vertex's: block b holds the points of the dimensions 4 b - 1 to 4 b + 2, so that block v + 1 belongs to vertex v.
class NumberStore {
public:
    virtual ~NumberStore() = default;
    /// The numbers, in [0, 1), of a block of one path. Split paths have keys of their own. `fresh` are the numbers that the
    /// sampler would have without a store.
    virtual EightFloats block(std::uint64_t path_key, std::uint32_t block, const EightFloats& fresh) = 0;
};

/// The random numbers of one path: `index` is its pixel or photon, `pass` its place in the sequence.
class Sampler {
public:
    /// The numbers of a store, which must outlive the sampler; fresh ones are those of `fresh`.
    Sampler(NumberStore& store, const Sampler& fresh) : Sampler(fresh) { store_ = &store; }
    Sampler(PointSet set, std::uint64_t seed, std::uint64_t index, std::uint32_t pass)
        : sobol_dimensions_(set == PointSet::sobol ? sobol_dimensions : 0), reversed_pass_(reverse_bits(pass)) {
        const std::uint64_t sequence = combine_keys(seed, index);
        sequence_key_ = Key(sequence);
        pass_key_ = Key(combine_keys(sequence, pass));
    }

    /// The random numbers of path i of n into which this path splits; `tag` must differ between the places where
    /// paths split. The split paths of all passes form one sequence in which each pass has n places, so that they are
    /// stratified over all passes.
    Sampler split(std::uint32_t i, std::uint32_t n, std::uint64_t tag) const {
        Sampler path = *this;
        const std::uint64_t sequence = combine_keys(sequence_key_.whole(), tag);
        const std::uint32_t place = reverse_bits(reversed_pass_) * n + i;
        path.reversed_pass_ = reverse_bits(place);
        path.sequence_key_ = Key(sequence);
        path.pass_key_ = Key(combine_keys(sequence, place));
        return path;
    }

    /// A number in [0, 1): the first coordinate of get_2d().
    float get_1d(std::uint32_t dimension) const { return get_2d(dimension).x(); }

    /// A point in [0, 1)^2. Different dimensions are independent of each other.
    Vec2 get_2d(std::uint32_t dimension) const {
        if (store_) [[unlikely]] {
            const EightFloats block = stored_block((dimension + 1) / 4);
            return {block[2 * ((dimension + 1) % 4)], block[2 * ((dimension + 1) % 4) + 1]};
        }
        const EightFloats all = numbers_from(dimension);
        return {all[0], all[1]};
    }

    /// The dimensions with which a path starts, 0 to 2, at once.
    std::array<Vec2, 3> at_start() const {
        if (store_) [[unlikely]] {
            const EightFloats b = stored_block(0);
            return {Vec2(b[2], b[3]), Vec2(b[4], b[5]), Vec2(b[6], b[7])};
        }
        const EightFloats n = numbers_from(0);
        return {Vec2(n[0], n[1]), Vec2(n[2], n[3]), Vec2(n[4], n[5])};
    }

    /// All dimensions of a vertex at once, as get_2d() returns them one by one.
    VertexNumbers at_vertex(int vertex) const {
        if (store_) [[unlikely]]
            return VertexNumbers(stored_block(static_cast<std::uint32_t>(vertex) + 1));
        return VertexNumbers(numbers_from(dimension::at_vertex(vertex, 0)));
    }

private:
    struct Key {
        std::uint32_t low = 0, high = 0;

        Key() = default;
        explicit Key(std::uint64_t key)
            : low(static_cast<std::uint32_t>(key)), high(static_cast<std::uint32_t>(key >> 32)) {}
        std::uint64_t whole() const { return std::uint64_t{high} << 32 | low; }
    };
    /// The step of a Weyl sequence: each number of a path adds another multiple of it to the key, so that no two have
    /// the same hash.
    static constexpr std::uint32_t step = 0x9e3779b9u;

    /// The numbers of dimension d and, if they are of the same kind, of the next three. A register of them takes less
    /// time than a single point in scalars, so that random numbers are cheap compared with ray queries.
    EightFloats numbers_from(std::uint32_t d) const {
        const Eight n = {0, 1, 2, 3, 4, 5, 6, 7};  // coordinate n % 2 of dimension d + n / 2
        return unit_float(d < sobol_dimensions_ ? sobol_numbers(d, n) : independent_numbers(d, n));
    }
    Eight sobol_numbers(std::uint32_t d, const Eight& n) const {
        const Eight shuffle = mix32(sequence_key_.low + d * step + (n / 2) * step);
        const Eight scramble = mix32(sequence_key_.high + 2 * d * step + n * step);
        const Eight index = reverse_bits(scramble_reversed(reversed_pass_ + 0 * n, shuffle));
        const Eight reversed = n % 2 == 0 ? index : sobol_second_reversed(index);
        return reverse_bits(scramble_reversed(reversed, scramble));
    }
    Eight independent_numbers(std::uint32_t d, const Eight& n) const {
        return mix32(mix32(pass_key_.low + 2 * d * step + n * step) ^ pass_key_.high);
    }

    static_assert(dimension::per_vertex == 4 && dimension::at_vertex(0, 0) == 3);  // blocks of a store
    EightFloats stored_block(std::uint32_t block) const {
        return store_->block(sequence_key_.whole(), block, numbers_from(4 * block - 1));
    }

    NumberStore* store_ = nullptr;    ///< null: numbers are hashed
    std::uint32_t sobol_dimensions_;  ///< 0 for independent numbers
    std::uint32_t reversed_pass_;
    Key sequence_key_, pass_key_;
};

/// Random numbers of a path one after another, for decisions that take an unknown count of them. They are independent
/// of all other numbers of the path.
class NumberStream {
public:
    /// `sampler` must outlive the stream. A path may have only one stream, because two would return the same numbers.
    explicit NumberStream(const Sampler& sampler) : sampler_(sampler) {}
    /// The next number in [0, 1).
    float next() { return sampler_.get_1d(dimension_++); }

private:
    const Sampler& sampler_;
    std::uint32_t dimension_ = dimension::first_of_stream;
};

}  // namespace gib
