#pragma once
// Small scenes for tests of radiosity, and structs that assemble their patches, light, links and equation system.

#include "methods/radiosity/solution.h"
#include "tests/support/scene_fixtures.h"

#include <fmt/format.h>

namespace gib::test {

/// A scene seen from the origin along +z.
inline LoadedScene seen_from_inside(const std::string& body) {
    return scene_of(scene_xml(camera(90, box_film(16)) + body));
}

/// A cube of side 2 around the origin, seen and lit from inside.
inline std::string hollow_cube(const std::string& material) { return shape("cube", flag("flip_normals"), material); }
inline std::string hollow_sphere(const std::string& material) {
    return shape("sphere", flag("flip_normals"), material);
}

/// A scene with its patches, whose longest edge has the length `size` [scene units].
struct ScenePatches {
    LoadedScene loaded;
    Charts charts;
    PatchMesh mesh;

    ScenePatches(const std::string& xml, double size)
        : loaded(seen_from_inside(xml)), charts(*loaded.scene, size), mesh(charts, size) {}
};

/// A scene with its patches, links and system.
struct PatchedScene : ScenePatches {
    std::uint64_t rays = 0;
    StageTimes stages;
    PatchLight light;
    std::vector<PatchLink> links;
    RadiositySystem system;

    /// `error`: bound of the links' error, where 0 links all pairs of leaves.
    PatchedScene(const std::string& xml, double size, double error = 0, bool closed = true)
        : ScenePatches(xml, size),
          light(patch_light(mesh, 16, 1, rays, stages)),
          links(link_patches(mesh, light, error, 1, rays, stages)),
          system(mesh, light, links, closed) {}
};

}  // namespace gib::test
