// Transformations of random scenes.
#include "tests/invariance/scene_transforms.h"

#include <algorithm>

namespace gib::test {

namespace {

/// Puts the elements into a random order.
template <typename T>
void shuffle(std::vector<T>& all, Dice& dice) {
    for (std::size_t i = all.size(); i-- > 1;)
        std::swap(all[i], all[static_cast<std::size_t>(dice.below(static_cast<int>(i) + 1))]);
}

/// The shapes for which `emits()` is as given, in their order.
std::vector<SceneShape> shapes_that(const RandomScene& scene, bool emit) {
    std::vector<SceneShape> some;
    std::copy_if(scene.shapes.begin(), scene.shapes.end(), std::back_inserter(some),
                 [&](const SceneShape& s) { return s.emits() == emit; });
    return some;
}

}  // namespace

RandomScene scaled(RandomScene scene, double s) {
    for (SceneShape& shape : scene.shapes)
        shape.to_world.topRows<3>() *= s;
    for (SceneLight& light : scene.lights) {
        light.to_world.topRightCorner<3, 1>() *= s;
        if (light.kind == SceneLight::Kind::point || light.kind == SceneLight::Kind::spot) light.strength *= s * s;
    }
    for (SceneMedium& medium : scene.media)
        medium.sigma_t /= s;
    SceneCamera& camera = scene.camera;
    camera.to_world.topRightCorner<3, 1>() *= s;
    if (camera.half_extent) *camera.half_extent *= s;
    camera.aperture *= s;
    camera.focus *= s;
    return scene;
}

RandomScene moved(RandomScene scene, const Vec3d& by) {
    for (SceneShape& shape : scene.shapes)
        shape.to_world.topRightCorner<3, 1>() += by;
    for (SceneLight& light : scene.lights)
        light.to_world.topRightCorner<3, 1>() += by;
    scene.camera.to_world.topRightCorner<3, 1>() += by;
    return scene;
}

RandomScene rotated(RandomScene scene, const Eigen::Matrix3d& rotation) {
    const auto turn = [&](Mat4d& m) { m.topRows<3>() = (rotation * m.topRows<3>()).eval(); };
    for (SceneShape& shape : scene.shapes)
        turn(shape.to_world);
    for (SceneLight& light : scene.lights)
        turn(light.to_world);
    turn(scene.camera.to_world);
    return scene;
}

RandomScene brightened(RandomScene scene, double factor) {
    for (SceneShape& shape : scene.shapes)
        shape.radiance *= factor;
    for (SceneLight& light : scene.lights)
        light.strength *= factor;
    return scene;
}

RandomScene with_shapes_shuffled(RandomScene scene, Dice& dice) {
    std::vector<SceneShape> dark = shapes_that(scene, false), lamps = shapes_that(scene, true);
    shuffle(dark, dice);
    scene.shapes.clear();
    auto lamp = lamps.begin();
    for (const SceneShape& shape : dark) {
        while (lamp != lamps.end() && dice.chance(0.3))
            scene.shapes.push_back(*lamp++);
        scene.shapes.push_back(shape);
    }
    scene.shapes.insert(scene.shapes.end(), lamp, lamps.end());
    return scene;
}

RandomScene with_lights_shuffled(RandomScene scene, Dice& dice) {
    shuffle(scene.shapes, dice);
    shuffle(scene.lights, dice);
    return scene;
}

RandomScene with_lights_split(RandomScene scene, Dice& dice) {
    std::vector<SceneShape> shapes;
    for (const SceneShape& shape : scene.shapes) {
        shapes.push_back(shape);
        if (!shape.emits() || shape.kind != SceneShape::Kind::rectangle) continue;
        // The range [-1, 1] is split into [-1, c] and [c, 1].
        const double c = dice.between(-0.8, 0.8);
        SceneShape& left = shapes.back();
        SceneShape right = shape;
        const Eigen::Vector4d x = shape.to_world.col(0);
        left.to_world.col(0) = 0.5 * (1 + c) * x;
        left.to_world.col(3) += 0.5 * (c - 1) * x;
        right.to_world.col(0) = 0.5 * (1 - c) * x;
        right.to_world.col(3) += 0.5 * (1 + c) * x;
        shapes.push_back(right);
    }
    scene.shapes = std::move(shapes);
    std::vector<SceneLight> lights;
    for (const SceneLight& light : scene.lights) {
        lights.push_back(light);
        if (light.kind == SceneLight::Kind::sky) continue;  // a scene has at most one
        const double share = dice.between(0.1, 0.9);
        lights.back().strength *= share;
        lights.push_back(light);
        lights.back().strength *= 1 - share;
    }
    scene.lights = std::move(lights);
    return scene;
}

RandomScene with_triangles_split(RandomScene scene) {
    for (SceneShape& shape : scene.shapes) {
        if (shape.mesh.smooth) continue;
        SceneMesh split;
        split.vertices = shape.mesh.vertices;
        for (const auto& [a, b, c] : shape.mesh.triangles) {
            const auto middle = [&](int i, int j) {
                split.vertices.push_back(
                    0.5 * (split.vertices[static_cast<std::size_t>(i)] + split.vertices[static_cast<std::size_t>(j)]));
                return static_cast<int>(split.vertices.size()) - 1;
            };
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const std::array<int, 3>& part :
                 {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
                split.triangles.push_back(part);
        }
        shape.mesh = std::move(split);
    }
    return scene;
}

}  // namespace gib::test
