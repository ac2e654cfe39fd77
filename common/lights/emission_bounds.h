#pragma once
// Bounds of the rays that a light emits for a box of random numbers.
//
// A light's emission maps (u_position, u_direction), uniform in [0, 1)^4, to rays. The share of samples that fall
// into a box is the box's volume, whatever the light's own density is. The continuity of the map bounds the rays of a
// box. All bounds are conservative.

#include "common/lights/light.h"
#include "common/sampling/direction_cone.h"

#include <array>

namespace gib {

/// The ranges [lower, upper) of u_position.x, u_position.y, u_direction.x, u_direction.y.
struct EmissionBox {
    std::array<float, 4> lower = {0.f, 0.f, 0.f, 0.f}, upper = {1.f, 1.f, 1.f, 1.f};

    float width(std::size_t i) const { return upper[i] - lower[i]; }
    double volume() const {
        double product = 1;
        for (std::size_t i = 0; i < 4; ++i)
            product *= static_cast<double>(upper[i]) - static_cast<double>(lower[i]);
        return product;
    }
};

/// Rays that start in a ball and go into a cone of directions. With `lines` the rays start outside of the scene:
/// their lines pass through the ball and count over their whole length.
struct RayBundle {
    Vec3d center;
    double radius;
    DirectionCone cone;
    bool lines = false;
};

/// A bundle that holds every ray that sample_emission(light, ..) makes from numbers in the box.
RayBundle emission_bundle(const Light& light, const std::vector<Shape>& shapes, const EmissionBox& box);

/// Which of the four numbers the rays depend on.
std::array<bool, 4> emission_dimensions(const Light& light);

/// Where to cut a box in two along one of its dimensions; one of the box's own bounds if it cannot be cut.
float split_point(const Light& light, const std::vector<Shape>& shapes, const EmissionBox& box, std::size_t dimension);

/// Whether the light is the front of a convex surface, so that none of its rays meets it again.
bool cannot_see_itself(const AreaLight& light, const std::vector<Shape>& shapes);

}  // namespace gib
