#include "methods/parts/density/flat_regions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace gib {

namespace {

/// Meshes of more triangles, or of more planes, count as curved.
constexpr std::size_t most_triangles = 4096, most_planes = 64;

struct Plane {
    Vec3d normal, p;  ///< unit normal, and a point

    bool holds(const Vec3& q, double rounding) const { return std::abs(normal.dot(q.cast<double>() - p)) <= rounding; }
};

/// The planes of a mesh, and for each triangle the number of its plane.
struct MeshPlanes {
    static constexpr std::uint32_t none = ~0u;  ///< number of the plane of triangles without area
    std::vector<Plane> planes;
    std::vector<std::uint32_t> of_triangle;
};

/// Empty if the mesh counts as curved.
std::optional<MeshPlanes> planes_of(const Mesh& mesh, double rounding) {
    if (mesh.triangles.size() > most_triangles || !mesh.normals.empty()) return std::nullopt;
    MeshPlanes found;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        found.of_triangle.push_back(MeshPlanes::none);
        const Vec3d normal = mesh.normal_of(i);
        if (!(normal.squaredNorm() > 0)) continue;
        const auto& t = mesh.triangles[i];
        const auto same = std::find_if(found.planes.begin(), found.planes.end(), [&](const Plane& plane) {
            return plane.normal.dot(normal) > 0 && std::all_of(t.begin(), t.end(), [&](std::uint32_t v) {
                       return plane.holds(mesh.vertex(v), rounding);
                   });
        });
        found.of_triangle.back() = static_cast<std::uint32_t>(same - found.planes.begin());
        if (same != found.planes.end()) continue;
        if (found.planes.size() == most_planes) return std::nullopt;
        found.planes.push_back({normal.normalized(), mesh.vertex(t[0]).cast<double>()});
    }
    return found;
}

/// The edges at which a plane's triangles end. All others belong to two triangles, which run along them in opposite
/// directions because they face the same way.
std::vector<std::pair<Vec3, Vec3>> ends_of(const Mesh& mesh, const MeshPlanes& planes) {
    using Corner = std::array<float, 3>;
    struct Edge {
        std::uint32_t plane;
        Corner a, b;
        auto operator<=>(const Edge&) const = default;
    };
    std::map<Edge, std::array<int, 2>> runs;  // from a to b, and from b to a
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (planes.of_triangle[i] == MeshPlanes::none) continue;
        for (std::size_t j = 0; j < 3; ++j) {
            const Corner a = mesh.vertices[mesh.triangles[i][j]], b = mesh.vertices[mesh.triangles[i][(j + 1) % 3]];
            ++runs[{planes.of_triangle[i], std::min(a, b), std::max(a, b)}][a < b ? 0 : 1];
        }
    }
    std::vector<std::pair<Vec3, Vec3>> ends;
    for (const auto& [edge, times] : runs)
        if (times != std::array{1, 1})
            ends.emplace_back(Vec3(edge.a[0], edge.a[1], edge.a[2]), Vec3(edge.b[0], edge.b[1], edge.b[2]));
    return ends;
}

}  // namespace

FlatRegions::FlatRegions(const Scene& scene, int resolution) {
    const Bounds& bounds = scene.bounds();
    const Vec3 extent = bounds.empty() ? Vec3(Vec3::Zero()) : Vec3(bounds.upper - bounds.lower);
    voxel_ = extent.maxCoeff() / static_cast<float>(resolution);
    if (!(voxel_ > 0.f)) return;
    rounding_ = 16.f * unit_roundoff * bounds.lower.cwiseAbs().cwiseMax(bounds.upper.cwiseAbs()).maxCoeff();
    // Half a voxel beside the scene, so that its outermost planes lie within voxels.
    lower_ = bounds.lower - Vec3::Constant(0.5f * voxel_);
    for (std::size_t i = 0; i < 3; ++i)
        size_[i] = static_cast<int>(extent[static_cast<Eigen::Index>(i)] / voxel_) + 2;
    voxels_.resize(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                   static_cast<std::size_t>(size_[2]));

    const InstancedGroups& groups = scene.groups();
    const std::size_t in_scene = groups.begin.empty() ? scene.shapes().size() : groups.begin.front();
    for (std::size_t i = 0; i < in_scene; ++i) {
        const auto* mesh = std::get_if<Mesh>(&scene.shapes()[i]);
        if (mesh) add_mesh(*mesh, static_cast<std::uint32_t>(i));
        else add_box(bounds_of(scene.shapes()[i]), mixed);
    }
    for (const Instance& instance : groups.instances)
        for (std::size_t i = groups.begin[instance.group]; i < groups.begin[instance.group + 1]; ++i)
            add_box(transformed(instance, bounds_of(scene.shapes()[i])), mixed);
    spread();
}

int FlatRegions::resolution_for(std::uint64_t photons) {
    constexpr double coarsest = 8, finest = 32;
    return static_cast<int>(std::clamp(0.1 * std::sqrt(static_cast<double>(photons)), coarsest, finest));
}

void FlatRegions::add_mesh(const Mesh& mesh, std::uint32_t shape) {
    const auto planes = planes_of(mesh, double{rounding_});
    if (!planes) return add_box(bounds_of(mesh), mixed);
    const auto first = static_cast<std::uint32_t>(shape_of_plane_.size()) + mixed + 1;
    shape_of_plane_.resize(shape_of_plane_.size() + planes->planes.size(), shape);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::uint32_t plane = planes->of_triangle[i];
        const auto& t = mesh.triangles[i];
        add_triangle(mesh.vertex(t[0]), mesh.vertex(t[1]), mesh.vertex(t[2]),
                     plane == MeshPlanes::none ? mixed : first + plane);
    }
    for (const auto& [a, b] : ends_of(mesh, *planes))
        add_triangle(a, b, b, mixed);
}

void FlatRegions::add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t label) {
    const float ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
    const float longest = std::max({ab, bc, ca});
    if (longest <= sqr(voxel_)) {
        Bounds box;
        for (const Vec3& p : {a, b, c})
            box.add(p);
        return add_box(box, label);
    }
    const auto halve = [&](const Vec3& p, const Vec3& q, const Vec3& opposite) {
        const Vec3 middle = 0.5f * (p + q);
        add_triangle(p, middle, opposite, label);
        add_triangle(middle, q, opposite, label);
    };
    if (longest == ab) return halve(a, b, c);
    if (longest == bc) return halve(b, c, a);
    halve(c, a, b);
}

void FlatRegions::add_box(const Bounds& box, std::uint32_t label) {
    if (box.empty()) return;
    const Index from = index_of(box.lower - Vec3::Constant(rounding_)),
                to = index_of(box.upper + Vec3::Constant(rounding_));
    for (int z = from[2]; z <= to[2]; ++z)
        for (int y = from[1]; y <= to[1]; ++y)
            for (int x = from[0]; x <= to[0]; ++x) {
                std::uint32_t& here = voxels_[at({x, y, z})].labels[0];
                here = here == empty || here == label ? label : mixed;
            }
}

FlatRegions::Index FlatRegions::index_of(const Vec3& p) const {
    Index index;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = static_cast<Eigen::Index>(i);
        index[i] =
            static_cast<int>(std::clamp((p[axis] - lower_[axis]) / voxel_, 0.f, static_cast<float>(size_[i] - 1)));
    }
    return index;
}

void FlatRegions::spread() {
    struct Front {
        Index voxel;
        std::uint32_t label;
    };
    std::vector<Front> front, next;
    for (int z = 0; z < size_[2]; ++z)
        for (int y = 0; y < size_[1]; ++y)
            for (int x = 0; x < size_[0]; ++x)
                if (Voxel& voxel = voxels_[at({x, y, z})]; voxel.labels[0] != empty) {
                    voxel.steps[0] = 0;
                    front.push_back({{x, y, z}, voxel.labels[0]});
                }
    for (std::uint8_t step = 1; step <= most_steps; ++step) {
        next.clear();
        for (const auto& [from, label] : front)
            for (int z = std::max(from[2] - 1, 0); z <= std::min(from[2] + 1, size_[2] - 1); ++z)
                for (int y = std::max(from[1] - 1, 0); y <= std::min(from[1] + 1, size_[1] - 1); ++y)
                    for (int x = std::max(from[0] - 1, 0); x <= std::min(from[0] + 1, size_[0] - 1); ++x) {
                        Voxel& voxel = voxels_[at({x, y, z})];
                        if (voxel.labels[1] != empty || voxel.labels[0] == label) continue;
                        const std::size_t which = voxel.labels[0] == empty ? 0 : 1;
                        voxel.labels[which] = label;
                        voxel.steps[which] = step;
                        next.push_back({{x, y, z}, label});
                    }
        front.swap(next);
    }
}

bool FlatRegions::flat_around(const SurfaceHit& hit, float reach) const {
    if (voxels_.empty() || hit.own_bsdf) return false;
    const Voxel& voxel = voxels_[at(index_of(hit.p))];
    const std::uint32_t label = voxel.labels[0];
    if (label == empty || label == mixed || shape_of_plane_[label - mixed - 1] != hit.shape) return false;
    return is_beyond(reach, voxel.steps[1]);
}

bool FlatRegions::empty_around(const Vec3& p, float reach) const {
    return !voxels_.empty() && is_beyond(reach, voxels_[at(index_of(p))].steps[0]);
}

}  // namespace gib
