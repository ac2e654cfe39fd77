#pragma once
// Copies of a group of shapes. A group is stored once, in coordinates of its own; an instance carries its surfaces to
// the scene.

#include "common/shapes/shape.h"

#include <optional>
#include <vector>

namespace gib {

/// p_scene = linear p_group + translation. In double: then each side is rounded once, whatever the map's condition.
struct Instance {
    std::uint32_t group;
    Eigen::Matrix3d linear;
    Vec3d translation;
    Eigen::Matrix3d inverse;  ///< of `linear`
};

/// Empty if the map is singular, or scales by more than 1e12 either way, so that the float of a group's coordinates
/// could not hold it.
std::optional<Instance> make_instance(std::uint32_t group, const Mat4d& to_scene);

/// The shapes of group g are [begin[g], begin[g + 1]) of a scene's shapes; those before begin[0] stand in the scene
/// itself.
struct InstancedGroups {
    std::vector<std::uint32_t> begin;
    std::vector<Instance> instances;
};

Bounds transformed(const Instance& instance, const Bounds& in_group);
/// The same ray in the group's coordinates; t means the same on both.
Ray carried_to_group(const Instance& instance, const Ray& ray);

/// A surface of the group in the scene. Normals go by the inverse transpose, so that a mirror does not turn a surface
/// inside out (Mitsuba's meaning).
SurfaceGeometry carried_to_scene(const Instance& instance, const SurfaceGeometry& in_group);

/// Of a point that carried_to_scene returned.
SurfaceDerivatives derivatives_at(const Instance& instance, const Shape& shape, std::uint32_t primitive,
                                  const SurfaceGeometry& in_scene);

}  // namespace gib
