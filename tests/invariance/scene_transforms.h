#pragma once
// Transformations of a scene that keep its picture, or change it in a known way.

#include "tests/invariance/random_scenes.h"

namespace gib::test {

/// Multiplies all lengths by `s`. Radiance stays: lamps keep theirs, the intensity of point and spot lights grows
/// with the squared distance, and extinction falls as lengths grow.
RandomScene scaled(RandomScene scene, double s);
RandomScene moved(RandomScene scene, const Vec3d& by);
/// Rotates about the origin; the camera turns with the scene.
RandomScene rotated(RandomScene scene, const Eigen::Matrix3d& rotation);
/// Multiplies all light by `factor`.
RandomScene brightened(RandomScene scene, double factor);
/// Puts the shapes into another order. Shapes that emit keep their order among themselves, so that lights keep their
/// numbers.
RandomScene with_shapes_shuffled(RandomScene scene, Dice& dice);
/// Puts the lights, and the shapes that emit, into another order.
RandomScene with_lights_shuffled(RandomScene scene, Dice& dice);
/// Replaces each light that can be split by two: a rectangle by its two halves, another light by two at the same
/// place that share its strength.
RandomScene with_lights_split(RandomScene scene, Dice& dice);
/// Replaces each triangle of a flat-shaded mesh by four, whose corners are its own and the middles of its edges.
RandomScene with_triangles_split(RandomScene scene);

}  // namespace gib::test
