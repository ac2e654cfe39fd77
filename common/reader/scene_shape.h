#pragma once
// The <shape> elements of a scene file, in double and in the file's coordinates.

#include "common/mesh_files/mesh_ms3d.h"
#include "common/shapes/shape.h"
#include "common/xml/xml_properties.h"

namespace gib {

struct ParsedMesh {
    MeshData data;
    bool flip_normals = false;
};
struct ParsedSphere {
    Vec3d center;
    double radius;
    bool flip_normals;
    Eigen::Matrix3d axes;  ///< columns: where its x, y and z point, unit
};
struct ParsedDisk {
    Vec3d center, du, dv, normal;
};
struct ParsedCylinder {
    Vec3d base, axis, s, t;  ///< as of a Cylinder
    double radius;
    bool flip_normals;
};
using ParsedShape = std::variant<ParsedMesh, ParsedSphere, ParsedDisk, ParsedCylinder>;

/// What one element stands for: a single shape, or the groups of an ms3d file with the materials that it holds.
struct ParsedShapes {
    struct Part {
        ParsedShape shape;
        std::optional<std::uint32_t> material;  ///< index into materials
    };
    std::vector<Part> parts;
    std::vector<Ms3dMaterial> materials;

    ParsedShapes() = default;
    template <typename Shape>
    requires std::is_constructible_v<ParsedShape, Shape> ParsedShapes(Shape&& shape) {
        parts.push_back({std::forward<Shape>(shape), std::nullopt});  // a list would copy it
    }
};

using BoundsD = Eigen::AlignedBox3d;

/// A shape with a surface, with its own parameters; those that every shape takes are the caller's. The bytes of mesh
/// files are added to `hash`. Throws InputError, in the mesh file for what is wrong there.
ParsedShapes parse_shapes(Properties& properties, const FileFinder& files, ContentHash& hash);

BoundsD bounds_of(const ParsedShape& shape);
/// The box around a box that was moved.
BoundsD transformed(const Mat4d& to_world, const BoundsD& bounds);
/// Throws InputError at `where` for a box that ray queries cannot take.
void check_range(const BoundsD& bounds, const SourceLocation& where);

/// The shape in float, relative to `origin`. Throws InputError at `where` for what float cannot hold.
Shape recentred(ParsedShape&& shape, const Vec3d& origin, const SourceLocation& where);

}  // namespace gib
