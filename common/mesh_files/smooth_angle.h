#pragma once
// Normals of a mesh that is smooth but for its creases.

#include "common/mesh_files/mesh_data.h"

namespace gib {

/// Replaces all normals: at each corner of a face, the mean of the normals of those faces around the same place that lean
/// away from this face by less than `angle` [degrees], weighted as by compute_normals(). Vertices are parted where that
/// gives unlike normals at a place. This is the max_smooth_angle of Mitsuba 0.6 (its documentation of the plugin obj).
void compute_normals_between_creases(MeshData& mesh, double angle);

}  // namespace gib
