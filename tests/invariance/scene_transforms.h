#pragma once
// What may be done to a scene without changing its picture, or changing it in a known way.

#include "tests/invariance/random_scenes.h"

namespace gib::test {

/// All lengths times `s`. Radiance stays where lamps keep theirs, where the intensity of point and spot lights grows as
/// the squared distance, and extinction falls as lengths grow.
RandomScene scaled(RandomScene scene, double s);
RandomScene moved(RandomScene scene, const Vec3d& by);
/// About the origin; the camera turns with the scene.
RandomScene rotated(RandomScene scene, const Eigen::Matrix3d& rotation);
/// All light times `factor`.
RandomScene brightened(RandomScene scene, double factor);
/// Another order of the shapes; those that emit keep theirs among themselves, so that lights keep their numbers.
RandomScene with_shapes_shuffled(RandomScene scene, Dice& dice);
/// The lights and the shapes that emit in another order.
RandomScene with_lights_shuffled(RandomScene scene, Dice& dice);
/// Two lights in place of each that can be split: two halves of a rectangle, and two lights that share the strength of
/// one at the same place.
RandomScene with_lights_split(RandomScene scene, Dice& dice);
/// Four triangles in place of each of a flat-shaded mesh, between the middles of its edges.
RandomScene with_triangles_split(RandomScene scene);

}  // namespace gib::test
