#pragma once
// Pieces of scene files, with numbers of all their digits.

#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <cmath>
#include <string>

namespace gib::test {

inline std::string exact(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", x);
    return text;
}
inline std::string number_xml(const std::string& name, double x) {
    return "<float name='" + name + "' value='" + exact(x) + "'/>";
}
inline std::string rgb_xml(const std::string& name, double x) {
    return "<rgb name='" + name + "' value='" + exact(x) + "'/>";
}
inline std::string diffuse_bsdf(double reflectance) {
    return "<bsdf type='diffuse'>" + rgb_xml("reflectance", reflectance) + "</bsdf>";
}
inline std::string area_emitter(double radiance) {
    return "<emitter type='area'>" + rgb_xml("radiance", radiance) + "</emitter>";
}
inline std::string glass(double int_ior, double ext_ior = 1) {
    return "<bsdf type='dielectric'>" + number_xml("int_ior", int_ior) + number_xml("ext_ior", ext_ior) + "</bsdf>";
}

inline std::string lookat(const Vec3d& origin, const Vec3d& target) {
    const auto text = [](const Vec3d& v) { return exact(v.x()) + "," + exact(v.y()) + "," + exact(v.z()); };
    return "<lookat origin='" + text(origin) + "' target='" + text(target) + "' up='0,1,0'/>";
}

/// The placement of a whole scene: it is scaled, then moved.
struct Place {
    double scale = 1;
    Vec3d move = Vec3d::Zero();

    /// The to_world of a camera, which must not contain a scale.
    std::string view(const Vec3d& origin, const Vec3d& target) const {
        return "<transform name='to_world'>" + lookat(scale * origin + move, scale * target + move) + "</transform>";
    }
    /// The to_world of a shape: `operations`, then the placement.
    std::string transform(const std::string& operations = "") const {
        std::string text = "<transform name='to_world'>" + operations;
        if (scale != 1) text += "<scale value='" + exact(scale) + "'/>";
        if (!move.isZero(0))
            text += "<translate x='" + exact(move.x()) + "' y='" + exact(move.y()) + "' z='" + exact(move.z()) + "'/>";
        return text + "</transform>";
    }
};

inline std::string shape(const std::string& type, const std::string& transform, const std::string& inside) {
    return "<shape type='" + type + "'>" + transform + inside + "</shape>";
}
inline std::string sphere_at(const Vec3d& center, double radius, const std::string& inside) {
    return "<shape type='sphere'><point name='center' x='" + exact(center.x()) + "' y='" + exact(center.y()) + "' z='" +
           exact(center.z()) + "'/>" + number_xml("radius", radius) + inside + "</shape>";
}
inline std::string camera(const std::string& transform, double fov, int size, const std::string& more = "") {
    return "<sensor type='perspective'>" + number_xml("fov", fov) + transform + box_film(size) + more + "</sensor>";
}

/// A sphere around the whole scene. Its walls reflect rho and emit 1 - rho, so the radiance is 1 everywhere and in
/// every direction, and an object that absorbs no light cannot be seen in it.
inline std::string furnace(double radius = 4, double rho = 0.5) {
    return sphere_at(Vec3d::Zero(), radius,
                     "<boolean name='flip_normals' value='true'/>" + diffuse_bsdf(rho) + area_emitter(1 - rho));
}

}  // namespace gib::test
