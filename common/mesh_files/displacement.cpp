#include "common/mesh_files/displacement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <unordered_map>

namespace gib {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// The halves of the long edges of a mesh.
class EdgeHalver {
public:
    EdgeHalver(MeshData& mesh, double longest, std::size_t most) : mesh_(mesh), longest_(longest), most_(most) {}

    /// Whether the area needs too many triangles: with edges up to `longest` one covers at most that of an equilateral
    /// triangle, sqrt(3) / 4 longest^2.
    bool has_too_much_area() const {
        double area = 0;
        for (const Triangle& t : mesh_.triangles) {
            const Vec3d& p = mesh_.positions[t[0]];
            area += 0.5 * (mesh_.positions[t[1]] - p).cross(mesh_.positions[t[2]] - p).norm();
        }
        return area > static_cast<double>(most_) * std::sqrt(3.) / 4 * longest_ * longest_;
    }

    /// Halves each long edge once. Returns whether there was one; nothing if there would be too many triangles.
    std::optional<bool> halve_all() {
        middles_.clear();
        std::size_t parts = 0;
        for (const Triangle& t : mesh_.triangles)
            for (std::size_t i = 0; i < 3; ++i)
                parts += is_long(t[i], t[(i + 1) % 3]);
        if (parts == 0) return false;
        if (mesh_.triangles.size() + parts > most_) return std::nullopt;
        parts_.clear();
        parts_.reserve(mesh_.triangles.size() + parts);
        sources_.clear();
        for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
            split(mesh_.triangles[i]);
            sources_.resize(parts_.size(), i);
        }
        mesh_.triangles.swap(parts_);
        for (MeshAttribute& attribute : mesh_.attributes)
            if (attribute.per_face) repeat_values(attribute);
        return true;
    }

private:
    bool is_long(std::uint32_t a, std::uint32_t b) const {
        return (mesh_.positions[a] - mesh_.positions[b]).norm() > longest_;
    }

    void split(const Triangle& t) {
        const bool is_split[3] = {is_long(t[0], t[1]), is_long(t[1], t[2]), is_long(t[2], t[0])};
        const int count = is_split[0] + is_split[1] + is_split[2];
        // Turns the triangle until its first edge is split and, if there are two, its last one is not.
        std::size_t turn = 0;
        while (count > 0 && count < 3 && !(is_split[turn] && !is_split[(turn + 2) % 3]))
            ++turn;
        const std::uint32_t a = t[turn], b = t[(turn + 1) % 3], c = t[(turn + 2) % 3];
        if (count == 0) {
            parts_.push_back(t);
        } else if (count == 1) {
            const std::uint32_t ab = middle(a, b);
            parts_.insert(parts_.end(), {{a, ab, c}, {ab, b, c}});
        } else if (count == 2) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c);
            parts_.push_back({ab, b, bc});
            // The shorter diagonal of the quadrilateral a, ab, bc, c.
            if (distance2(a, bc) < distance2(ab, c)) parts_.insert(parts_.end(), {{a, ab, bc}, {a, bc, c}});
            else parts_.insert(parts_.end(), {{a, ab, c}, {ab, bc, c}});
        } else {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            parts_.insert(parts_.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
    }

    double distance2(std::uint32_t a, std::uint32_t b) const {
        return (mesh_.positions[a] - mesh_.positions[b]).squaredNorm();
    }

    /// The vertex in the middle of an edge, which is added if it is new.
    std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
        const std::uint64_t key = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
        const auto [it, is_new] = middles_.emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
        if (!is_new) return it->second;
        const Vec3d p = 0.5 * mesh_.positions[a] + 0.5 * mesh_.positions[b];
        mesh_.positions.push_back(p);
        if (!mesh_.normals.empty()) {
            const Vec3 n = mesh_.normals[a] + mesh_.normals[b];
            mesh_.normals.push_back(n.isZero(0) ? mesh_.normals[a] : n.normalized());
        }
        if (!mesh_.uvs.empty()) {
            const Vec2 uv = 0.5f * (mesh_.uvs[a] + mesh_.uvs[b]);
            mesh_.uvs.push_back(uv);
        }
        for (MeshAttribute& attribute : mesh_.attributes)
            if (!attribute.per_face) {
                const Color value = 0.5f * (attribute.values[a] + attribute.values[b]);
                attribute.values.push_back(value);
            }
        return it->second;
    }

    /// Gives each part of a triangle the triangle's value.
    void repeat_values(MeshAttribute& attribute) const {
        std::vector<Color> values;
        values.reserve(sources_.size());
        for (const std::size_t i : sources_)
            values.push_back(attribute.values[i]);
        attribute.values.swap(values);
    }

    MeshData& mesh_;
    double longest_;
    std::size_t most_;
    std::unordered_map<std::uint64_t, std::uint32_t> middles_;  ///< vertices in the middle of edges, by their ends
    std::vector<Triangle> parts_;
    std::vector<std::size_t> sources_;  ///< the triangle that each part comes from
};

/// A place and a normal, in an order by which equal ones are neighbours.
using Key = std::array<double, 6>;

/// For each vertex, the number of the group of vertices that have its key.
template <typename KeyOf>
std::vector<std::uint32_t> groups_of_vertices(std::size_t vertices, KeyOf key_of) {
    std::vector<std::uint32_t> order(vertices), groups(vertices);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key_of(a) < key_of(b); });
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < vertices; ++i) {
        if (i > 0 && key_of(order[i - 1]) < key_of(order[i])) ++group;
        groups[order[i]] = group;
    }
    return groups;
}

Key key_of(const Vec3d& p, const Vec3& n) {
    const Vec3d m = n.cast<double>();
    return {p.x(), p.y(), p.z(), m.x(), m.y(), m.z()};
}

/// For each vertex, the mean direction of the normals of all vertices in its place; zero if they cancel.
std::vector<Vec3d> mean_normals(const MeshData& mesh) {
    const auto groups = groups_of_vertices(mesh.positions.size(),
                                           [&](std::size_t i) { return key_of(mesh.positions[i], Vec3::Zero()); });
    std::vector<Vec3d> sums(mesh.positions.size(), Vec3d::Zero()), means;
    for (std::size_t i = 0; i < groups.size(); ++i)
        sums[groups[i]] += mesh.normals[i].cast<double>();
    means.reserve(groups.size());
    for (const std::uint32_t group : groups)
        means.push_back(sums[group].norm() > 1e-6 ? sums[group].normalized() : Vec3d(Vec3d::Zero()));
    return means;
}

/// Computes the normals again, as one for all vertices that have the same place now and had the same normal.
void renew_normals(MeshData& mesh) {
    const auto groups = groups_of_vertices(mesh.positions.size(),
                                           [&](std::size_t i) { return key_of(mesh.positions[i], mesh.normals[i]); });
    MeshData merged;
    merged.positions.resize(mesh.positions.size(), Vec3d::Zero());
    for (std::size_t i = 0; i < groups.size(); ++i)
        merged.positions[groups[i]] = mesh.positions[i];
    merged.triangles.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles)
        merged.triangles.push_back({groups[t[0]], groups[t[1]], groups[t[2]]});
    compute_normals(merged);
    for (std::size_t i = 0; i < groups.size(); ++i) {
        // The normals of some files are against the order of their triangles' vertices.
        const Vec3 n = merged.normals[groups[i]];
        mesh.normals[i] = n.dot(mesh.normals[i]) < 0.f ? Vec3(-n) : n;
    }
}

}  // namespace

bool subdivide(MeshData& mesh, double longest, std::size_t most) {
    EdgeHalver halver(mesh, longest, most);
    if (halver.has_too_much_area()) return false;
    for (;;) {
        const auto halved = halver.halve_all();
        if (!halved) return false;
        if (!*halved) return true;
    }
}

void displace(MeshData& mesh, const std::function<double(const Vec2& uv)>& height, double direction) {
    compute_normals(mesh);
    const std::vector<Vec3d> normals = mean_normals(mesh);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        mesh.positions[i] += direction * height(mesh.uvs.empty() ? Vec2(Vec2::Zero()) : mesh.uvs[i]) * normals[i];
    renew_normals(mesh);
}

}  // namespace gib
