#pragma once
// Reads the <texture> elements of a scene file, and parameters that take a value or a texture.

#include "common/images/texture.h"
#include "common/mesh_files/mesh_data.h"
#include "common/xml/xml_properties.h"

#include <map>
#include <set>
#include <tuple>

namespace gib {

/// The names of the values of Wrap that volumes take; bitmaps take more.
inline const std::initializer_list<std::pair<std::string_view, Wrap>> wrap_names = {
    {"repeat", Wrap::repeat}, {"mirror", Wrap::mirror}, {"clamp", Wrap::clamp}};

/// The images that a scene's textures share. Every file that is read is added to the scene's hash.
class TextureFiles {
public:
    /// All three arguments must outlive this object.
    TextureFiles(const FileFinder& finder, ContentHash& hash, const XmlIds& ids)
        : finder_(finder), hash_(hash), ids_(ids) {}

    const XmlIds& ids() const { return ids_; }
    /// The image of a file, or one channel of it, which is loaded once. Throws InputError at `where` if there is no such
    /// file, and at the file itself if its content is wrong.
    std::shared_ptr<const Bitmap> bitmap(const std::string& name, const SourceLocation& where, bool raw,
                                         const std::string& channel = {});
    /// The texture of an attribute of the mesh in view, times `scale`. Throws InputError at `where` if the mesh lacks
    /// it.
    Texture attribute(const std::string& name, float scale, const SourceLocation& where);
    /// The path of a file, whose content is added to the hash. Throws InputError at `where` if there is none.
    std::string path(const std::string& name, const SourceLocation& where);

private:
    friend class OpenElement;
    friend class MeshInView;
    const FileFinder& finder_;
    ContentHash& hash_;
    const XmlIds& ids_;
    std::shared_ptr<TextureCache> cache_;  ///< made with the first bitmap
    std::map<std::tuple<std::string, bool, std::string>, std::shared_ptr<const Bitmap>> bitmaps_;
    std::set<std::string> hashed_;
    std::set<const XmlElement*> open_;  ///< elements being parsed now, to find any that holds itself
    std::size_t parts_ = 0;           ///< number of parts in the outermost open element so far, one for each reference
    const MeshData* mesh_ = nullptr;  ///< mesh whose attributes textures take; null: none
    bool only_checked_ = false;       ///< true: the present element is parsed again for each shape that uses it
    bool attribute_taken_ = false;    ///< an attribute was asked for since mesh_ or only_checked_ was set
};

/// While an object of this class lives, the textures that are parsed take their attributes from a mesh.
class MeshInView {
public:
    /// `mesh` may be null, for a shape that is no mesh; an attribute is then an error.
    MeshInView(TextureFiles& files, const MeshData* mesh);
    /// For an element of the scene that shapes may refer to: attributes are checked without a mesh and are black.
    explicit MeshInView(TextureFiles& files);
    ~MeshInView();
    MeshInView(const MeshInView&) = delete;
    MeshInView& operator=(const MeshInView&) = delete;

    /// Whether a texture has asked for an attribute, so that what was parsed serves this mesh only.
    bool attribute_taken() const { return files_.attribute_taken_; }

private:
    TextureFiles& files_;
};

/// Marks a texture or material as being parsed. Throws InputError if it is marked already, because references can
/// make an element hold itself. With references a short file can also describe a chain that is too deep for
/// recursion, or a tree of 2^n parts; both are refused.
class OpenElement {
public:
    OpenElement(const NestedObject& object, TextureFiles& files);
    ~OpenElement();
    OpenElement(const OpenElement&) = delete;
    OpenElement& operator=(const OpenElement&) = delete;

private:
    const XmlElement* element_;
    TextureFiles& files_;
};

/// Reads a bitmap, a checkerboard, a rawconstant, a mesh_attribute or one of them in a scale. The constants in a
/// checkerboard must lie within `range`; other values are not checked. Throws InputError.
Texture parse_texture(const NestedObject& object, ColorRange range, TextureFiles& files);

/// The colour parameter `name`: a value as color_property() takes it, or a texture within `range`.
Texture parse_textured(Properties& properties, const std::string& name, float fallback, ColorRange range,
                       TextureFiles& files);

/// The number `name`, within `range`: a <float>, or the value() of a texture or colour.
Texture parse_textured_number(Properties& properties, const std::string& name, float fallback, ColorRange range,
                              TextureFiles& files);

}  // namespace gib
