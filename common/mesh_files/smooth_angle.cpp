#include "common/mesh_files/smooth_angle.h"

#include "common/core/float_traps.h"

#include <map>
#include <numbers>

namespace gib {

namespace {

struct FaceCorner {
    std::size_t face, index;  ///< the index is 0, 1 or 2
    Vec3d normal;             ///< normal of the face, unit or zero
    double angle;             ///< angle at the corner [radians]
};

/// The corners of all faces, by place.
std::map<std::array<double, 3>, std::vector<FaceCorner>> corners_by_place(const MeshData& mesh) {
    std::map<std::array<double, 3>, std::vector<FaceCorner>> corners;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        Vec3d v[3];
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = mesh.positions[mesh.triangles[f][i]];
        const Vec3d n = (v[1] - v[0]).cross(v[2] - v[0]);
        const double length = n.stableNorm();
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d a = v[(i + 1) % 3] - v[i], b = v[(i + 2) % 3] - v[i];
            corners[{v[i].x(), v[i].y(), v[i].z()}].push_back(
                {f, i, length > 0 ? Vec3d(n.stableNormalized()) : Vec3d::Zero(), std::atan2(length, a.dot(b))});
        }
    }
    return corners;
}

}  // namespace

void compute_normals_between_creases(MeshData& mesh, double angle) {
    const FloatTrapsPaused paused;  // places that overflowed in a transform are refused once the whole scene is known
    const double least_cosine = std::cos(angle * std::numbers::pi / 180);
    MeshData parted;
    parted.attributes = mesh.attributes;
    for (MeshAttribute& attribute : parted.attributes)
        if (!attribute.per_face) attribute.values.clear();
    parted.triangles.resize(mesh.triangles.size());
    for (const auto& [place, corners] : corners_by_place(mesh)) {
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
