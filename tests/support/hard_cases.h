#pragma once
// Scenes that are scaled and moved as a whole.

#include "common/core/math.h"
#include "tests/support/scene_builder.h"

#include <string>

namespace gib::test {

inline std::string diffuse_bsdf(double reflectance) { return bsdf("diffuse", rgb("reflectance", reflectance)); }
inline std::string sphere_at(const Vec3d& middle, double r, const std::string& inside) {
    return shape("sphere", center(middle.x(), middle.y(), middle.z()), radius(r), inside);
}

/// The placement of a whole scene: it is scaled, then moved.
struct Place {
    double scale = 1;
    Vec3d move = Vec3d::Zero();

    /// The to_world of a camera, which must not contain a scale.
    std::string view(const Vec3d& origin, const Vec3d& target) const {
        const auto text = [&](const Vec3d& p) {
            const Vec3d at = scale * p + move;
            return fmt::format("{}, {}, {}", at.x(), at.y(), at.z());
        };
        return to_world(look_at(text(origin), text(target)));
    }
    /// The to_world of a shape.
    std::string transform() const { return to_world(test::scale(scale), translate(move.x(), move.y(), move.z())); }
};

}  // namespace gib::test
