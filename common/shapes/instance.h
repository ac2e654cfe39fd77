#pragma once
// Instances: copies of a group of shapes. A group is stored once, in its own coordinates; an instance maps its
// surfaces to the scene.

#include "common/shapes/shape.h"

#include <optional>
#include <vector>

namespace gib {

/// The map p_scene = linear p_group + translation, in double: a result on either side is then rounded to float only
/// once, however large the map's condition number is.
struct Instance {
    std::uint32_t group;
    Eigen::Matrix3d linear;
    Vec3d translation;
    Eigen::Matrix3d inverse;  ///< inverse of `linear`
};

/// An instance of `group`. Empty if the map is singular, or if it or its inverse scales by more than 1e12, because
/// floats could then not hold the group's coordinates.
std::optional<Instance> make_instance(std::uint32_t group, const Mat4d& to_scene);

/// The instances of a scene and their groups. The shapes of group g are [begin[g], begin[g + 1]) of the scene's
/// shapes; those before begin[0] belong to no group.
struct InstancedGroups {
    std::vector<std::uint32_t> begin;
    std::vector<Instance> instances;
};

/// A box in the scene that holds the instance of the box `in_group`.
Bounds transformed(const Instance& instance, const Bounds& in_group);
/// The same ray in the group's coordinates. A value of t stands for the same point on both rays.
Ray carried_to_group(const Instance& instance, const Ray& ray);

/// Maps a surface of the group to the scene. Normals are mapped by the inverse transpose, so that a mirroring map
/// does not turn a surface inside out (as in Mitsuba).
SurfaceGeometry carried_to_scene(const Instance& instance, const SurfaceGeometry& in_group);

/// The derivatives, in the scene's coordinates, at a point that carried_to_scene() returned.
SurfaceDerivatives derivatives_at(const Instance& instance, const Shape& shape, std::uint32_t primitive,
                                  const SurfaceGeometry& in_scene);
/// normal_derivative(), in the scene's coordinates, at such a point.
Eigen::Matrix3d normal_derivative(const Instance& instance, const Shape& shape, std::uint32_t primitive,
                                  const SurfaceGeometry& in_scene);

}  // namespace gib
