#pragma once
// A small room with surfaces of several kinds and a choice of lights, for tests of paths from both ends.

#include "tests/support/scene_fixtures.h"

#include <string>

namespace gib::test {

struct RoomOptions {
    std::string light, more = "", sensor = "perspective", sensor_more = "", filter = "box",
                       glossy_wall = bsdf("twosided", bsdf("roughconductor", number("alpha", 0.08))),
                       ball = bsdf("roughdielectric", number("alpha", 0.3));
};

/// A floor, a wall, a glossy mirror and a ball.
inline std::string room_xml(const RoomOptions& o) {
    const std::string diffuse = bsdf("twosided", one_sided("0.7, 0.5, 0.3"));
    const std::string film =
        element("film", "hdrfilm", integer("width", 8), integer("height", 8), element("rfilter", o.filter));
    std::string xml = element("sensor", o.sensor, o.sensor_more, to_world(look_at("0.1, 0.2, -3", "0, 0, 0")), film);
    xml += shape("rectangle", to_world(scale(2), rotate('y', 180), translate(0, 0, 2)), diffuse);
    xml += shape("rectangle", to_world(scale(2), rotate('x', -90), translate(0, -1, 0)), diffuse);
    if (!o.glossy_wall.empty())
        xml += shape("rectangle", to_world(rotate('y', 60), translate(-1, 0, 0)), o.glossy_wall);
    return scene_xml(xml + shape("sphere", radius(0.4), o.ball) + o.light + o.more);
}
inline LoadedScene room(const RoomOptions& options) { return scene_of(room_xml(options)); }

namespace lit_rooms {
/// A square of this size in front of the wall, which shines downwards.
inline std::string lamp_of(double size) {
    return shape("rectangle", to_world(scale(size), rotate('x', 90), translate(0.6, 1, 0)), area_light("5, 4, 3"));
}
inline const std::string lamp = lamp_of(0.5);
inline const std::string shining_ball = shape("sphere", center(0.8, 0.8, -0.5), radius(0.3), area_light(5));
inline const std::string point = emitter("point", test::point("position", 0.8, 1, -1));
inline const std::string spot =
    emitter("spot", number("cutoff_angle", 40), to_world(look_at("0.8, 1, -1", "0, 0, 0", "0, 0, 1")));
inline const std::string sun = emitter("directional", vector("direction", -1, -2, 1));
inline const std::string sky = constant_light("0.3, 0.4, 0.5");
inline const std::string fog =
    shape("cube", bsdf("null"),
          "<medium name='interior' type='homogeneous'>" + number("sigma_t", 0.7) + rgb("albedo", "0.9, 0.8, 0.6") +
              element("phase", "hg", number("g", 0.4)) + "</medium>");
inline const std::string grate = shape("rectangle", to_world(translate(0.3, 0, -0.8)),
                                       bsdf("mask", number("opacity", 0.4), bsdf("twosided", bsdf("diffuse"))));
inline const std::string plastic_ball = bsdf("plastic", rgb("diffuse_reflectance", 0.6));
inline const std::string glass_ball = bsdf("dielectric");
inline const std::string diffuse_ball = bsdf("diffuse");

}  // namespace lit_rooms

}  // namespace gib::test
