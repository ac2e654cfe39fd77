#pragma once
// A small room with surfaces of several kinds and a choice of lights, for tests of paths from both ends.

#include "tests/support/scene_fixtures.h"

#include <string>

namespace gib::test {

struct RoomOptions {
    std::string light,
        more = "", sensor = "perspective", sensor_more = "", filter = "box",
        glossy_wall =
            "<bsdf type='twosided'><bsdf type='roughconductor'><float name='alpha' value='0.08'/></bsdf></bsdf>",
        ball = "<bsdf type='roughdielectric'><float name='alpha' value='0.3'/></bsdf>";
};

/// A floor, a wall, a glossy mirror and a ball.
inline LoadedScene room(const RoomOptions& o) {
    const auto wall = [](const std::string& transform, const std::string& bsdf) {
        return "<shape type='rectangle'><transform name='to_world'>" + transform + "</transform>" + bsdf + "</shape>";
    };
    const std::string diffuse =
        "<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' "
        "value='0.7, 0.5, 0.3'/></bsdf></bsdf>";
    return scene_of(
        "<scene version='3.0.0'><sensor type='" + o.sensor + "'>" + o.sensor_more +
        "<transform name='to_world'><lookat origin='0.1, 0.2, -3' target='0, 0, 0' up='0, 1, 0'/></transform>"
        "<film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='8'/><rfilter type='" +
        o.filter + "'/></film></sensor>" +
        wall("<scale value='2'/><rotate y='1' angle='180'/><translate z='2'/>", diffuse) +
        wall("<scale value='2'/><rotate x='1' angle='-90'/><translate y='-1'/>", diffuse) +
        (o.glossy_wall.empty() ? "" : wall("<rotate y='1' angle='60'/><translate x='-1'/>", o.glossy_wall)) +
        "<shape type='sphere'><float name='radius' value='0.4'/>" + o.ball + "</shape>" + o.light + o.more +
        "</scene>");
}

namespace lit_rooms {
inline const std::string lamp =
    "<shape type='rectangle'><transform name='to_world'><scale value='0.5'/><rotate x='1' angle='90'/>"
    "<translate x='0.6' y='1'/></transform><emitter type='area'><rgb name='radiance' value='5, 4, "
    "3'/></emitter></shape>";
inline const std::string shining_ball =
    "<shape type='sphere'><point name='center' x='0.8' y='0.8' z='-0.5'/><float name='radius' value='0.3'/>"
    "<emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>";
inline const std::string point = "<emitter type='point'><point name='position' x='0.8' y='1' z='-1'/></emitter>";
inline const std::string spot =
    "<emitter type='spot'><float name='cutoff_angle' value='40'/><transform name='to_world'>"
    "<lookat origin='0.8, 1, -1' target='0, 0, 0' up='0, 0, 1'/></transform></emitter>";
inline const std::string sun = "<emitter type='directional'><vector name='direction' x='-1' y='-2' z='1'/></emitter>";
inline const std::string sky = "<emitter type='constant'><rgb name='radiance' value='0.3, 0.4, 0.5'/></emitter>";
inline const std::string fog =
    "<shape type='cube'><bsdf type='null'/><medium name='interior' type='homogeneous'>"
    "<float name='sigma_t' value='0.7'/><rgb name='albedo' value='0.9, 0.8, 0.6'/>"
    "<phase type='hg'><float name='g' value='0.4'/></phase></medium></shape>";
inline const std::string grate =
    "<shape type='rectangle'><transform name='to_world'><translate z='-0.8' x='0.3'/></transform>"
    "<bsdf type='mask'><float name='opacity' value='0.4'/><bsdf type='twosided'>"
    "<bsdf type='diffuse'/></bsdf></bsdf></shape>";
inline const std::string plastic_ball = "<bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.6'/></bsdf>";
inline const std::string glass_ball = "<bsdf type='dielectric'/>";

}  // namespace lit_rooms

}  // namespace gib::test
