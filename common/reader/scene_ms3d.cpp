#include "common/reader/scene_ms3d.h"

#include <algorithm>

namespace gib {

namespace {

std::optional<Texture> color_texture(const Ms3dMaterial& material, TextureFiles& files, const SourceLocation& where) {
    if (material.texture.empty()) return std::nullopt;
    std::string name = material.texture;  // written by a program for Windows
    std::replace(name.begin(), name.end(), '\\', '/');
    BitmapTexture bitmap;
    bitmap.bitmap = files.bitmap(name, where, false);
    return Texture(std::move(bitmap));
}

Material opaque_material(const Ms3dMaterial& material, const std::optional<Texture>& texture) {
    const Color diffuse = texture ? texture->maximum() : material.diffuse;
    const float excess = std::max((diffuse + material.specular).maxCoeff(), 1.f);
    if (is_black(material.specular)) {
        TexturedScattering node{Diffuse{diffuse}, {}};
        if (texture)
            node.parameters.push_back(
                {*texture, [](Scattering& s, const Color& c) { std::get<Diffuse>(s).reflectance = c; }});
        return Material(std::move(node));
    }
    Phong phong;
    phong.diffuse_reflectance = diffuse / excess;
    phong.specular_reflectance = material.specular / excess;
    phong.exponent = material.shininess;
    TexturedScattering node{phong, {}};
    // A texel may reflect no more than the highlight leaves over, so that a bright one does not add energy.
    if (texture)
        node.parameters.push_back({*texture, [](Scattering& s, const Color& c) {
                                       auto& p = std::get<Phong>(s);
                                       p.diffuse_reflectance = c.min(1.f - p.specular_reflectance);
                                   }});
    return Material(std::move(node));
}

}  // namespace

Material material_of(const Ms3dMaterial& material, TextureFiles& files, const SourceLocation& where) {
    Material opaque = opaque_material(material, color_texture(material, files, where));
    if (material.transparency >= 1.f) return opaque;
    return Material(
        Mask{Texture(Color::Constant(material.transparency)), std::make_shared<const Material>(std::move(opaque))});
}

}  // namespace gib
