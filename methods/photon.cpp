#include "methods/photon.h"

namespace gib {

namespace {

Vec2 sign_not_zero(const Vec2& v) { return {std::copysign(1.f, v.x()), std::copysign(1.f, v.y())}; }

Vec2 octahedral(const Vec3& w) {
    const Vec2 p = w.head<2>() / w.cwiseAbs().sum();
    if (w.z() >= 0.f) return p;
    return (Vec2::Ones() - p.cwiseAbs().reverse()).cwiseProduct(sign_not_zero(p));
}

Vec3 from_octahedral(const Vec2& p) {
    Vec3 w(p.x(), p.y(), 1.f - p.cwiseAbs().sum());
    if (w.z() < 0.f) w.head<2>() = (Vec2::Ones() - p.cwiseAbs().reverse()).cwiseProduct(sign_not_zero(p)).eval();
    return w.normalized();
}

/// [-1, 1] to 0 .. 2 `half` and back, with 0 and +-1 exact.
std::uint32_t quantise(float x, float half) { return static_cast<std::uint32_t>(std::lround((x + 1.f) * half)); }
float dequantise(std::uint32_t x, float half) { return static_cast<float>(x) / half - 1.f; }

}  // namespace

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
