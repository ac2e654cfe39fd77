#pragma once
// Reads the <shape> elements of a scene file, in double and in the file's coordinates.

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
    Eigen::Matrix3d axes;  ///< unit columns: the directions of its x, y and z
};
struct ParsedDisk {
    Vec3d center, du, dv, normal;
};
struct ParsedCylinder {
    Vec3d base, axis, s, t;  ///< as in Cylinder
    double radius;
    bool flip_normals;
};
using ParsedShape = std::variant<ParsedMesh, ParsedSphere, ParsedDisk, ParsedCylinder>;

/// The content of one element: a single shape, or the groups of an ms3d file with the file's materials.
struct ParsedShapes {
    struct Part {
        ParsedShape shape;
        std::optional<std::uint32_t> material;  ///< index into materials
        std::optional<std::string>
            material_name{};  ///< name of the material in an OBJ file whose element has a bsdf for each material
    };
    std::vector<Part> parts;
    std::vector<Ms3dMaterial> materials;
    std::vector<std::string> warnings;  ///< about the file

    ParsedShapes() = default;
    template <typename Shape>
    requires std::is_constructible_v<ParsedShape, Shape> ParsedShapes(Shape&& shape) {
        parts.push_back({std::forward<Shape>(shape), std::nullopt});  // an initialiser list would copy it
    }
};

using BoundsD = Eigen::AlignedBox3d;

/// Reads a shape that has a surface, with the parameters of its own; the caller reads the parameters of all shapes.
/// The bytes of mesh files are added to `hash`. An OBJ file is parted by its materials if the element has several `bsdfs`
/// or one whose name is that of a material. Throws InputError, for an error inside a mesh file at its place in
/// that file.
ParsedShapes parse_shapes(Properties& properties, const std::vector<NestedObject>& bsdfs, const FileFinder& files,
                          ContentHash& hash);

BoundsD bounds_of(const ParsedShape& shape);
/// The box around a transformed box.
BoundsD transformed(const Mat4d& to_world, const BoundsD& bounds);
/// Throws InputError at `where` for a box that is too large for ray queries.
void check_range(const BoundsD& bounds, const SourceLocation& where);

/// The shape in float, relative to `origin`. Throws InputError at `where` for a shape that float cannot hold.
Shape recentred(ParsedShape&& shape, const Vec3d& origin, const SourceLocation& where);

}  // namespace gib
