#pragma once
// The surfaces of a scene as triangles with colours, to be drawn by a graphics processor.

#include <array>
#include <cstdint>
#include <vector>

namespace gib {

class Scene;

/// Triangles that share no corners: each has three after one another in every vector.
struct SurfaceTriangles {
    std::vector<std::array<float, 3>> positions;      ///< [scene units]
    std::vector<std::array<std::int8_t, 4>> normals;  ///< unit normals times 127, of either side; the fourth is 0
    std::vector<std::array<std::uint8_t, 4>> colors;  ///< linear RGB times 255, the fourth is 255
    std::size_t opaque = 0;                           ///< the first triangles, which have diffuse reflectance or emit
    std::uint64_t whole = 0;                          ///< triangles of the whole scene that have an area

    std::size_t count() const { return positions.size() / 3; }
};

/// The triangles of meshes, and spheres, disks and cylinders cut into triangles; those of instances in their places.
/// The colour is the diffuse reflectance in the middle of a triangle; lamps are light yellow, and surfaces without
/// diffuse reflectance have the colour of what they reflect and transmit, tinted blue. Of scenes with more than
/// `most` triangles, each shape shows some, taken at even steps.
SurfaceTriangles surface_triangles(const Scene& scene, std::size_t most);

}  // namespace gib
