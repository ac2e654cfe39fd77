#pragma once
// Scenes for tests, put together from elements of the scene language. Each function returns XML, so that
//     shape("sphere", center(0, 0, 10), radius(0.4), diffuse(0.5))
// is a shape element with its content, and
//     Scene(box_film(16)).camera(60).floor(0.5).lamp(4, 2).add(shape("cube", to_world(scale(0.3)))).load()
// is a loaded scene.

#include "common/reader/scene_file.h"
#include "tests/support/source_path.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace gib::test {

/// An element with a type: <tag type='...'>content</tag>.
template <class... Content>
std::string element(std::string_view tag, std::string_view type, const Content&... content) {
    return fmt::format("<{0} type='{1}'>", tag, type) + (std::string() + ... + content) + fmt::format("</{}>", tag);
}
template <class... Content>
std::string shape(std::string_view type, const Content&... content) {
    return element("shape", type, content...);
}
template <class... Content>
std::string bsdf(std::string_view type, const Content&... content) {
    return element("bsdf", type, content...);
}
template <class... Content>
std::string emitter(std::string_view type, const Content&... content) {
    return element("emitter", type, content...);
}
template <class... Content>
std::string texture(std::string_view type, const Content&... content) {
    return element("texture", type, content...);
}

/// Named values: <float>, <integer>, <boolean>, <string>, <rgb>, <spectrum>, <point>, <vector>.
inline std::string value_element(std::string_view tag, std::string_view name, std::string_view value) {
    return fmt::format("<{} name='{}' value='{}'/>", tag, name, value);
}
inline std::string number(std::string_view name, double value) {
    return value_element("float", name, fmt::to_string(value));
}
inline std::string integer(std::string_view name, long value) {
    return value_element("integer", name, fmt::to_string(value));
}
inline std::string flag(std::string_view name, bool value = true) {
    return value_element("boolean", name, value ? "true" : "false");
}
inline std::string text(std::string_view name, std::string_view value) { return value_element("string", name, value); }
inline std::string rgb(std::string_view name, std::string_view values) { return value_element("rgb", name, values); }
inline std::string rgb(std::string_view name, double grey) { return rgb(name, fmt::to_string(grey)); }
inline std::string spectrum(std::string_view name, double value) {
    return value_element("spectrum", name, fmt::to_string(value));
}
inline std::string point(std::string_view name, double x, double y, double z) {
    return fmt::format("<point name='{}' x='{}' y='{}' z='{}'/>", name, x, y, z);
}
inline std::string vector(std::string_view name, double x, double y, double z) {
    return fmt::format("<vector name='{}' x='{}' y='{}' z='{}'/>", name, x, y, z);
}
inline std::string center(double x, double y, double z) { return point("center", x, y, z); }
inline std::string radius(double value) { return number("radius", value); }
inline std::string reference(std::string_view id) { return fmt::format("<ref id='{}'/>", id); }

/// Steps of a transform, which act in the order in which they stand: to_world(scale(2), translate(0, 0, -1)).
inline std::string translate(double x, double y, double z) {
    return fmt::format("<translate x='{}' y='{}' z='{}'/>", x, y, z);
}
inline std::string scale(double factor) { return fmt::format("<scale value='{}'/>", factor); }
inline std::string scale(double x, double y, double z) { return fmt::format("<scale x='{}' y='{}' z='{}'/>", x, y, z); }
/// Turns by `degrees` about the axis 'x', 'y' or 'z'.
inline std::string rotate(char axis, double degrees) {
    return fmt::format("<rotate {}='1' angle='{}'/>", axis, degrees);
}
/// Points are written as "x, y, z".
inline std::string look_at(std::string_view origin, std::string_view target, std::string_view up = "0, 1, 0") {
    return fmt::format("<lookat origin='{}' target='{}' up='{}'/>", origin, target, up);
}
template <class... Steps>
std::string to_world(const Steps&... steps) {
    return "<transform name='to_world'>" + (std::string() + ... + steps) + "</transform>";
}

/// Materials and lights that many tests use. Radiance and intensity are grey or "r g b".
inline std::string diffuse(double reflectance) {
    return bsdf("twosided", bsdf("diffuse", rgb("reflectance", reflectance)));
}
inline std::string one_sided(std::string_view reflectance) { return bsdf("diffuse", rgb("reflectance", reflectance)); }
inline std::string glass(double index = 1.5) { return bsdf("dielectric", number("int_ior", index)); }
template <class Radiance>
std::string area_light(const Radiance& radiance) {
    return emitter("area", rgb("radiance", radiance));
}
template <class Intensity>
std::string point_light(double x, double y, double z, const Intensity& intensity) {
    return emitter("point", point("position", x, y, z), rgb("intensity", intensity));
}
template <class Radiance>
std::string constant_light(const Radiance& radiance) {
    return emitter("constant", rgb("radiance", radiance));
}

/// The <film> of a square image of `size` x `size` pixels with a box filter.
inline std::string box_film(int size) {
    return element("film", "hdrfilm", integer("width", size), integer("height", size), "<rfilter type='box'/>");
}
/// A perspective camera of `fov` degrees at the origin that looks along +z, unless `content` places it.
template <class... Content>
std::string camera(double fov, const Content&... content) {
    return element("sensor", "perspective", number("fov", fov), content...);
}

inline std::string scene_xml(const std::string& body) { return "<scene version='3.0.0'>" + body + "</scene>"; }

/// Collects elements of a scene.
class Scene {
public:
    template <class... Content>
    explicit Scene(const Content&... content) {
        add(content...);
    }
    template <class... Content>
    Scene& add(const Content&... content) {
        ((body_ += content), ...);
        return *this;
    }
    template <class... Content>
    Scene& camera(double fov, const Content&... content) {
        return add(test::camera(fov, content...));
    }
    /// A diffuse square of 20 x 20 in the plane y = 0, seen from above and below.
    Scene& floor(double reflectance) {
        return add(shape("rectangle", to_world(scale(10), rotate('x', -90)), diffuse(reflectance)));
    }
    /// A lamp of 1 x 1 at this height, which shines downwards.
    template <class Radiance>
    Scene& lamp(double height, const Radiance& radiance) {
        return add(
            shape("rectangle", to_world(scale(0.5), rotate('x', 90), translate(0, height, 0)), area_light(radiance)));
    }
    template <class... Content>
    Scene& sphere(double x, double y, double z, double r, const Content&... content) {
        return add(shape("sphere", center(x, y, z), radius(r), content...));
    }
    std::string xml() const { return scene_xml(body_); }
    LoadedScene load(const SceneLoadOptions& options = {}) const {
        return parse_scene(xml(), source_path("tests/inline.xml"), options);
    }

private:
    std::string body_;
};

/// A <float> with these digits.
inline std::string number(std::string_view name, std::string_view value) { return value_element("float", name, value); }
inline std::string filename(std::string_view path) { return text("filename", path); }
/// An element that is a parameter of the one around it: <tag name='...' type='...'>content</tag>.
template <class... Content>
std::string named(std::string_view tag, std::string_view name, std::string_view type, const Content&... content) {
    return fmt::format("<{} name='{}' type='{}'>", tag, name, type) + (std::string() + ... + content) +
           fmt::format("</{}>", tag);
}
inline std::string reference(std::string_view name, std::string_view id) {
    return fmt::format("<ref name='{}' id='{}'/>", name, id);
}
/// An element that others refer to: <tag type='...' id='...'>content</tag>.
template <class... Content>
std::string with_id(std::string_view tag, std::string_view type, std::string_view id, const Content&... content) {
    return fmt::format("<{} type='{}' id='{}'>", tag, type, id) + (std::string() + ... + content) +
           fmt::format("</{}>", tag);
}
template <class... Steps>
std::string to_uv(const Steps&... steps) {
    return "<transform name='to_uv'>" + (std::string() + ... + steps) + "</transform>";
}

}  // namespace gib::test
