#include "common/mesh_files/mesh_data.h"

#include "common/core/float_traps.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// The unit vector along v; v itself if it is zero or not finite. Eigen's stableNormalized() divides by the length,
/// which has few digits below double's smallest normal number: v is therefore scaled to a length of about 1 first.
Vec3d unit_or_zero(const Vec3d& v) {
    const double largest = v.cwiseAbs().maxCoeff();
    if (!(largest > 0 && std::isfinite(largest))) return v;
    return (v / largest).normalized();
}

/// The inverse transpose of the linear part, times a positive number, because only the directions of transformed
/// normals count.
Eigen::Matrix3d normal_matrix(const Mat4d& to_world) {
    const Eigen::Matrix3d unit = unit_columns(to_world);
    Vec3d lengths;
    for (int i = 0; i < 3; ++i)
        lengths[i] = to_world.block<3, 1>(0, i).stableNorm();
    // (U D)^-T = U^-T D^-1. The inverse of D may leave double's range; the multiple of it used here does not.
    return unit.inverse().transpose() * Vec3d(lengths.minCoeff() / lengths.array()).asDiagonal();
}

}  // namespace

Eigen::Matrix3d unit_columns(const Mat4d& to_world) {
    Eigen::Matrix3d unit = to_world.topLeftCorner<3, 3>();
    for (int i = 0; i < 3; ++i)
        unit.col(i).stableNormalize();
    return unit;
}

void transform_mesh(MeshData& mesh, const Mat4d& to_world) {
    const FloatTrapsPaused paused;  // places that overflow are refused once the whole scene is known
    if (!to_world.isIdentity(0)) {
        const Eigen::Matrix3d linear = to_world.topLeftCorner<3, 3>();
        const Vec3d translation = to_world.topRightCorner<3, 1>();
        const Eigen::Matrix3d for_normals = normal_matrix(to_world);
        for (auto& p : mesh.positions)
            p = linear * p + translation;
        for (auto& n : mesh.normals)
            n = unit_or_zero(for_normals * n.cast<double>()).cast<float>();
    } else {
        for (auto& n : mesh.normals)
            n = unit_or_zero(n.cast<double>()).cast<float>();
    }
}

void compute_normals(MeshData& mesh) {
    const auto missing = [](const Vec3& n) { return n.isZero(0); };
    if (!mesh.normals.empty() && std::none_of(mesh.normals.begin(), mesh.normals.end(), missing)) return;
    const FloatTrapsPaused paused;  // places that overflowed in a transform are refused once the whole scene is known
    std::vector<Vec3d> sums(mesh.positions.size(), Vec3d::Zero());
    for (const auto& triangle : mesh.triangles) {
        Vec3d v[3];
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = mesh.positions[triangle[i]];
        const Vec3d n = (v[1] - v[0]).cross(v[2] - v[0]);
        const double length = n.stableNorm();
        if (!(length > 0)) continue;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d a = v[(i + 1) % 3] - v[i], b = v[(i + 2) % 3] - v[i];
            // |a x b| is the same at all three corners; an arc cosine would lose half of the digits of a small angle.
            // The angle is not divided by the length: near double's smallest number the quotient would be infinite.
            sums[triangle[i]] += std::atan2(length, a.dot(b)) * unit_or_zero(n);
        }
    }
    mesh.normals.resize(mesh.positions.size(), Vec3::Zero());
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (missing(mesh.normals[i])) mesh.normals[i] = unit_or_zero(sums[i]).cast<float>();
}

}  // namespace gib
