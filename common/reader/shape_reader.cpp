#include "common/reader/shape_reader.h"

#include "common/mesh_files/mesh_materials.h"
#include "common/reader/scene_bsdf.h"
#include "common/reader/scene_displacement.h"
#include "common/reader/scene_emitter.h"
#include "common/reader/scene_medium.h"
#include "common/reader/scene_ms3d.h"

#include <fmt/format.h>
#include <algorithm>

namespace gib {

namespace {

/// The bsdf of a material of an OBJ file: that of its name, else the last one without a name. Null if there is neither.
const NestedObject* bsdf_of(const std::string& material, const std::vector<NestedObject>& bsdfs) {
    const NestedObject *alike = nullptr, *unnamed = nullptr;
    for (const NestedObject& bsdf : bsdfs) {
        if (bsdf.name.empty()) unnamed = &bsdf;
        else if (bsdf.name == material) return &bsdf;
        else if (is_same_material(bsdf.name, material)) alike = &bsdf;
    }
    return alike ? alike : unnamed;
}

/// The mesh of an element with one shape, for its attributes; null if the shape is none.
const MeshData* mesh_of(const ParsedShapes& shapes) {
    const auto* mesh = shapes.parts.size() == 1 ? std::get_if<ParsedMesh>(&shapes.parts.front().shape) : nullptr;
    return mesh ? &mesh->data : nullptr;
}

}  // namespace

std::uint32_t SceneMedia::index_of(const NestedObject& medium) {
    const auto [it, is_new] = index_of_element_.emplace(medium.element, static_cast<std::uint32_t>(media_.size()));
    if (is_new) media_.push_back(medium);
    return it->second;
}

std::vector<Medium> SceneMedia::read(TextureFiles& textures, const Vec3d& origin) const {
    std::vector<Medium> read;
    for (const NestedObject& medium : media_)
        read.push_back(parse_medium(medium, textures, origin));
    return read;
}

std::vector<std::string> SceneMedia::names() const {
    std::vector<std::string> names;
    for (const NestedObject& medium : media_) {
        const XmlAttribute* id = medium.element->find("id");
        names.push_back(id ? fmt::format("medium '{}'", id->value)
                           : format_location(medium.element->where, "the medium"));
    }
    return names;
}

std::uint32_t SceneMaterials::add(Material&& material) {
    materials_.push_back(std::move(material));
    return static_cast<std::uint32_t>(materials_.size() - 1);
}

std::uint32_t SceneMaterials::index_of(const NestedObject& bsdf, const MeshData* mesh) {
    if (const auto it = index_of_element_.find(bsdf.element); it != index_of_element_.end()) return it->second;
    const MeshInView view(textures_, mesh);
    const std::uint32_t index = add(parse_bsdf(bsdf, textures_));
    if (!view.attribute_taken()) index_of_element_[bsdf.element] = index;
    return index;
}

std::uint32_t SceneMaterials::default_of(const NestedObject& shape, bool emitter, bool boundary) {
    const bool is_open = boundary && !emitter && shape.element->old;
    if (boundary && !emitter && !is_open)
        textures_.ids().warn(
            shape.where,
            "the boundary of a medium without a bsdf is grey and opaque, as in Mitsuba, so that light hardly "
            "reaches the medium; <bsdf type=\"null\"/> would let it through");
    auto& index = defaults_[is_open ? 2 : emitter ? 1 : 0];
    const Scattering surface = Diffuse{Color::Constant(emitter ? 0.f : 0.5f)};
    if (!index) index = add(is_open ? Material(Nothing{}) : Material(surface));
    return *index;
}

/// Warns of bsdfs whose name is no material of the OBJ file, and of materials without a bsdf.
void ShapeReader::warn_of_materials(const NestedObject& object, const ParsedShapes& shapes,
                                    const std::vector<NestedObject>& bsdfs) const {
    for (const NestedObject& bsdf : bsdfs)
        if (!bsdf.name.empty() && std::none_of(shapes.parts.begin(), shapes.parts.end(), [&](const auto& part) {
                return is_same_material(bsdf.name, *part.material_name);
            }))
            textures_.ids().warn(bsdf.where, fmt::format("no face of the OBJ file has the material '{}'", bsdf.name));
    for (const auto& part : shapes.parts)
        if (!bsdf_of(*part.material_name, bsdfs))
            textures_.ids().warn(object.where,
                                 fmt::format("the material '{}' of the OBJ file has no bsdf here: it is the default",
                                             *part.material_name));
}

BoundsD ShapeReader::add_shapes(const NestedObject& object, std::vector<PendingShape>& to) {
    const XmlIds& ids = textures_.ids();
    Properties properties(*object.element, ids);
    const auto bsdfs = properties.objects("bsdf");
    const auto emitter = properties.object("emitter");
    MediumSides media;
    for (const auto& [name, side] : {std::pair("interior", &media.interior), std::pair("exterior", &media.exterior)})
        if (const auto medium = properties.named_object(name, "medium")) {
            *side = media_.index_of(*medium);
            media.boundary = true;
        }
    properties.number("silhouette_sampling_weight");  // for Mitsuba's derivatives; no effect here
    ParsedShapes shapes = parse_shapes(properties, bsdfs, files_, hash_);
    const bool by_material = !shapes.parts.empty() && shapes.parts.front().material_name;
    if (by_material) warn_of_materials(object, shapes, bsdfs);
    else if (bsdfs.size() > 1) throw InputError(bsdfs[1].where, "<shape> can hold only one <bsdf>");
    displace_shapes(properties, shapes, textures_);
    properties.finish();
    for (const auto& warning : shapes.warnings)
        ids.warn({}, warning);  // it names its own place
    std::optional<Texture> radiance;
    if (emitter) {
        const MeshInView view(textures_, mesh_of(shapes));
        radiance = parse_area_emitter(*emitter, textures_);
        area_emitters_.insert(emitter->element);
    }
    const auto without_bsdf = [&] { return materials_.default_of(object, emitter.has_value(), media.boundary); };
    const bool has_bsdf = !by_material && !bsdfs.empty();
    const std::uint32_t material = has_bsdf ? materials_.index_of(bsdfs[0], mesh_of(shapes)) : 0;
    std::map<std::uint32_t, std::uint32_t> index_of_material;
    BoundsD bounds;
    for (auto& part : shapes.parts) {
        bounds.extend(bounds_of(part.shape));
        PendingShape pending{.where = object.where,
                             .shape = std::move(part.shape),
                             .emitter_where = emitter ? emitter->where : object.where,
                             .material = 0,
                             .radiance = radiance,
                             .media = media};
        if (!emitter && part.material && !is_black(shapes.materials[*part.material].emissive))
            pending.radiance = Texture(shapes.materials[*part.material].emissive);
        if (has_bsdf) {
            pending.material = material;
        } else if (by_material) {
            const NestedObject* bsdf = bsdf_of(*part.material_name, bsdfs);
            pending.material = bsdf ? materials_.index_of(*bsdf, nullptr) : without_bsdf();
        } else if (part.material) {
            const auto [it, is_new] = index_of_material.emplace(*part.material, materials_.all().size());
            if (is_new) materials_.add(material_of(shapes.materials[*part.material], textures_, object.where));
            pending.material = it->second;
        } else {
            pending.material = without_bsdf();
        }
        to.push_back(std::move(pending));
    }
    return bounds;
}

}  // namespace gib
