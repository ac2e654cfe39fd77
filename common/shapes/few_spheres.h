#pragma once
// The spheres of a scene with few of them, which are tested all at once. In Embree they would have a tree of their
// own, which every ray would go through after that of the triangles, and a callback each.

#include "common/shapes/shape.h"

#include <array>
#include <bit>

#ifdef __AVX__
#include <immintrin.h>
#endif

namespace gib {

class FewSpheres {
    using FourDoubles [[gnu::vector_size(32)]] = double;

public:
    /// At most as many spheres as two registers have doubles.
    static constexpr std::size_t most = 8;

    /// Adds at most `most` spheres.
    void add(const Sphere& sphere, std::uint32_t shape) {
        Four& four = fours_[count_ / 4];
        const std::size_t i = count_ % 4;
        four.x[i] = double{sphere.center.x()};
        four.y[i] = double{sphere.center.y()};
        four.z[i] = double{sphere.center.z()};
        four.r2[i] = sqr(double{sphere.radius});
        shapes_[count_++] = shape;
    }

    bool empty() const { return count_ == 0; }

    static constexpr std::uint32_t none = ~0u;
    /// The shape that the ray meets first, or none. `t_max` is where the ray ends, and becomes where it meets the shape.
    /// The two results do not share a register, which would wait until both are stored.
    [[gnu::noinline]] std::uint32_t intersect(const Ray& ray, float& t_max) const {
        std::uint32_t shape = none;
        for (std::size_t first = 0; first < count_; first += 4) {
            FourDoubles t;
            for (unsigned left = hits(fours_[first / 4], ray, t); left != 0; left &= left - 1) {
                const auto i = static_cast<std::size_t>(std::countr_zero(left));
                if (!(t[i] < double{t_max})) continue;
                t_max = static_cast<float>(t[i]);
                shape = shapes_[first + i];
            }
        }
        return shape;
    }
    [[gnu::noinline]] bool occluded(const Ray& ray) const {
        FourDoubles t;
        for (std::size_t first = 0; first < count_; first += 4)
            if (hits(fours_[first / 4], ray, t) != 0) return true;
        return false;
    }

private:
    /// The centres and squared radii of four spheres; one whose square is negative is not there.
    struct Four {
        FourDoubles x{}, y{}, z{}, r2 = {-1, -1, -1, -1};
    };

    /// The spheres, as bits, that the ray meets, and the t at which it does: intersect(Sphere, Ray) in four lanes.
    static unsigned hits(const Four& spheres, const Ray& ray, FourDoubles& t) {
        const double dx{ray.d.x()}, dy{ray.d.y()}, dz{ray.d.z()}, a = (dx * dx + dy * dy) + dz * dz;
        if (a == 0) return 0;
        const double per_a = 1 / a;
        const FourDoubles fx = double{ray.o.x()} - spheres.x, fy = double{ray.o.y()} - spheres.y,
                          fz = double{ray.o.z()} - spheres.z;
        const FourDoubles b = -((fx * dx + fy * dy) + fz * dz), along = b * per_a;
        const FourDoubles nx = fx + along * dx, ny = fy + along * dy, nz = fz + along * dz;
        const FourDoubles discriminant = spheres.r2 - ((nx * nx + ny * ny) + nz * nz);
        const auto meets = discriminant >= 0;
        if (bits_of(meets) == 0) return 0;
        const FourDoubles root = square_root(meets ? a * discriminant : FourDoubles{});
        const FourDoubles q = b < 0 ? b - root : b + root, product = ((fx * fx + fy * fy) + fz * fz) - spheres.r2;
        // q is 0 if the line touches at its origin, where `product` and both roots are 0.
        const FourDoubles first = product / (q == 0 ? 1 + q : q), second = q * per_a;
        const FourDoubles near = first > second ? second : first, far = first > second ? first : second;
        const double t_min{ray.t_min}, t_max{ray.t_max};
        t = near > t_min ? near : far;
        return bits_of(meets & (t > t_min) & (t < t_max));
    }

    template <typename Lanes>
    static unsigned bits_of(const Lanes& mask) {
#ifdef __AVX__
        return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(mask)));
#else
        unsigned bits = 0;
        for (unsigned i = 0; i < 4; ++i)
            bits |= mask[i] ? 1u << i : 0u;
        return bits;
#endif
    }
    static FourDoubles square_root(FourDoubles x) {
#ifdef __AVX__
        return reinterpret_cast<FourDoubles>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(x)));
#else
        for (unsigned i = 0; i < 4; ++i)
            x[i] = std::sqrt(x[i]);
        return x;
#endif
    }

    std::array<Four, most / 4> fours_;
    std::array<std::uint32_t, most> shapes_{};
    std::size_t count_ = 0;
};

}  // namespace gib
