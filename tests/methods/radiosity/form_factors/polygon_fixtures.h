#pragma once
// Polygons for tests of form factors.

#include "common/sampling/sampler.h"
#include "methods/radiosity/form_factors/polygon_form_factor.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

namespace gib::test {

/// The parallelogram of the edges u and v, which faces u x v.
inline PatchPolygon rectangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
    return PatchPolygon::quad(corner, corner + u, corner + u + v, corner + v);
}

inline PatchPolygon moved(const PatchPolygon& polygon, const std::function<Vec3d(const Vec3d&)>& motion) {
    const auto& v = polygon.vertices;
    return polygon.count == 3 ? PatchPolygon::triangle(motion(v[0]), motion(v[1]), motion(v[2]))
                              : PatchPolygon::quad(motion(v[0]), motion(v[1]), motion(v[2]), motion(v[3]));
}

/// The n x n equal parts of a parallelogram.
inline std::vector<PatchPolygon> parts(const PatchPolygon& whole, int n) {
    const Vec3d u = (whole.vertices[1] - whole.vertices[0]) / n, v = (whole.vertices[3] - whole.vertices[0]) / n;
    std::vector<PatchPolygon> all;
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k)
            all.push_back(rectangle(whole.vertices[0] + i * u + k * v, u, v));
    return all;
}

/// The walls of the box [0, size], which face inwards; each is divided into n x n parts.
inline std::vector<PatchPolygon> box(const Vec3d& size, int n) {
    std::vector<PatchPolygon> all;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d u = Vec3d::Unit((axis + 1) % 3) * size[(axis + 1) % 3],
                    v = Vec3d::Unit((axis + 2) % 3) * size[(axis + 2) % 3], w = Vec3d::Unit(axis) * size[axis];
        for (const PatchPolygon& wall : {rectangle(Vec3d::Zero(), u, v), rectangle(w, v, u)})
            for (const PatchPolygon& part : parts(wall, n))
                all.push_back(part);
    }
    return all;
}

class RandomPolygons {
public:
    explicit RandomPolygons(std::uint64_t seed) : seed_(seed) {}

    double next() { return static_cast<double>(combine_keys(seed_, counter_++) >> 11) * 0x1p-53; }
    Vec3d direction() {
        const double z = 2 * next() - 1, r = std::sqrt(1 - z * z), phi = 2 * std::numbers::pi * next();
        return {r * std::cos(phi), r * std::sin(phi), z};
    }
    Eigen::Matrix3d rotation() {
        const double angle = 2 * std::numbers::pi * next();
        return Eigen::AngleAxisd(angle, direction()).toRotationMatrix();
    }
    /// A polygon whose corners lie on an ellipse around the centre in a random plane. One
    /// semi-axis is 1, the other at least `narrowest`.
    PatchPolygon polygon(const Vec3d& center, double narrowest = 0.3) {
        const Eigen::Matrix3d frame = rotation();
        const double width = narrowest + (1 - narrowest) * next();
        const int count = next() < 0.5 ? 3 : 4;
        std::array<Vec3d, 4> v;
        for (int i = 0; i < count; ++i) {
            const double angle = 2 * std::numbers::pi * (i + 0.7 * next()) / count;
            v[static_cast<std::size_t>(i)] = center + frame * Vec3d(std::cos(angle), width * std::sin(angle), 0);
        }
        return count == 3 ? PatchPolygon::triangle(v[0], v[1], v[2]) : PatchPolygon::quad(v[0], v[1], v[2], v[3]);
    }

private:
    std::uint64_t seed_, counter_ = 0;
};

}  // namespace gib::test
