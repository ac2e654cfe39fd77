#include "common/mesh_files/mesh_materials.h"

#include <algorithm>
#include <cctype>

namespace gib {

namespace {

constexpr std::uint32_t not_placed = ~0u;

/// The triangles of `mesh` whose numbers are given, with the vertices that they use. All of `place`, one for each vertex of
/// the mesh, are `not_placed` before and after.
MeshData part_of(const MeshData& mesh, const std::vector<std::size_t>& triangles, std::vector<std::uint32_t>& place) {
    MeshData part;
    std::vector<std::uint32_t> vertices;
    for (const std::size_t i : triangles) {
        auto triangle = mesh.triangles[i];
        for (std::uint32_t& vertex : triangle) {
            if (place[vertex] == not_placed) {
                place[vertex] = static_cast<std::uint32_t>(vertices.size());
                vertices.push_back(vertex);
            }
            vertex = place[vertex];
        }
        part.triangles.push_back(triangle);
    }
    for (const std::uint32_t vertex : vertices) {
        part.positions.push_back(mesh.positions[vertex]);
        if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[vertex]);
        if (!mesh.uvs.empty()) part.uvs.push_back(mesh.uvs[vertex]);
        place[vertex] = not_placed;
    }
    return part;
}

std::string plain(std::string_view name) {
    std::string result;
    for (const char c : name)
        if (c != '_') result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

}  // namespace

std::vector<MaterialPart> parted_by_material(const MeshData& mesh) {
    std::vector<std::pair<std::string, std::vector<std::size_t>>> parts;
    const auto add_run = [&](const std::string& material, std::size_t first, std::size_t end) {
        if (first == end) return;
        auto part = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == material; });
        if (part == parts.end()) part = parts.insert(part, {material, {}});
        for (std::size_t i = first; i < end; ++i)
            part->second.push_back(i);
    };
    const std::size_t count = mesh.triangles.size(), runs = mesh.materials.size();
    add_run("", 0, runs > 0 ? mesh.materials[0].first : count);
    for (std::size_t i = 0; i < runs; ++i)
        add_run(mesh.materials[i].name, mesh.materials[i].first, i + 1 < runs ? mesh.materials[i + 1].first : count);
    std::vector<MaterialPart> result;
    std::vector<std::uint32_t> place(mesh.positions.size(), not_placed);
    for (const auto& [material, triangles] : parts)
        result.push_back({material, part_of(mesh, triangles, place)});
    return result;
}

bool is_same_material(std::string_view a, std::string_view b) { return plain(a) == plain(b); }

}  // namespace gib
