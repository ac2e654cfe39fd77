#include "common/mesh_files/mesh_data.h"

#include "common/core/float_traps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

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

struct FaceCorner {
    std::size_t face, index;  ///< the index is 0, 1 or 2
    Vec3d normal;             ///< normal of the face, unit or zero
    double angle;             ///< angle at the corner [radians]
};

/// Calls visit(corner) for the corners of all faces.
template <typename Visit>
void for_each_corner(const MeshData& mesh, const Visit& visit) {
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        Vec3d v[3];
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = mesh.positions[mesh.triangles[f][i]];
        const Vec3d n = (v[1] - v[0]).cross(v[2] - v[0]), unit = unit_or_zero(n);
        const double length = n.stableNorm();
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d a = v[(i + 1) % 3] - v[i], b = v[(i + 2) % 3] - v[i];
            // |a x b| is the same at all three corners; an arc cosine would lose half of the digits of a small angle.
            visit(FaceCorner{f, i, unit, std::atan2(length, a.dot(b))});
        }
    }
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
    for_each_corner(mesh, [&](const FaceCorner& corner) {
        sums[mesh.triangles[corner.face][corner.index]] += corner.angle * corner.normal;
    });
    mesh.normals.resize(mesh.positions.size(), Vec3::Zero());
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (missing(mesh.normals[i])) mesh.normals[i] = unit_or_zero(sums[i]).cast<float>();
}

void compute_normals_between_creases(MeshData& mesh, double angle) {
    const FloatTrapsPaused paused;  // places that overflowed in a transform are refused once the whole scene is known
    const double least_cosine = std::cos(angle * std::numbers::pi / 180);
    MeshData parted;
    parted.attributes = mesh.attributes;
    for (MeshAttribute& attribute : parted.attributes)
        if (!attribute.per_face) attribute.values.clear();
    parted.triangles.resize(mesh.triangles.size());
    std::map<std::array<double, 3>, std::vector<FaceCorner>> corners_by_place;
    for_each_corner(mesh, [&](const FaceCorner& corner) {
        const Vec3d& p = mesh.positions[mesh.triangles[corner.face][corner.index]];
        corners_by_place[{p.x(), p.y(), p.z()}].push_back(corner);
    });
    for (const auto& [place, corners] : corners_by_place) {
        // A vertex of the new mesh: its normal, and the old vertex, whose uv it has.
        std::map<std::pair<std::uint32_t, std::array<float, 3>>, std::uint32_t> vertices;
        for (const FaceCorner& corner : corners) {
            Vec3d sum = Vec3d::Zero();
            for (const FaceCorner& other : corners)
                if (other.normal.dot(corner.normal) > least_cosine || &other == &corner)
                    sum += other.angle * other.normal;
            const Vec3 normal = (sum.isZero(0) ? sum : Vec3d(sum.stableNormalized())).cast<float>();
            const std::uint32_t old = mesh.triangles[corner.face][corner.index];
            const auto [vertex, is_new] =
                vertices.emplace(std::pair(old, std::array<float, 3>{normal.x(), normal.y(), normal.z()}),
                                 static_cast<std::uint32_t>(parted.positions.size()));
            if (is_new) {
                parted.positions.push_back(mesh.positions[old]);
                parted.normals.push_back(normal);
                if (!mesh.uvs.empty()) parted.uvs.push_back(mesh.uvs[old]);
                for (std::size_t i = 0; i < mesh.attributes.size(); ++i)
                    if (!mesh.attributes[i].per_face)
                        parted.attributes[i].values.push_back(mesh.attributes[i].values[old]);
            }
            parted.triangles[corner.face][corner.index] = vertex->second;
        }
    }
    mesh = std::move(parted);
}

}  // namespace gib
