#pragma once
// Where the rays can go that a light emits for a box of random numbers.
//
// A light's emission maps (u_position, u_direction), uniform in [0, 1)^4, to rays whose share of power is in proportion
// to volume there, whatever the light's own density; so the share of a box is its volume, and its rays are bounded by
// the continuity of the map. All bounds are conservative.

#include "common/lights/light.h"
#include "common/sampling/direction_cone.h"

#include <array>

namespace gib {

/// [lower, upper) of u_position.x, u_position.y, u_direction.x, u_direction.y.
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

/// Rays from a ball into a cone of directions, with all that lies in front of a ray; or the whole lines, if they come
/// from outside everything.
struct RayBundle {
    Vec3d center;
    double radius;
    DirectionCone cone;
    bool lines = false;
};

/// Holds every ray that sample_emission(light, ..) makes of numbers in the box.
RayBundle emission_bundle(const Light& light, const std::vector<Shape>& shapes, const EmissionBox& box);

/// Of the four numbers, those that the rays depend on.
std::array<bool, 4> emission_dimensions(const Light& light);

/// Where to cut a box in two along one of them; its own bound if it cannot be cut.
float split_point(const Light& light, const std::vector<Shape>& shapes, const EmissionBox& box, std::size_t dimension);

/// The light is the front of a convex surface: none of its rays meets it again.
bool cannot_see_itself(const AreaLight& light, const std::vector<Shape>& shapes);

}  // namespace gib
