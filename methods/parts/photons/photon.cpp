#include "methods/parts/photons/photon.h"

namespace gib {

namespace {

Vec2 sign_not_zero(const Vec2& v) { return {std::copysign(1.f, v.x()), std::copysign(1.f, v.y())}; }

/// The octahedral map (Cigolle et al. 2014): a unit vector to [-1, 1]^2.
Vec2 octahedral(const Vec3& w) {
    const float sum = w.cwiseAbs().sum(), x = w.x() / sum, y = w.y() / sum;
    const bool folded = !(w.z() >= 0.f);
    return {folded ? std::copysign(1.f - std::abs(y), x) : x, folded ? std::copysign(1.f - std::abs(x), y) : y};
}

Vec3 from_octahedral(const Vec2& p) {
    Vec3 w(p.x(), p.y(), 1.f - p.cwiseAbs().sum());
    if (w.z() < 0.f) w.head<2>() = (Vec2::Ones() - p.cwiseAbs().reverse()).cwiseProduct(sign_not_zero(p)).eval();
    return w.normalized();
}

/// Rounds x in [-1, 1] to a whole number in [0, 2 half], so that 0 and +-1 are exact; dequantise() is the inverse.
std::uint32_t quantise(float x, float half) { return static_cast<std::uint32_t>(std::lround((x + 1.f) * half)); }
float dequantise(std::uint32_t x, float half) { return static_cast<float>(x) / half - 1.f; }

constexpr int smallest_exponent = -126;
constexpr std::uint8_t not_finite = 254;  // its unit is infinite; a mantissa of 0 times that is not a number

/// 2^s for s from -126 to 127.
float power_of_two(int s) { return std::bit_cast<float>(static_cast<std::uint32_t>(s + 127) << 23); }

}  // namespace

PhotonPayload::PhotonPayload(const Color& power, const Vec3& wi, const Vec3& normal, int path_edges, bool in_medium,
                             std::optional<int> stratum)
    : power_(power, static_cast<std::uint8_t>(static_cast<int>(in_medium) + 2 * (stratum ? *stratum + 1 : 0))),
      wi_(encode_direction(wi)),
      normal_(encode_normal(normal)),
      edges(static_cast<std::uint16_t>(path_edges)) {}

PackedColor::PackedColor(const Color& power, std::uint8_t tag) : mantissa_{0, 0, 0}, exponent_(0), tag_(tag) {
    if (!power.isFinite().all() || (power < 0.f).any()) {
        exponent_ = not_finite;
        return;
    }
    const float largest = power.maxCoeff();
    if (largest == 0.f) return;
    const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(largest) >> 23) - 127;  // of a subnormal -127
    int s = std::max(exponent - 15, smallest_exponent);
    // Mantissas are rounded to nearest, ties to even, as truncation would darken every sum.
    if (std::lrint(largest * power_of_two(-s)) > 0xffff) ++s;
    for (Eigen::Index c = 0; c < 3; ++c)
        mantissa_[static_cast<std::size_t>(c)] = static_cast<std::uint16_t>(std::lrint(power[c] * power_of_two(-s)));
    exponent_ = static_cast<std::uint8_t>(s - smallest_exponent);
}

double photon_power_unit(const Colord& emitted, std::uint64_t count) {
    const double mean = emitted.maxCoeff() / static_cast<double>(count);
    return mean > 0 && std::isfinite(mean) ? std::scalbn(1.0, std::ilogb(mean)) : 1;
}

std::uint32_t encode_direction(const Vec3& w) {
    const Vec2 p = octahedral(w);
    return quantise(p.x(), 32767.f) | quantise(p.y(), 32767.f) << 16;
}
Vec3 decode_direction(std::uint32_t code) {
    return from_octahedral({dequantise(code & 0xffffu, 32767.f), dequantise(code >> 16, 32767.f)});
}
std::uint16_t encode_normal(const Vec3& n) {
    const Vec2 p = octahedral(n);
    return static_cast<std::uint16_t>(quantise(p.x(), 127.f) | quantise(p.y(), 127.f) << 8);
}
Vec3 decode_normal(std::uint16_t code) {
    return from_octahedral({dequantise(code & 0xffu, 127.f), dequantise(static_cast<std::uint32_t>(code) >> 8, 127.f)});
}

}  // namespace gib
