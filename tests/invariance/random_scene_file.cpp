// Writes random scenes as scene files and meshes.
#include "tests/invariance/random_scenes.h"
#include "tests/support/hard_cases.h"

namespace gib::test {

namespace {

std::string color_xml(const std::string& name, const Colord& c) {
    return "<rgb name='" + name + "' value='" + exact(c[0]) + " " + exact(c[1]) + " " + exact(c[2]) + "'/>";
}

std::string matrix_xml(const Mat4d& m) {
    std::string text = "<transform name='to_world'><matrix value='";
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            text += exact(m(row, column)) + " ";
    return text + "'/></transform>";
}

/// The colour `name`: an even one, or a checkerboard of the colour and half of it.
std::string textured(const std::string& name, const SceneMaterial& m) {
    if (m.tiles == 0) return color_xml(name, m.color);
    return "<texture type='checkerboard' name='" + name + "'>" + color_xml("color0", m.color) +
           color_xml("color1", 0.5 * m.color) + "<transform name='to_uv'><scale x='" + std::to_string(m.tiles) +
           "' y='" + std::to_string(m.tiles) + "'/></transform></texture>";
}

std::string bsdf(const std::string& type, const std::string& inside) {
    return "<bsdf type='" + type + "'>" + inside + "</bsdf>";
}

std::string one_sided_xml(const SceneMaterial& m) {
    using enum SceneMaterial::Kind;
    const std::string indices = number_xml("int_ior", m.ior) + number_xml("ext_ior", 1);
    const std::string roughness = "<string name='distribution' value='" + std::string(m.ggx ? "ggx" : "beckmann") +
                                  "'/>" + number_xml("alpha", m.alpha);
    const std::string metal = color_xml("eta", 2 * m.color) + color_xml("k", 4 * m.color);
    const std::string plain = bsdf("diffuse", textured("reflectance", m));
    switch (m.kind) {
        case diffuse:
            return plain;
        case mirror:
            return bsdf("conductor",
                        "<string name='material' value='none'/>" + color_xml("specular_reflectance", m.color));
        case conductor:
            return bsdf("conductor", metal);
        case rough_conductor:
            return bsdf("roughconductor", metal + roughness);
        case glass:
            return bsdf("dielectric", indices);
        case dispersive_glass:
            return bsdf("dielectric", indices + number_xml("cauchy_b", 0.01));
        case thin_glass:
            return bsdf("thindielectric", indices);
        case rough_glass:
            return bsdf("roughdielectric", indices + roughness);
        case plastic:
            return bsdf("plastic", indices + textured("diffuse_reflectance", m));
        case rough_plastic:
            return bsdf("roughplastic", indices + roughness + textured("diffuse_reflectance", m));
        case phong:
            return bsdf("phong", textured("diffuse_reflectance", m) + rgb_xml("specular_reflectance", 0.2) +
                                     number_xml("exponent", 2 / (m.alpha * m.alpha)));
        case mask:
            return bsdf("mask", number_xml("opacity", m.share) + plain);
        case blend:
            return bsdf("blendbsdf", number_xml("weight", m.share) + plain + bsdf("roughconductor", metal + roughness));
        case normal_map:
            return bsdf("normalmap", "<rgb name='normalmap' value='0.6 0.45 0.95'/>" + plain);
        case nothing:
            return bsdf("null", "");
    }
    return "";
}

std::string material_xml(const SceneMaterial& m) {
    return m.two_sided ? bsdf("twosided", one_sided_xml(m)) : one_sided_xml(m);
}

std::string ply(const SceneMesh& mesh) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                       "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                       std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3d& v : mesh.vertices)
        text += exact(v.x()) + " " + exact(v.y()) + " " + exact(v.z()) + "\n";
    for (const auto& t : mesh.triangles)
        text += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
    return text;
}

std::string shape_xml(const SceneShape& s, const SceneMaterial& material, const std::string& mesh_file) {
    constexpr const char* types[] = {"sphere", "disk", "rectangle", "cube", "cylinder", "ply"};
    std::string inside = material_xml(material);
    if (s.kind == SceneShape::Kind::mesh)
        inside += "<string name='filename' value='" + mesh_file + "'/><boolean name='face_normals' value='" +
                  (s.mesh.smooth ? "false" : "true") + "'/>";
    if (s.flip_normals) inside += "<boolean name='flip_normals' value='true'/>";
    if (s.emits()) inside += "<emitter type='area'>" + color_xml("radiance", s.radiance) + "</emitter>";
    if (s.interior >= 0) inside += "<ref name='interior' id='medium" + std::to_string(s.interior) + "'/>";
    return shape(types[static_cast<std::size_t>(s.kind)], matrix_xml(s.to_world), inside);
}

std::string light_xml(const SceneLight& light) {
    const auto emitter = [](const std::string& type, const std::string& inside) {
        return "<emitter type='" + type + "'>" + inside + "</emitter>";
    };
    switch (light.kind) {
        case SceneLight::Kind::point:
            return emitter("point", matrix_xml(light.to_world) + color_xml("intensity", light.strength));
        case SceneLight::Kind::spot:
            return emitter("spot", matrix_xml(light.to_world) + color_xml("intensity", light.strength) +
                                       number_xml("cutoff_angle", light.cutoff) + number_xml("beam_width", light.beam));
        case SceneLight::Kind::directional:
            return emitter("directional", matrix_xml(light.to_world) + color_xml("irradiance", light.strength));
        case SceneLight::Kind::sky:
            return emitter("constant", color_xml("radiance", light.strength));
    }
    return "";
}

std::string camera_xml(const SceneCamera& camera, int medium) {
    std::string inside = box_film(camera.size);
    if (medium >= 0) inside += "<ref id='medium" + std::to_string(medium) + "'/>";
    if (camera.half_extent) {
        Mat4d to_world = camera.to_world;
        to_world.col(0) *= camera.half_extent->x();
        to_world.col(1) *= camera.half_extent->y();
        return "<sensor type='orthographic'>" + matrix_xml(to_world) + inside + "</sensor>";
    }
    inside += matrix_xml(camera.to_world) + number_xml("fov", camera.fov);
    if (camera.aperture == 0) return "<sensor type='perspective'>" + inside + "</sensor>";
    return "<sensor type='thinlens'>" + inside + number_xml("aperture_radius", camera.aperture) +
           number_xml("focus_distance", camera.focus) + "</sensor>";
}

}  // namespace

std::string scene_file(const RandomScene& scene, const TemporaryFolder& folder) {
    std::string body = "<integrator type='volpath'><integer name='max_depth' value='" +
                       std::to_string(scene.max_depth) + "'/></integrator>";
    for (std::size_t i = 0; i < scene.media.size(); ++i) {
        const SceneMedium& medium = scene.media[i];
        body += "<medium type='homogeneous' id='medium" + std::to_string(i) + "'>" +
                color_xml("sigma_t", medium.sigma_t) + color_xml("albedo", medium.albedo) + "<phase type='hg'>" +
                number_xml("g", medium.g) + "</phase></medium>";
    }
    body += camera_xml(scene.camera, scene.camera_medium);
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        const SceneShape& s = scene.shapes[i];
        std::string file;
        if (s.kind == SceneShape::Kind::mesh) file = folder.write("mesh" + std::to_string(i) + ".ply", ply(s.mesh));
        body += shape_xml(s, scene.materials[static_cast<std::size_t>(s.material)], file);
    }
    for (const SceneLight& light : scene.lights)
        body += light_xml(light);
    return scene_xml(body);
}

}  // namespace gib::test
