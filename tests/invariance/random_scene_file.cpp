// Writes random scenes as scene files and meshes.
#include "tests/invariance/random_scenes.h"
#include "tests/support/scene_builder.h"

namespace gib::test {

namespace {

std::string color(const std::string& name, const Colord& c) {
    return rgb(name, fmt::format("{} {} {}", c[0], c[1], c[2]));
}

std::string placed(const Mat4d& m) {
    std::string values;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            values += fmt::to_string(m(row, column)) + " ";
    return to_world("<matrix value='" + values + "'/>");
}

/// The colour `name`: an even one, or a checkerboard of the colour and half of it.
std::string textured(const std::string& name, const SceneMaterial& m) {
    if (m.tiles == 0) return color(name, m.color);
    return fmt::format("<texture type='checkerboard' name='{}'>", name) + color("color0", m.color) +
           color("color1", 0.5 * m.color) + "<transform name='to_uv'>" + scale(m.tiles) + "</transform></texture>";
}

std::string one_sided_xml(const SceneMaterial& m) {
    using enum SceneMaterial::Kind;
    const std::string indices = number("int_ior", m.ior) + number("ext_ior", 1);
    const std::string roughness = text("distribution", m.ggx ? "ggx" : "beckmann") + number("alpha", m.alpha);
    const std::string metal = color("eta", 2 * m.color) + color("k", 4 * m.color);
    const std::string plain = bsdf("diffuse", textured("reflectance", m));
    switch (m.kind) {
        case diffuse:
            return plain;
        case mirror:
            return bsdf("conductor", text("material", "none"), color("specular_reflectance", m.color));
        case conductor:
            return bsdf("conductor", metal);
        case rough_conductor:
            return bsdf("roughconductor", metal, roughness);
        case glass:
            return bsdf("dielectric", indices);
        case dispersive_glass:
            return bsdf("dielectric", indices, number("cauchy_b", 0.01));
        case thin_glass:
            return bsdf("thindielectric", indices);
        case rough_glass:
            return bsdf("roughdielectric", indices, roughness);
        case plastic:
            return bsdf("plastic", indices, textured("diffuse_reflectance", m));
        case rough_plastic:
            return bsdf("roughplastic", indices, roughness, textured("diffuse_reflectance", m));
        case phong:
            return bsdf("phong", textured("diffuse_reflectance", m), rgb("specular_reflectance", 0.2),
                        number("exponent", 2 / (m.alpha * m.alpha)));
        case mask:
            return bsdf("mask", number("opacity", m.share), plain);
        case blend:
            return bsdf("blendbsdf", number("weight", m.share), plain, bsdf("roughconductor", metal, roughness));
        case normal_map:
            return bsdf("normalmap", rgb("normalmap", "0.6 0.45 0.95"), plain);
        case nothing:
            return bsdf("null");
    }
    return "";
}

std::string ply(const SceneMesh& mesh) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                       "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                       std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3d& v : mesh.vertices)
        text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
    for (const auto& t : mesh.triangles)
        text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    return text;
}

std::string shape_xml(const SceneShape& s, const SceneMaterial& material, const std::string& mesh_file) {
    constexpr const char* types[] = {"sphere", "disk", "rectangle", "cube", "cylinder", "ply"};
    std::string inside = material.two_sided ? bsdf("twosided", one_sided_xml(material)) : one_sided_xml(material);
    if (s.kind == SceneShape::Kind::mesh) inside += text("filename", mesh_file) + flag("face_normals", !s.mesh.smooth);
    if (s.flip_normals) inside += flag("flip_normals");
    if (s.emits()) inside += emitter("area", color("radiance", s.radiance));
    if (s.interior >= 0) inside += fmt::format("<ref name='interior' id='medium{}'/>", s.interior);
    return shape(types[static_cast<std::size_t>(s.kind)], placed(s.to_world), inside);
}

std::string light_xml(const SceneLight& light) {
    const std::string place = placed(light.to_world);
    switch (light.kind) {
        case SceneLight::Kind::point:
            return emitter("point", place, color("intensity", light.strength));
        case SceneLight::Kind::spot:
            return emitter("spot", place, color("intensity", light.strength), number("cutoff_angle", light.cutoff),
                           number("beam_width", light.beam));
        case SceneLight::Kind::directional:
            return emitter("directional", place, color("irradiance", light.strength));
        case SceneLight::Kind::sky:
            return emitter("constant", color("radiance", light.strength));
    }
    return "";
}

std::string camera_xml(const SceneCamera& camera, int medium) {
    std::string inside = box_film(camera.size);
    if (medium >= 0) inside += reference(fmt::format("medium{}", medium));
    if (camera.half_extent) {
        Mat4d to_world = camera.to_world;
        to_world.col(0) *= camera.half_extent->x();
        to_world.col(1) *= camera.half_extent->y();
        return element("sensor", "orthographic", placed(to_world), inside);
    }
    inside += placed(camera.to_world) + number("fov", camera.fov);
    if (camera.aperture == 0) return element("sensor", "perspective", inside);
    return element("sensor", "thinlens", inside, number("aperture_radius", camera.aperture),
                   number("focus_distance", camera.focus));
}

}  // namespace

std::string scene_file(const RandomScene& scene, const TemporaryFolder& folder) {
    std::string body = element("integrator", "volpath", integer("max_depth", scene.max_depth));
    for (std::size_t i = 0; i < scene.media.size(); ++i) {
        const SceneMedium& medium = scene.media[i];
        body += fmt::format("<medium type='homogeneous' id='medium{}'>", i) + color("sigma_t", medium.sigma_t) +
                color("albedo", medium.albedo) + element("phase", "hg", number("g", medium.g)) + "</medium>";
    }
    body += camera_xml(scene.camera, scene.camera_medium);
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        const SceneShape& s = scene.shapes[i];
        std::string file;
        if (s.kind == SceneShape::Kind::mesh) file = folder.write(fmt::format("mesh{}.ply", i), ply(s.mesh));
        body += shape_xml(s, scene.materials[static_cast<std::size_t>(s.material)], file);
    }
    for (const SceneLight& light : scene.lights)
        body += light_xml(light);
    return scene_xml(body);
}

}  // namespace gib::test
