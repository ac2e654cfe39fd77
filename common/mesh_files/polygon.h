#pragma once
// Parts the polygons of mesh files into triangles.

#include "common/core/error.h"
#include "common/core/math.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
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

/// The faces of a file that have fewer than three corners; they have no area and are left out.
class ShortFaces {
public:
    void add(const SourceLocation& where) {
        if (count_++ == 0) first_ = where;
    }
    /// Adds a warning of them, if there are any.
    void warn(std::vector<std::string>& warnings) const;

private:
    std::size_t count_ = 0;
    SourceLocation first_;
};

}  // namespace gib
