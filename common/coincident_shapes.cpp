#include "common/coincident_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace gib {

namespace {

/// What two pieces of surface have in common if they are in the same place: three vertices in any order, or the numbers
/// of a sphere, a disk or a cylinder.
using Place = std::array<float, 11>;

Place place_of_triangle(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
    std::array<std::array<float, 3>, 3> corners = {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]],
                                                   mesh.vertices[triangle[2]]};
    std::sort(corners.begin(), corners.end());
    return {0,
            corners[0][0],
            corners[0][1],
            corners[0][2],
            corners[1][0],
            corners[1][1],
            corners[1][2],
            corners[2][0],
            corners[2][1],
            corners[2][2],
            0};
}

Place place_of(const Sphere& s) { return {1, s.center.x(), s.center.y(), s.center.z(), s.radius, 0, 0, 0, 0, 0, 0}; }

Place place_of(const Disk& d) {
    return {2, d.center.x(), d.center.y(), d.center.z(), d.du.x(), d.du.y(), d.du.z(), d.dv.x(), d.dv.y(), d.dv.z(), 0};
}

Place place_of(const Cylinder& c) {
    return {3, c.base.x(), c.base.y(), c.base.z(), c.axis.x(), c.axis.y(), c.axis.z(), c.radius, 0, 0, 0};
}

template <typename Visit>
void for_each_place(const Shape& shape, const Visit& visit) {
    if (const auto* mesh = std::get_if<Mesh>(&shape)) {
        for (const auto& triangle : mesh->triangles)
            visit(place_of_triangle(*mesh, triangle));
    } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        visit(place_of(*sphere));
    } else if (const auto* disk = std::get_if<Disk>(&shape)) {
        visit(place_of(*disk));
    } else {
        visit(place_of(std::get<Cylinder>(shape)));
    }
}

/// Interior over exterior index, and how it depends on the wavelength.
using Index = std::pair<float, float>;

/// Of all models of the material that refract.
std::set<Index> indices(const Material& material) {
    const auto of = [](const auto& node) -> std::set<Index> {
        using Node = std::decay_t<decltype(node)>;
        if constexpr (std::is_same_v<Node, TexturedScattering>) {
            if (const auto* smooth = std::get_if<Dielectric>(&node.model)) return {{smooth->eta, smooth->cauchy_b}};
            if (const auto* rough = std::get_if<RoughDielectric>(&node.model)) return {{rough->eta, rough->cauchy_b}};
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

/// As seen from a line of `file`.
std::string place_text(const SourceLocation& where, const std::string& file) {
    return where.file == file ? fmt::format("line {}", where.line) : fmt::format("{}:{}", where.file, where.line);
}

void refuse_coincident_lamps(std::span<const SceneParts::Object> objects, std::span<const SourceLocation> where) {
    std::map<Place, std::size_t> first;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (!objects[i].radiance) continue;
        for_each_place(objects[i].shape, [&](const Place& place) {
            const auto [it, is_new] = first.emplace(place, i);
            if (is_new) return;
            throw InputError(where[i],
                             it->second == i
                                 ? std::string("this lamp has a triangle twice: a ray would meet only one of them")
                                 : fmt::format("this lamp lies exactly in the place of the one at {}: a ray would meet "
                                               "only one of them. Leave one out, or a gap between them",
                                               place_text(where[it->second], where[i].file)));
        });
    }
    if (first.empty()) return;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (objects[i].radiance) continue;
        for_each_place(objects[i].shape, [&](const Place& place) {
            const auto lamp = first.find(place);
            if (lamp == first.end() || lamp->second < i) return;
            throw InputError(where[lamp->second],
                             fmt::format("this lamp lies exactly in the place of the surface at {}: rays would meet "
                                         "that. Put the lamp first, leave the other out, or a gap between them",
                                         place_text(where[i], where[lamp->second].file)));
        });
    }
}

void refuse_coincident_interfaces(std::span<const SceneParts::Object> objects, std::span<const Material> materials,
                                  std::span<const SourceLocation> where) {
    std::vector<std::set<Index>> of_object;
    std::set<std::set<Index>> different;
    for (const auto& object : objects) {
        of_object.push_back(indices(materials[object.material]));
        if (!of_object.back().empty()) different.insert(of_object.back());
    }
    if (different.size() < 2) return;
    std::map<Place, std::size_t> first;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        if (of_object[i].empty()) continue;
        for_each_place(objects[i].shape, [&](const Place& place) {
            const auto [it, is_new] = first.emplace(place, i);
            if (!is_new && of_object[it->second] != of_object[i])
                throw InputError(
                    where[i], fmt::format("this surface lies exactly in the place of the one at {}, which refracts "
                                          "otherwise: a ray would meet only one of them. Let them overlap or leave a "
                                          "gap, or make them one surface with both int_ior and ext_ior",
                                          place_text(where[it->second], where[i].file)));
        });
    }
}

}  // namespace

void refuse_coincident_shapes(std::span<const SceneParts::Object> objects, std::span<const Material> materials,
                              std::span<const SourceLocation> where) {
    refuse_coincident_lamps(objects, where);
    refuse_coincident_interfaces(objects, materials, where);
}

}  // namespace gib
