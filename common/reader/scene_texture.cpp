#include "common/reader/scene_texture.h"

#include "common/core/reject.h"
#include "common/xml/scene_spectrum.h"

#include <fmt/ranges.h>
#include <algorithm>

namespace gib {

OpenElement::OpenElement(const NestedObject& object, TextureFiles& files) : element_(object.element), files_(files) {
    constexpr std::size_t deepest_part = 64, most_parts = 1000;
    if (files.open_.contains(element_)) reject(object.where, "the {} holds itself", element_->tag);
    files.parts_ = files.open_.empty() ? 1 : files.parts_ + 1;
    if (files.open_.size() == deepest_part || files.parts_ > most_parts)
        throw InputError(object.where, "a material or texture of too many parts");
    files.open_.insert(element_);
}

OpenElement::~OpenElement() { files_.open_.erase(element_); }

MeshInView::MeshInView(TextureFiles& files, const MeshData* mesh) : files_(files) {
    files_.mesh_ = mesh;
    files_.attribute_taken_ = false;
}

MeshInView::MeshInView(TextureFiles& files) : MeshInView(files, nullptr) { files_.only_checked_ = true; }

MeshInView::~MeshInView() {
    files_.mesh_ = nullptr;
    files_.only_checked_ = false;
}

namespace {

UvTransform parse_to_uv(Properties& properties) {
    const Mat4d m = properties.transform("to_uv");
    // Mitsuba leaves out the third row and column. Entries there, which it would ignore in silence, are refused.
    if (m(0, 2) != 0 || m(1, 2) != 0 || m(2, 0) != 0 || m(2, 1) != 0)
        properties.reject("to_uv",
                          "'to_uv' must map u and v alone (a <matrix> of 9 numbers cannot "
                          "move them: give a <translate>)");
    return {m.topLeftCorner<2, 2>().cast<float>(), m.topRightCorner<2, 1>().cast<float>()};
}

Texture parse_bitmap(Properties& properties, TextureFiles& files) {
    const std::string name = properties.required_string("filename");
    BitmapTexture texture;
    texture.filter = properties.chosen("filter_type", TextureFilter::bilinear,
                                       {{"nearest", TextureFilter::nearest}, {"bilinear", TextureFilter::bilinear}});
    // The last four are those of Mitsuba 0.6 and its forerunners.
    texture.wrap = properties.chosen("wrap_mode", Wrap::repeat,
                                     {{"repeat", Wrap::repeat},
                                      {"mirror", Wrap::mirror},
                                      {"clamp", Wrap::clamp},
                                      {"zero", Wrap::zero},
                                      {"one", Wrap::one},
                                      {"black", Wrap::zero},
                                      {"white", Wrap::one}});
    texture.to_uv = parse_to_uv(properties);
    const bool raw = properties.boolean("raw", false);
    // These options concern Mitsuba's memory and graphics processors. Texels are always 32-bit floats here.
    properties.choice("format", "auto", {"auto", "variant", "fp16", "float16"});
    properties.boolean("accel", true);
    // Mitsuba 0.6 makes a grey texture of one channel.
    const std::string channel = properties.string("channel").value_or("");
    texture.bitmap = files.bitmap(name, properties.element_where("filename"), raw, channel);
    return Texture(std::move(texture));
}

Texture parse_checkerboard(Properties& properties, ColorRange range, TextureFiles& files) {
    CheckerboardTexture texture;
    texture.color0 = parse_textured(properties, "color0", 0.4f, range, files);
    texture.color1 = parse_textured(properties, "color1", 0.2f, range, files);
    texture.to_uv = parse_to_uv(properties);
    return Texture(std::move(texture));
}

/// A value that is neither converted nor checked, as in Mitsuba 3.
Texture parse_raw_constant(Properties& properties) {
    properties.require("value");
    const auto& children = properties.element().children;
    const bool is_number = std::any_of(children.begin(), children.end(), [](const XmlElement& child) {
        return child.tag == "float" || child.tag == "integer";
    });
    if (is_number) return Texture(Color::Constant(static_cast<float>(properties.number("value", 0))));
    const Vec3d value = *properties.point("value");
    if (!fits_float(value.cwiseAbs().maxCoeff())) properties.reject("value", "'value' is too large");
    return Texture(Color(value.cast<float>().array()));
}

Texture parse_mesh_attribute(Properties& properties, TextureFiles& files) {
    const std::string name = properties.required_string("name");
    const auto scale = static_cast<float>(properties.number("scale", 1));
    if (!name.starts_with("vertex_") && !name.starts_with("face_"))
        properties.reject("name", "the name of an attribute begins with 'vertex_' or 'face_', not '{}'", name);
    return files.attribute(name, scale, properties.where("name"));
}

/// Mitsuba 0.6's `scale`: a texture, or the colour `value`, times a number or a colour.
Texture parse_scaled(Properties& properties, ColorRange range, TextureFiles& files) {
    const Color scale = color_property(properties, "scale", 1, ColorRange::non_negative);
    properties.declare("value");
    // The product must be in range, not its factor.
    const ColorRange inner = range == ColorRange::unit ? ColorRange::non_negative : range;
    const auto nested = properties.object("texture");
    if (!nested) properties.require("value");
    const Texture texture =
        nested ? parse_texture(*nested, inner, files) : Texture(color_property(properties, "value", 1, inner));
    if (!(texture.maximum() * scale).isFinite().all())
        properties.reject("scale", "'scale' is too large for its texture");
    return Texture(ScaledTexture{texture, scale});
}

Texture parse_within(const NestedObject& object, const std::string& name, ColorRange range, TextureFiles& files) {
    Texture texture = parse_texture(object, range, files);
    const float lowest = texture.minimum().minCoeff(), highest = texture.maximum().maxCoeff();
    if (range == ColorRange::unit && !(lowest >= 0 && highest <= 1))
        reject(object.where, "'{}' must be between 0 and 1, but its texture has {}", name,
               lowest >= 0 ? highest : lowest);
    if (!(lowest >= 0)) reject(object.where, "'{}' must not be negative, but its texture has {}", name, lowest);
    return texture;
}

}  // namespace

std::string TextureFiles::path(const std::string& name, const SourceLocation& where) {
    std::string path = finder_.find(name, where);
    if (hashed_.insert(path).second) hash_.add(read_file(path));
    return path;
}

Texture TextureFiles::attribute(const std::string& name, float scale, const SourceLocation& where) {
    attribute_taken_ = true;
    if (only_checked_) return Texture(Color::Zero());
    if (!mesh_)
        reject(where, "there is no attribute '{}' here: only bsdfs and emitters of a mesh take attributes", name);
    // Mitsuba's documentation names a colour vertex_PREFIX, its reader of files vertex_PREFIX_color.
    const auto is_named = [&](const MeshAttribute& a) { return a.name == name || a.name + "_color" == name; };
    const auto it = std::find_if(mesh_->attributes.begin(), mesh_->attributes.end(), is_named);
    if (it == mesh_->attributes.end()) {
        std::vector<std::string_view> names;
        for (const MeshAttribute& attribute : mesh_->attributes)
            names.push_back(attribute.name);
        reject(where, "the mesh has no attribute '{}'; it has: {}", name,
               names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")));
    }
    MeshAttributeTexture texture;
    texture.per_face = it->per_face;
    texture.grey = it->grey;
    if (it->per_face) {
        texture.colors = it->values;
    } else {
        texture.colors.reserve(3 * mesh_->triangles.size());
        for (const auto& triangle : mesh_->triangles)
            for (const std::uint32_t vertex : triangle)
                texture.colors.push_back(it->values[vertex]);
    }
    for (Color& color : texture.colors) {
        color *= scale;
        if (!color.isFinite().all()) reject(where, "the 'scale' of the attribute '{}' is too large: {:g}", name, scale);
    }
    return Texture(std::move(texture));
}

std::shared_ptr<const Bitmap> TextureFiles::bitmap(const std::string& name, const SourceLocation& where, bool raw,
                                                   const std::string& channel) {
    const std::string file = path(name, where);
    auto& bitmap = bitmaps_[{file, raw, channel}];
    if (!cache_) cache_ = std::make_shared<TextureCache>();
    if (!bitmap) bitmap = std::make_shared<const Bitmap>(cache_, file, raw, channel);
    return bitmap;
}

Texture parse_texture(const NestedObject& object, ColorRange range, TextureFiles& files) {
    const OpenElement open(object, files);
    Properties properties(*object.element, files.ids());
    const std::string& type = properties.plugin({"bitmap", "checkerboard", "mesh_attribute", "rawconstant", "scale"});
    const Texture texture = type == "bitmap"           ? parse_bitmap(properties, files)
                            : type == "checkerboard"   ? parse_checkerboard(properties, range, files)
                            : type == "mesh_attribute" ? parse_mesh_attribute(properties, files)
                            : type == "scale"          ? parse_scaled(properties, range, files)
                                                       : parse_raw_constant(properties);
    properties.finish();
    return texture;
}

Texture parse_textured(Properties& properties, const std::string& name, float fallback, ColorRange range,
                       TextureFiles& files) {
    if (const auto object = properties.named_object(name, "texture")) return parse_within(*object, name, range, files);
    return Texture(color_property(properties, name, fallback, range));
}

Texture parse_textured_number(Properties& properties, const std::string& name, float fallback, ColorRange range,
                              TextureFiles& files) {
    if (const auto object = properties.named_object(name, "texture")) return parse_within(*object, name, range, files);
    const Texture color(color_property(properties, name, fallback, range));
    return Texture(Color::Constant(color.value(Vec2(0, 0))));
}

}  // namespace gib
