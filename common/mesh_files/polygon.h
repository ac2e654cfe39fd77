#pragma once
// Parts the polygons of mesh files into triangles.

#include "common/core/math.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace gib {

/// A polygon of more than three corners that stands in a mesh as a fan: `corners` - 2 triangles from number `first` on,
/// all with the polygon's first corner.
struct Fan {
    std::size_t first;
    std::uint32_t corners;
};

/// Replaces each fan that does not cover its polygon by a triangulation that does, with as many triangles. A fan is
/// right if all its triangles face the way of the polygon, as they do in every convex one.
/// Others lose their ears one by one: corners whose triangle holds no other corner (Meisters 1975, "Polygons have
/// ears", American Mathematical Monthly 82(6)). The facing is that along the polygon's area vector, half the sum of the
/// cross products of its corners, so that a polygon need not be quite plane. What remains of a polygon that crosses
/// itself, or that has no area, stays a fan. The time is quadratic in the number of corners, cubic at worst.
void triangulate_fans(std::span<const Vec3d> positions, std::vector<std::array<std::uint32_t, 3>>& triangles,
                      std::span<const Fan> fans);

}  // namespace gib
