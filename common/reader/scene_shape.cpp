#include "common/reader/scene_shape.h"

#include "common/core/float_traps.h"
#include "common/core/reject.h"
#include "common/mesh_files/curve_mesh.h"
#include "common/mesh_files/mesh_materials.h"

#include <algorithm>

namespace gib {

namespace {

/// Embree takes geometry up to this coordinate (its FLT_LARGE).
constexpr double largest_of_embree = 1.8e18;

bool mirrors(const Mat4d& to_world) { return unit_columns(to_world).determinant() < 0; }

/// Keeps the front of a mesh under a mirroring transform by reversing its triangles, for a mesh whose uv are given.
/// In Mitsuba the normals of rectangles, disks and vertices follow the inverse transpose of to_world, while those of
/// triangles follow the order of the vertices.
void swap_winding(MeshData& mesh) {
    for (auto& triangle : mesh.triangles)
        std::swap(triangle[1], triangle[2]);
}

/// Keeps the front of a mesh with normals under a mirroring transform. The order of the vertices stays, because
/// barycentric uv depend on it.
void keep_front_of_normals(ParsedMesh& mesh) {
    for (auto& n : mesh.data.normals)
        n = -n;
    mesh.flip_normals = !mesh.flip_normals;
}

/// The square [-1, 1]^2 in the plane z = 0, with its front towards +z.
ParsedMesh parse_rectangle(Properties& properties, const Mat4d& to_world) {
    ParsedMesh mesh;
    for (const auto& [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
        mesh.data.positions.emplace_back(x, y, 0);
        mesh.data.uvs.push_back(0.5f * (Vec2(static_cast<float>(x), static_cast<float>(y)) + Vec2::Ones()));
    }
    mesh.data.triangles = {{0, 1, 2}, {0, 2, 3}};
    if (mirrors(to_world)) swap_winding(mesh.data);
    transform_mesh(mesh.data, to_world);
    mesh.flip_normals = properties.boolean("flip_normals", false);
    return mesh;
}

/// The cube [-1, 1]^3, with its front outside. Faces share no vertices; uv of each face is (0, 0) at `corner`.
ParsedMesh parse_cube(Properties& properties, const Mat4d& to_world) {
    struct Face {
        Vec3d corner, u, v;  ///< v x u points outwards
    };
    const Vec3d x = Vec3d::UnitX(), y = Vec3d::UnitY(), z = Vec3d::UnitZ();
    const Face faces[] = {{-x - y - z, z, x}, {x + y + z, -x, -z}, {x - y + z, y, -z},
                          {-x - y + z, y, x}, {-x - y - z, y, z},  {-x + y - z, -y, x}};
    ParsedMesh mesh;
    for (const Face& face : faces) {
        const auto first = static_cast<std::uint32_t>(mesh.data.positions.size());
        for (const auto& [u, v] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1), std::pair(1, 0)}) {
            mesh.data.positions.push_back(face.corner + 2 * u * face.u + 2 * v * face.v);
            mesh.data.uvs.emplace_back(static_cast<float>(u), static_cast<float>(v));
        }
        mesh.data.triangles.push_back({first, first + 1, first + 2});
        mesh.data.triangles.push_back({first, first + 2, first + 3});
    }
    if (!properties.boolean("face_normals", false) && mirrors(to_world)) swap_winding(mesh.data);
    transform_mesh(mesh.data, to_world);
    mesh.flip_normals = properties.boolean("flip_normals", false);
    return mesh;
}

ParsedSphere parse_sphere(Properties& properties, const Mat4d& to_world) {
    const FloatTrapsPaused paused;  // a determinant beyond double's range is refused as a shear
    const Vec3d center = properties.point("center").value_or(Vec3d::Zero());
    const double radius = properties.positive("radius", 1);
    const Eigen::Matrix3d linear = to_world.topLeftCorner<3, 3>();
    const double scale = std::cbrt(std::abs(linear.determinant()));
    if (!(linear.transpose() * linear / (scale * scale)).isIdentity(1e-5))
        properties.reject("to_world", "the to_world of a sphere must scale uniformly and not shear");
    // Mitsuba reads a mirroring transform as a negative radius, which turns the normals.
    return {.center = linear * center + to_world.topRightCorner<3, 1>(),
            .radius = scale * radius,
            .flip_normals = properties.boolean("flip_normals", false) != mirrors(to_world),
            .axes = linear / scale};
}

/// The unit disk in the plane z = 0, with its front towards +z.
ParsedDisk parse_disk(Properties& properties, const Mat4d& to_world) {
    const Eigen::Matrix3d linear = to_world.topLeftCorner<3, 3>();
    const Vec3d du = linear.col(0), dv = linear.col(1);
    if (std::abs(du.stableNormalized().dot(dv.stableNormalized())) > 1e-6)
        properties.reject("to_world", "the to_world of a disk must not shear");
    const Vec3d normal = (unit_columns(to_world).inverse().transpose() * Vec3d::UnitZ()).normalized();
    return {.center = to_world.topRightCorner<3, 1>(),
            .du = du,
            .dv = dv,
            .normal = properties.boolean("flip_normals", false) ? Vec3d(-normal) : normal};
}

/// A cylinder from p0 to p1, with its front outside. A mirroring transform does not turn it inside out (Mitsuba takes
/// the normal of the mirrored parametrisation and flips it).
ParsedCylinder parse_cylinder(Properties& properties, const Mat4d& to_world) {
    const Vec3d p0 = properties.point("p0").value_or(Vec3d::Zero()),
                p1 = properties.point("p1").value_or(Vec3d::UnitZ());
    const double radius = properties.positive("radius", 1);
    const Vec3d half_axis = 0.5 * p1 - 0.5 * p0;  // finite even if p1 - p0 is not
    if (half_axis.isZero(0))
        throw InputError(properties.where(properties.has("p1") ? "p1" : "p0"), "'p0' and 'p1' are the same point");
    const Vec3d along = half_axis.stableNormalized();
    // u is 0 where Mitsuba has it. The axis from float is made orthogonal to `along` again in double.
    const Vec3d s0 = Frame(along.cast<float>()).s.cast<double>();
    const Vec3d s = (s0 - s0.dot(along) * along).normalized(), t = along.cross(s);
    const Eigen::Matrix3d linear = to_world.topLeftCorner<3, 3>();
    Eigen::Matrix3d axes;
    axes << linear * s, linear * t, linear * along;
    const double scale = axes.col(0).stableNorm();
    const Vec3d lengths(scale, scale, axes.col(2).stableNorm());
    const Eigen::Matrix3d unit = axes * lengths.cwiseInverse().asDiagonal();
    if (!(unit.transpose() * unit).isIdentity(1e-5))
        properties.reject(
            "to_world", "the to_world of a cylinder must scale alike in all directions across its axis and not shear");
    return {.base = linear * p0 + to_world.topRightCorner<3, 1>(),
            .axis = 2 * (linear * half_axis),
            .s = unit.col(0),
            .t = unit.col(1),
            .radius = scale * radius,
            .flip_normals = properties.boolean("flip_normals", false)};
}

struct MeshOptions {
    bool face_normals, flip_normals, flip_v;
    std::optional<double> smooth_angle = {};  ///< [degrees]
};

/// Applies the options of every mesh file, in Mitsuba's order. Normals that the file lacks are computed unless face
/// normals are wanted.
ParsedMesh finished_mesh(MeshData data, const MeshOptions& options, const Mat4d& to_world) {
    ParsedMesh mesh{std::move(data), options.flip_normals};
    if (options.flip_v)
        for (auto& uv : mesh.data.uvs)
            uv.y() = 1.f - uv.y();
    if (options.face_normals) mesh.data.normals.clear();
    if (!mesh.data.normals.empty() && mirrors(to_world)) keep_front_of_normals(mesh);
    transform_mesh(mesh.data, to_world);
    if (options.smooth_angle) compute_normals_between_creases(mesh.data, *options.smooth_angle);
    else if (!options.face_normals) compute_normals(mesh.data);
    return mesh;
}

/// Whether the bsdfs of an element are those of the materials of its OBJ file.
bool has_bsdf_by_material(const std::vector<NestedObject>& bsdfs, const MeshData& mesh) {
    return bsdfs.size() > 1 || std::any_of(bsdfs.begin(), bsdfs.end(), [&](const NestedObject& bsdf) {
               return std::any_of(mesh.materials.begin(), mesh.materials.end(), [&](const MaterialRun& run) {
                   return !bsdf.name.empty() && is_same_material(run.name, bsdf.name);
               });
           });
}

/// An obj file, whole or, if it has bsdfs for its materials, in parts.
ParsedShapes parse_obj_file(MeshData data, const std::vector<NestedObject>& bsdfs, const MeshOptions& options,
                            const Mat4d& to_world) {
    if (!has_bsdf_by_material(bsdfs, data)) return finished_mesh(std::move(data), options, to_world);
    ParsedShapes shapes;
    for (auto& part : parted_by_material(data))
        shapes.parts.push_back({finished_mesh(std::move(part.mesh), options, to_world), {}, part.material});
    return shapes;
}

/// Reads a file of curves, which become tubes.
ParsedMesh parse_curve_file(CurveKind kind, Properties& properties, const Mat4d& to_world, const FileFinder& files,
                            ContentHash& hash) {
    const std::string name = properties.required_string("filename");
    const std::string path = files.find(name, properties.element_where("filename"));
    const std::string content = read_file(path);
    hash.add(content);
    return {parse_curves(content, path, kind, to_world), properties.boolean("flip_normals", false)};
}

/// Reads an obj, ply, serialized or ms3d file.
ParsedShapes parse_mesh_file(const std::string& type, Properties& properties, const std::vector<NestedObject>& bsdfs,
                             const Mat4d& to_world, const FileFinder& files, ContentHash& hash) {
    const bool is_serialized = type == "serialized";
    const std::string name = properties.required_string("filename");
    MeshOptions options{properties.boolean("face_normals", false), properties.boolean("flip_normals", false),
                        !is_serialized && properties.boolean("flip_tex_coords", type == "obj")};
    if (properties.has("max_smooth_angle")) options.smooth_angle = properties.within("max_smooth_angle", 0, 0, 180);
    properties.declare("max_smooth_angle");
    properties.exclude("max_smooth_angle", "face_normals");
    const int index = is_serialized ? properties.integer("shape_index", 0).value_or(0) : 0;
    const std::string path = files.find(name, properties.element_where("filename"));
    const std::string content = read_file(path);
    hash.add(content);
    if (type == "ms3d") {
        ParsedShapes shapes;
        Ms3dModel model = parse_ms3d(content, path);
        for (auto& group : model.groups)
            shapes.parts.push_back({finished_mesh(std::move(group.mesh), options, to_world), group.material});
        shapes.materials = std::move(model.materials);
        return shapes;
    }
    if (is_serialized) {
        SerializedMesh mesh = parse_serialized(content, path, index);
        options.face_normals |= mesh.face_normals;
        return finished_mesh(std::move(mesh.data), options, to_world);
    }
    MeshData data = type == "obj" ? parse_obj(content, path) : parse_ply(content, path);
    std::vector<std::string> warnings = data.warnings.messages();
    ParsedShapes shapes = type == "obj" ? parse_obj_file(std::move(data), bsdfs, options, to_world)
                                        : ParsedShapes(finished_mesh(std::move(data), options, to_world));
    shapes.warnings = std::move(warnings);
    return shapes;
}

void check_range(const Vec3d& p, const SourceLocation& where) {
    // Each coordinate is compared by itself, because the largest coefficient may leave out NaN.
    if (!(p.array().abs() <= largest_of_embree).all())
        reject(where, "the shape has coordinates above {:g}", largest_of_embree);
}

Mesh recentred(ParsedMesh&& mesh, const Vec3d& origin, const SourceLocation& where) {
    Mesh result;
    result.vertices.resize(mesh.data.positions.size() + 1);  // the padding that Mesh asks for
    for (std::size_t i = 0; i < mesh.data.positions.size(); ++i) {
        const Vec3d p = mesh.data.positions[i] - origin;
        check_range(p, where);
        for (int k = 0; k < 3; ++k)
            result.vertices[i][static_cast<std::size_t>(k)] = static_cast<float>(p[k]);
    }
    result.triangles = std::move(mesh.data.triangles);
    result.normals = std::move(mesh.data.normals);
    result.uvs = std::move(mesh.data.uvs);
    result.flip_normals = mesh.flip_normals;
    return result;
}

Sphere recentred(const ParsedSphere& sphere, const Vec3d& origin, const SourceLocation& where) {
    check_range((sphere.center - origin).cwiseAbs() + Vec3d::Constant(sphere.radius), where);
    const auto radius = static_cast<float>(sphere.radius);
    if (!(radius > 0)) throw InputError(where, "the sphere's radius is too small");
    return {.center = (sphere.center - origin).cast<float>(),
            .radius = radius,
            .flip_normals = sphere.flip_normals,
            .axes = sphere.axes.cast<float>()};
}

Disk recentred(const ParsedDisk& disk, const Vec3d& origin, const SourceLocation& where) {
    check_range((disk.center - origin).cwiseAbs() + disk.du.cwiseAbs() + disk.dv.cwiseAbs(), where);
    const Disk result{.center = (disk.center - origin).cast<float>(),
                      .du = disk.du.cast<float>(),
                      .dv = disk.dv.cast<float>(),
                      .normal = disk.normal.cast<float>()};
    if (!(result.du.squaredNorm() > 0) || !(result.dv.squaredNorm() > 0))
        throw InputError(where, "the disk is too small");
    return result;
}

Cylinder recentred(const ParsedCylinder& c, const Vec3d& origin, const SourceLocation& where) {
    check_range((c.base - origin).cwiseAbs() + c.axis.cwiseAbs() + Vec3d::Constant(c.radius), where);
    const Cylinder result{.base = (c.base - origin).cast<float>(),
                          .axis = c.axis.cast<float>(),
                          .s = c.s.cast<float>(),
                          .t = c.t.cast<float>(),
                          .radius = static_cast<float>(c.radius),
                          .flip_normals = c.flip_normals};
    if (!(result.radius > 0) || !(result.axis.squaredNorm() > 0)) throw InputError(where, "the cylinder is too small");
    return result;
}

}  // namespace

ParsedShapes parse_shapes(Properties& properties, const std::vector<NestedObject>& bsdfs, const FileFinder& files,
                          ContentHash& hash) {
    const std::string& type =
        properties.plugin({"rectangle", "cube", "sphere", "disk", "cylinder", "obj", "ply", "serialized", "ms3d",
                           "linearcurve", "bsplinecurve", "shapegroup", "instance", "merge"});
    const Mat4d to_world = properties.transform("to_world");
    if (type == "rectangle") return parse_rectangle(properties, to_world);
    if (type == "cube") return parse_cube(properties, to_world);
    if (type == "sphere") return parse_sphere(properties, to_world);
    if (type == "disk") return parse_disk(properties, to_world);
    if (type == "cylinder") return parse_cylinder(properties, to_world);
    if (type == "linearcurve" || type == "bsplinecurve")
        return parse_curve_file(type == "linearcurve" ? CurveKind::linear : CurveKind::bspline, properties, to_world,
                                files, hash);
    return parse_mesh_file(type, properties, bsdfs, to_world, files, hash);
}

BoundsD bounds_of(const ParsedShape& shape) {
    BoundsD bounds;
    if (const auto* mesh = std::get_if<ParsedMesh>(&shape)) {
        for (const auto& triangle : mesh->data.triangles)
            for (const auto i : triangle)
                bounds.extend(mesh->data.positions[i]);
    } else if (const auto* sphere = std::get_if<ParsedSphere>(&shape)) {
        bounds.extend(Vec3d(sphere->center.array() - sphere->radius));
        bounds.extend(Vec3d(sphere->center.array() + sphere->radius));
    } else if (const auto* disk = std::get_if<ParsedDisk>(&shape)) {
        const Vec3d extent = (disk->du.cwiseAbs2() + disk->dv.cwiseAbs2()).cwiseSqrt();
        bounds.extend(disk->center - extent);
        bounds.extend(disk->center + extent);
    } else {
        const auto& cylinder = std::get<ParsedCylinder>(shape);
        const Vec3d extent = cylinder.radius * (cylinder.s.cwiseAbs2() + cylinder.t.cwiseAbs2()).cwiseSqrt();
        for (const Vec3d& end : {cylinder.base, Vec3d(cylinder.base + cylinder.axis)}) {
            bounds.extend(end - extent);
            bounds.extend(end + extent);
        }
    }
    return bounds;
}

BoundsD transformed(const Mat4d& to_world, const BoundsD& bounds) {
    if (bounds.isEmpty()) return bounds;
    const Eigen::Matrix3d linear = to_world.topLeftCorner<3, 3>();
    const Vec3d center = linear * bounds.center() + to_world.topRightCorner<3, 1>();
    const Vec3d extent = linear.cwiseAbs() * (0.5 * bounds.sizes());
    return {center - extent, center + extent};
}

void check_range(const BoundsD& bounds, const SourceLocation& where) {
    check_range(Vec3d(bounds.min().cwiseAbs().cwiseMax(bounds.max().cwiseAbs())), where);
}

Shape recentred(ParsedShape&& shape, const Vec3d& origin, const SourceLocation& where) {
    return std::visit([&](auto&& s) -> Shape { return recentred(std::move(s), origin, where); }, std::move(shape));
}

}  // namespace gib
