#pragma once
// Reads the shapes of a scene that have a surface, and the materials and media that they refer to.

#include "common/materials/material.h"
#include "common/media/medium.h"
#include "common/reader/scene_shape.h"
#include "common/reader/scene_texture.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace gib {

/// The media of a scene. A medium that several shapes refer to is one. Media are read once the scene's origin is known.
class SceneMedia {
public:
    std::uint32_t index_of(const NestedObject& medium);
    std::vector<Medium> read(TextureFiles& textures, const Vec3d& origin) const;
    /// Their names in messages.
    std::vector<std::string> names() const;

private:
    std::vector<NestedObject> media_;
    std::map<const XmlElement*, std::uint32_t> index_of_element_;
};

/// The materials of a scene.
class SceneMaterials {
public:
    /// `textures` must outlive this object.
    explicit SceneMaterials(TextureFiles& textures) : textures_(textures) {}

    const std::vector<Material>& all() const { return materials_; }
    std::vector<Material> take() { return std::move(materials_); }

    std::uint32_t add(Material&& material);
    /// A bsdf that several shapes refer to is one material, unless it takes attributes of their meshes.
    std::uint32_t index_of(const NestedObject& bsdf, const MeshData* mesh);
    /// Mitsuba's default material of a shape: a grey diffuse surface, or a black one for a light. The boundary of a
    /// medium lets light through in old files only (Mitsuba 0.6, Shape::configure).
    std::uint32_t default_of(const NestedObject& shape, bool emitter, bool boundary);

private:
    TextureFiles& textures_;
    std::vector<Material> materials_;
    std::map<const XmlElement*, std::uint32_t> index_of_element_;
    std::optional<std::uint32_t> defaults_[3];  ///< grey, black and none
};

/// A shape that has been read, in the file's coordinates.
struct PendingShape {
    SourceLocation where;
    ParsedShape shape;
    SourceLocation emitter_where;
    std::uint32_t material;
    std::optional<Texture> radiance;
    MediumSides media{};
};

class ShapeReader {
public:
    /// All arguments must outlive this object.
    ShapeReader(const FileFinder& files, ContentHash& hash, TextureFiles& textures, SceneMedia& media,
                SceneMaterials& materials)
        : files_(files), hash_(hash), textures_(textures), media_(media), materials_(materials) {}

    /// Appends the shapes of an element that has a surface to `to`. Returns their bounds.
    BoundsD add_shapes(const NestedObject& object, std::vector<PendingShape>& to);
    /// Whether the emitter stands in a shape, or one refers to it.
    bool has_read(const XmlElement* emitter) const { return area_emitters_.contains(emitter); }

private:
    void warn_of_materials(const NestedObject& object, const ParsedShapes& shapes,
                           const std::vector<NestedObject>& bsdfs) const;

    const FileFinder& files_;
    ContentHash& hash_;
    TextureFiles& textures_;
    SceneMedia& media_;
    SceneMaterials& materials_;
    std::set<const XmlElement*> area_emitters_;
};

}  // namespace gib
