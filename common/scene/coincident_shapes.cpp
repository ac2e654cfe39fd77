#include "common/scene/coincident_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace gib {

namespace {

/// A key that is equal for two pieces of surface in the same place: three vertices in sorted order, or the numbers of
/// a sphere, a disk or a cylinder without the direction of its normal.
using Place = std::array<float, 11>;

/// The place of a triangle, and whether its front is on the other side than that of the same vertices
/// in sorted order.
std::pair<Place, bool> place_of_triangle(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
    std::array<std::array<float, 3>, 3> corners = {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]],
                                                   mesh.vertices[triangle[2]]};
    bool turned = mesh.flip_normals;
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)})  // sorts them
        if (corners[b] < corners[a]) {
            std::swap(corners[a], corners[b]);
            turned = !turned;
        }
    const auto& [p, q, r] = corners;
    return {{0, p[0], p[1], p[2], q[0], q[1], q[2], r[0], r[1], r[2], 0}, turned};
}

Place place_of(const Sphere& s) { return {1, s.center.x(), s.center.y(), s.center.z(), s.radius, 0, 0, 0, 0, 0, 0}; }

Place place_of(const Disk& d) {
    return {2, d.center.x(), d.center.y(), d.center.z(), d.du.x(), d.du.y(), d.du.z(), d.dv.x(), d.dv.y(), d.dv.z(), 0};
}

Place place_of(const Cylinder& c) {
    return {3, c.base.x(), c.base.y(), c.base.z(), c.axis.x(), c.axis.y(), c.axis.z(), c.radius, 0, 0, 0};
}

/// The normal of the front of a triangle; zero if it has no area.
Vec3d unit_normal(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
    const Vec3d a = mesh.vertex(t[0]).cast<double>();
    const Vec3d n = (mesh.vertex(t[1]).cast<double>() - a).cross(mesh.vertex(t[2]).cast<double>() - a);
    return n.stableNormalized();
}

/// Whether triangles i and i + 1 are the halves of a plane quadrilateral, as in rectangles and cubes. It is also parted
/// by its other diagonal, so it must be convex: two neighbours in a fan about an inner point may not be.
bool is_plane_quad(const Mesh& mesh, std::size_t i) {
    if (i + 1 >= mesh.triangles.size()) return false;
    const auto &t = mesh.triangles[i], &next = mesh.triangles[i + 1];
    if (t[0] != next[0] || t[2] != next[1]) return false;
    const Vec3d normal = unit_normal(mesh, t);
    const auto agrees = [&](const std::array<std::uint32_t, 3>& other) {
        return unit_normal(mesh, other).dot(normal) > 1 - 1e-6;
    };
    return agrees(next) && agrees({t[0], t[1], next[2]}) && agrees({t[1], t[2], next[2]});
}

/// Calls `visit` with each place of a shape. Triangles without area have none: no ray meets them, and they emit
/// nothing. A quadrilateral also has the places of its halves along the other
/// diagonal, because another shape may be split that way.
template <typename Visit>
void for_each_place(const Shape& shape, const Visit& visit) {
    if (const auto* mesh = std::get_if<Mesh>(&shape)) {
        for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
            const auto& [a, b, c] = mesh->triangles[i];
            if (mesh->normal_of(i).isZero(0)) continue;
            std::apply(visit, place_of_triangle(*mesh, {a, b, c}));
            if (!is_plane_quad(*mesh, i)) continue;
            const std::uint32_t d = mesh->triangles[i + 1][2];
            std::apply(visit, place_of_triangle(*mesh, {a, b, d}));
            std::apply(visit, place_of_triangle(*mesh, {b, c, d}));
        }
    } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        visit(place_of(*sphere), sphere->flip_normals);
    } else if (const auto* disk = std::get_if<Disk>(&shape)) {
        visit(place_of(*disk), disk->normal.dot(disk->du.cross(disk->dv)) < 0.f);
    } else {
        const auto& cylinder = std::get<Cylinder>(shape);
        visit(place_of(cylinder), cylinder.flip_normals);
    }
}

/// Interior over exterior index, and its dispersion (Dielectric::cauchy_b).
using Index = std::pair<float, float>;

/// The indices of all models of the material that refract.
std::set<Index> indices(const Material& material) {
    const auto of = [](const auto& node) -> std::set<Index> {
        using Node = std::decay_t<decltype(node)>;
        if constexpr (std::is_same_v<Node, TexturedScattering>) {
            if (const auto* smooth = std::get_if<Dielectric>(&node.model)) return {{smooth->eta, smooth->cauchy_b}};
            if (const auto* rough = std::get_if<RoughDielectric>(&node.model)) return {{rough->eta, rough->cauchy_b}};
            const auto* principled = std::get_if<Principled>(&node.model);
            if (principled && principled->traits().refraction) return {{principled->eta, 0.f}};
            return {};
        } else if constexpr (std::is_same_v<Node, Blend>) {
            std::set<Index> all = indices(*node.first);
            all.merge(indices(*node.second));
            return all;
        } else if constexpr (std::is_same_v<Node, TwoSided>) {
            std::set<Index> all = indices(*node.front);
            all.merge(indices(*node.back));
            return all;
        } else if constexpr (std::is_same_v<Node, Nothing>) {
            return {};
        } else {
            return indices(*node.nested);
        }
    };
    return std::visit(of, material.node());
}

/// The text for a place in a message about `file`.
std::string place_text(const SourceLocation& where, const std::string& file) {
    return where.file == file ? fmt::format("line {}", where.line) : fmt::format("{}:{}", where.file, where.line);
}

void refuse_coincident_lamps(std::span<const SceneParts::Object> objects, std::span<const SourceLocation> where) {
    std::map<Place, std::pair<std::size_t, bool>> first;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (!objects[i].radiance) continue;
        for_each_place(objects[i].shape, [&](const Place& place, bool turned) {
            const auto [it, is_new] = first.emplace(place, std::pair(i, turned));
            if (is_new) return;
            throw InputError(where[i],
                             it->second.first == i
                                 ? std::string("this lamp has a triangle twice: a ray would meet only one of them")
                                 : fmt::format("this lamp lies exactly in the place of the one at {}: a ray would meet "
                                               "only one of them. Leave one out, or a gap between them",
                                               place_text(where[it->second.first], where[i].file)));
        });
    }
    if (first.empty()) return;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (objects[i].radiance) continue;
        for_each_place(objects[i].shape, [&](const Place& place, bool turned) {
            const auto it = first.find(place);
            if (it == first.end()) return;
            const auto& [lamp, lamp_turned] = it->second;
            // Where two bodies touch, neither surface can be seen.
            if (std::holds_alternative<Mesh>(objects[i].shape) && lamp_turned != turned) return;
            throw InputError(where[lamp],
                             fmt::format("this lamp lies exactly in the place of the surface at {}: which of them a "
                                         "ray meets would be left to rounding. Leave one out, or a gap between them",
                                         place_text(where[i], where[lamp].file)));
        });
    }
}

/// The changes for a path that crosses a surface: of the index and of the medium.
struct Interface {
    std::set<Index> indices;
    MediumSides media;

    bool is_none() const { return indices.empty() && !media.boundary; }
    bool operator==(const Interface& other) const {
        return indices == other.indices && media.boundary == other.media.boundary &&
               media.interior == other.media.interior && media.exterior == other.media.exterior;
    }
};

bool touch(const Bounds& a, const Bounds& b) {
    return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

void refuse_coincident_interfaces(std::span<const SceneParts::Object> objects, std::span<const Material> materials,
                                  std::span<const SourceLocation> where) {
    struct Candidate {
        std::size_t object;
        Interface interface;
        Bounds bounds;
    };
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        Interface interface { indices(materials[objects[i].material]), objects[i].media };
        if (!interface.is_none()) candidates.push_back({i, std::move(interface), bounds_of(objects[i].shape)});
    }
    std::map<Place, std::pair<const Candidate*, bool>> first;
    constexpr std::size_t most_compared = 1000;
    for (const Candidate& c : candidates) {
        const bool is_alone = candidates.size() <= most_compared &&
                              std::none_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
                                  return &other != &c && touch(c.bounds, other.bounds);
                              });
        if (is_alone) continue;
        for_each_place(objects[c.object].shape, [&](const Place& place, bool turned) {
            const auto [it, is_new] = first.emplace(place, std::pair(&c, turned));
            const auto& [other, other_turned] = it->second;
            if (is_new || other == &c || (other->interface == c.interface && other_turned == turned)) return;
            throw InputError(
                where[c.object],
                fmt::format("this surface lies exactly in the place of the one at {}, which {}: a ray would meet only "
                            "one of them. Let them overlap or leave a gap, or make them one surface with what lies on "
                            "both sides",
                            place_text(where[other->object], where[c.object].file),
                            other->interface == c.interface                   ? "faces the other way"
                            : other->interface.indices != c.interface.indices ? "refracts otherwise"
                                                                              : "bounds another medium"));
        });
    }
}

/// How far rounding may move the places of two objects along `normal` [scene units].
float rounding_along(const Vec3& normal, const Bounds& a, const Bounds& b) {
    const Vec3 extent =
        a.lower.cwiseAbs().cwiseMax(a.upper.cwiseAbs()) + b.lower.cwiseAbs().cwiseMax(b.upper.cwiseAbs());
    return 32.f * unit_roundoff * normal.cwiseAbs().dot(extent) + 8.f * unit_roundoff * a.diagonal();
}

Vec3 a_point_of(const Shape& shape) {
    const auto* mesh = std::get_if<Mesh>(&shape);
    return mesh ? mesh->vertex(mesh->triangles.front()[0]) : std::get<Disk>(shape).center;
}

/// The normal of a lamp that lies in one plane, towards its front.
std::optional<Vec3> normal_of_flat(const Shape& shape) {
    if (const auto* disk = std::get_if<Disk>(&shape)) return disk->normal;
    const auto* mesh = std::get_if<Mesh>(&shape);
    if (!mesh) return std::nullopt;
    std::optional<Vec3d> common;
    for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
        const Vec3d n = mesh->normal_of(i).stableNormalized();
        if (n.isZero(0)) continue;  // a triangle without area
        if (!common) common = n;
        if (!(n.dot(*common) > 1 - 1e-6)) return std::nullopt;
    }
    if (!common) return std::nullopt;
    const Vec3 normal = common->cast<float>(), p = a_point_of(shape);
    const Bounds bounds = bounds_of(shape);
    for (const auto& triangle : mesh->triangles)
        for (const std::uint32_t i : triangle)
            if (std::abs((mesh->vertex(i) - p).dot(normal)) > rounding_along(normal, bounds, bounds))
                return std::nullopt;
    return normal;
}

/// Whether a piece of the shape lies in the plane through p, within `distance`, and touches the box.
bool has_piece_in_plane(const Shape& shape, const Vec3& p, const Vec3& normal, float distance, const Bounds& box) {
    const auto in_plane = [&](const Vec3& q) { return std::abs((q - p).dot(normal)) <= distance; };
    if (const auto* disk = std::get_if<Disk>(&shape))
        return in_plane(disk->center) && in_plane(disk->center + disk->du) && in_plane(disk->center + disk->dv);
    const auto* mesh = std::get_if<Mesh>(&shape);
    if (!mesh) return false;
    return std::any_of(mesh->triangles.begin(), mesh->triangles.end(), [&](const auto& triangle) {
        Bounds bounds;
        for (const std::uint32_t i : triangle) {
            if (!in_plane(mesh->vertex(i))) return false;
            bounds.add(mesh->vertex(i));
        }
        return touch(bounds, box);
    });
}

void shift(Shape& shape, const Vec3& by) {
    if (auto* disk = std::get_if<Disk>(&shape)) {
        disk->center += by;
        return;
    }
    for (auto& vertex : std::get<Mesh>(shape).vertices)
        for (int axis = 0; axis < 3; ++axis)
            vertex[static_cast<std::size_t>(axis)] += by[axis];
}

}  // namespace

void lift_lamps_off_surfaces(std::span<SceneParts::Object> objects, std::span<const Material> materials) {
    std::vector<std::pair<const Shape*, Bounds>> surfaces;
    for (const auto& object : objects)
        if (!object.radiance && !materials[object.material].traits().transmission)
            surfaces.emplace_back(&object.shape, bounds_of(object.shape));
    for (auto& lamp : objects) {
        if (!lamp.radiance) continue;
        const auto normal = normal_of_flat(lamp.shape);
        if (!normal) continue;
        const Bounds bounds = bounds_of(lamp.shape);
        float height = 0;
        for (const auto& [shape, others] : surfaces) {
            const float rounding = rounding_along(*normal, bounds, others);
            Bounds around = bounds;
            around.add(bounds.lower - Vec3::Constant(rounding));
            around.add(bounds.upper + Vec3::Constant(rounding));
            if (touch(around, others) && has_piece_in_plane(*shape, a_point_of(lamp.shape), *normal, rounding, around))
                height = std::max(height, 2.f * rounding);
        }
        if (height > 0) shift(lamp.shape, height * *normal);
    }
}

void refuse_coincident_shapes(std::span<const SceneParts::Object> objects, std::span<const Material> materials,
                              std::span<const SourceLocation> where) {
    refuse_coincident_lamps(objects, where);
    refuse_coincident_interfaces(objects, materials, where);
}

}  // namespace gib
