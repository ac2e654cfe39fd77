#pragma once
// Small scenes for tests of radiosity, and a struct that assembles its patches, light, links and equation system.

#include "methods/radiosity/light.h"
#include "methods/radiosity/system.h"
#include "tests/support/scene_fixtures.h"

#include <fmt/format.h>

namespace gib::test {

inline const std::string inside_view =
    "<sensor type='perspective'><float name='fov' value='90'/>" + box_film(16) + "</sensor>";

inline std::string one_sided(const std::string& reflectance) {
    return "<bsdf type='diffuse'><rgb name='reflectance' value='" + reflectance + "'/></bsdf>";
}

inline std::string point_light(const std::string& position, double intensity) {
    return fmt::format(
        "<emitter type='point'><point name='position' value='{}'/><rgb name='intensity' value='{}'/></emitter>",
        position, intensity);
}

/// A cube of side 2 around the origin, seen and lit from inside.
inline std::string hollow_cube(const std::string& material) {
    return "<shape type='cube'><boolean name='flip_normals' value='true'/>" + material + "</shape>";
}
inline std::string hollow_sphere(const std::string& material) {
    return "<shape type='sphere'><boolean name='flip_normals' value='true'/>" + material + "</shape>";
}

/// A scene with its patches, links and system.
struct PatchedScene {
    LoadedScene loaded;
    Charts charts;
    PatchMesh mesh;
    std::uint64_t rays = 0;
    PatchLight light;
    PatchLinks links;
    RadiositySystem system;

    /// `size`: longest edge of a patch [scene units]; `error`: bound of the links'
    /// error, where 0 links all pairs of leaves.
    PatchedScene(const std::string& xml, double size, double error = 0, bool closed = true)
        : loaded(scene_of(scene_xml(inside_view + xml))),
          charts(*loaded.scene, size),
          mesh(charts, size),
          light(patch_light(mesh, 16, 1, rays)),
          links(link_patches(mesh, light, {error, error == 0, 1})),
          system(mesh, light, links.links, closed) {}
};

}  // namespace gib::test
