#pragma once
// The place at which a texture is looked up.

#include "common/core/math.h"

#include <cstdint>

namespace gib {

/// A place on a surface: its texture coordinates and, on a mesh, its triangle with the barycentric weights of the
/// triangle's second and third vertex.
struct TexturePoint {
    Vec2 uv;
    std::uint32_t triangle = 0;
    Vec2 weights = Vec2::Zero();

    TexturePoint(const Vec2& coordinates) : uv(coordinates) {}  // implicit: most textures need no more
    TexturePoint(const Vec2& coordinates, std::uint32_t of_mesh, const Vec2& of_vertices)
        : uv(coordinates), triangle(of_mesh), weights(of_vertices) {}
};

}  // namespace gib
