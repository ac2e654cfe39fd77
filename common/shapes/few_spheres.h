#pragma once
// The spheres of a scene with few of them, which are tested all at once. In Embree they would have a tree of their
// own, which every ray would go through after that of the triangles, and a callback each.

#include "common/sampling/sampler.h"
#include "common/shapes/shape.h"

#include <array>
#include <bit>

namespace gib {

/// At most as many spheres as a register has floats.
class FewSpheres {
public:
    static constexpr std::size_t most = 8;

    /// Adds at most `most` spheres, which must outlive this.
    void add(const Sphere& sphere, std::uint32_t shape) {
        x_[count_] = sphere.center.x();
        y_[count_] = sphere.center.y();
        z_[count_] = sphere.center.z();
        r2_[count_] = sqr(sphere.radius) + smallest;
        spheres_[count_] = &sphere;
        shapes_[count_++] = shape;
    }

    bool empty() const { return count_ == 0; }

    /// The shape that the ray meets first, and ends at from then on. Empty if it meets none.
    [[gnu::noinline]] std::optional<std::uint32_t> intersect(Ray& ray) const {
        std::optional<std::uint32_t> shape;
        for (unsigned left = candidates(ray); left != 0; left &= left - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(left));
            const auto t = gib::intersect(*spheres_[i], ray);
            if (!t) continue;
            ray.t_max = *t;
            shape = shapes_[i];
        }
        return shape;
    }
    [[gnu::noinline]] bool occluded(const Ray& ray) const {
        for (unsigned left = candidates(ray); left != 0; left &= left - 1)
            if (gib::intersect(*spheres_[static_cast<std::size_t>(std::countr_zero(left))], ray)) return true;
        return false;
    }

private:
    static constexpr float smallest = 1e-30f;  ///< squared lengths below it may have lost digits
    /// The spheres, as bits, that the ray may meet: those that its line passes within the radius, unless they lie
    /// behind it. The rounding of a squared distance to the line is less than `rounding` times the squared distance to
    /// the origin; numbers that have left the range of floats compare as false, so that their sphere stays.
    unsigned candidates(const Ray& ray) const {
        const unsigned all = (1u << count_) - 1;
        const float d2 = ray.d.squaredNorm();
        if (!(d2 > smallest)) return all;
        constexpr float rounding = 64 * unit_roundoff;
        const EightFloats fx = x_ - ray.o.x(), fy = y_ - ray.o.y(), fz = z_ - ray.o.z();
        const EightFloats far2 = fx * fx + fy * fy + fz * fz;
        const EightFloats t = (fx * ray.d.x() + fy * ray.d.y() + fz * ray.d.z()) / d2;
        const EightFloats nx = fx - t * ray.d.x(), ny = fy - t * ray.d.y(), nz = fz - t * ray.d.z();
        const EightFloats bound = r2_ + rounding * far2;
        const auto misses = (nx * nx + ny * ny + nz * nz > bound) | ((t < 0.f) & (far2 > bound));
        unsigned hits = 0;
#ifdef __AVX__
        hits = ~static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(misses)));
#else
        for (unsigned i = 0; i < most; ++i)
            hits |= misses[i] ? 0u : 1u << i;
#endif
        return hits & all;
    }

    EightFloats x_{}, y_{}, z_{}, r2_{};
    std::array<const Sphere*, most> spheres_{};
    std::array<std::uint32_t, most> shapes_{};
    std::size_t count_ = 0;
};

}  // namespace gib
