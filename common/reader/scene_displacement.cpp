#include "common/reader/scene_displacement.h"

#include "common/mesh_files/displacement.h"

namespace gib {

namespace {

/// Whether the shape shows its facets. A displaced rectangle does not, though as a flat one it needs no normals.
bool shows_facets(Properties& properties, const MeshData& mesh) {
    const std::string& type = properties.element().find("type")->value;
    if (type == "rectangle") return false;
    if (type == "cube") return properties.boolean("face_normals", false);
    return mesh.normals.empty();
}

}  // namespace

void displace_shapes(Properties& properties, ParsedShapes& shapes, TextureFiles& textures) {
    const std::string name = "displacement";
    if (!properties.has(name)) {
        properties.declare(name);
        return;
    }
    const SourceLocation where = properties.element_where(name);
    const Texture texture = parse_textured_number(properties, name, 0.f, ColorRange::non_negative, textures);
    const double scale = properties.number("displacement_scale", 1),
                 midlevel = properties.number("displacement_midlevel", 0);
    const double given_edge = properties.positive("displacement_edge", 1);
    for (auto& part : shapes.parts) {
        auto* mesh = std::get_if<ParsedMesh>(&part.shape);
        if (!mesh) throw InputError(where, "only meshes can be displaced, and rectangles and cubes");
        MeshData& data = mesh->data;
        if (data.uvs.empty() && !texture.constant())
            throw InputError(where, "the displacement is a texture, but the mesh has no texture coordinates");
        const BoundsD bounds = bounds_of(part.shape);
        check_range(bounds, where);
        const bool facets = shows_facets(properties, data);
        compute_normals(data);
        const double edge = properties.has("displacement_edge") ? given_edge : 0.01 * bounds.diagonal().stableNorm();
        if (!subdivide(data, edge))
            reject(where,
                   "displaced, the mesh would have more than {} triangles: its edges are halved down to {:g}; "
                   "give a longer 'displacement_edge'",
                   most_displaced_triangles, edge);
        displace(
            data, [&](const Vec2& uv) { return scale * (double{texture.value(uv)} - midlevel); },
            mesh->flip_normals ? -1 : 1);
        if (facets) data.normals.clear();
    }
}

}  // namespace gib
