#include "methods/parts/emission/projection_targets.h"

#include "common/core/parallel.h"
#include "common/scene/scene.h"

#include <algorithm>

namespace gib {

namespace {

using Ball = ProjectionTargets::Ball;

/// No shape has a finer grid than this.
constexpr int finest_grid = 32;
/// Relative bound of the rounding of positions in float and of ray queries.
constexpr float rounding = 1e-5f;

Ball ball_of(const Vec3& center, float radius, std::uint32_t shape, bool whole_sphere) {
    return {.center = center,
            .radius = radius + rounding * (radius + center.cwiseAbs().maxCoeff()),
            .shape = shape,
            .whole_sphere = whole_sphere};
}

/// Sorts pieces of triangles into the voxels of a grid over their bounds, and keeps the bounding box of
/// the pieces in each voxel.
class TriangleGrid {
public:
    TriangleGrid(const Bounds& bounds, int resolution)
        : lower_(bounds.lower),
          voxel_(std::max((bounds.upper - bounds.lower).maxCoeff() / static_cast<float>(resolution),
                          least_voxel(bounds))) {
        for (int i = 0; i < 3; ++i) {
            const float voxels = voxel_ > 0.f ? (bounds.upper - bounds.lower)[i] / voxel_ : 0.f;
            voxels_[i] = std::clamp(static_cast<int>(std::ceil(voxels)), 1, resolution);
        }
        boxes_.resize(static_cast<std::size_t>(voxels_[0]) * static_cast<std::size_t>(voxels_[1]) *
                      static_cast<std::size_t>(voxels_[2]));
    }

    /// Adds a triangle. One larger than a voxel is halved across its longest edge first.
    void add(const Vec3& a, const Vec3& b, const Vec3& c) {
        const float ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
        if (std::max({ab, bc, ca}) > sqr(voxel_)) {
            if (ab >= bc && ab >= ca) return halve(a, b, c);
            if (bc >= ca) return halve(b, c, a);
            return halve(c, a, b);
        }
        Bounds& box = boxes_[index((a + b + c) / 3.f)];
        box.add(a);
        box.add(b);
        box.add(c);
    }

    void add(const TriangleGrid& other) {
        for (std::size_t i = 0; i < boxes_.size(); ++i)
            boxes_[i].add(other.boxes_[i]);
    }

    void append_balls(std::uint32_t shape, std::vector<Ball>& balls) const {
        for (const Bounds& box : boxes_)
            if (!box.empty()) balls.push_back(ball_of(box.center(), 0.5f * box.diagonal(), shape, false));
    }

private:
    /// Eight steps of a float: the middle of a longer edge differs from both of its ends, so halving comes to an end.
    static float least_voxel(const Bounds& bounds) {
        return 16.f * unit_roundoff * bounds.lower.cwiseAbs().cwiseMax(bounds.upper.cwiseAbs()).maxCoeff();
    }
    void halve(const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 middle = 0.5f * (a + b);
        add(a, middle, c);
        add(middle, b, c);
    }
    std::size_t index(const Vec3& p) const {
        std::array<std::size_t, 3> at{};
        for (int i = 0; i < 3; ++i) {
            const float voxels = voxel_ > 0.f ? (p - lower_)[i] / voxel_ : 0.f;
            at[static_cast<std::size_t>(i)] =
                static_cast<std::size_t>(std::clamp(static_cast<int>(voxels), 0, voxels_[i] - 1));
        }
        return (at[2] * static_cast<std::size_t>(voxels_[1]) + at[1]) * static_cast<std::size_t>(voxels_[0]) + at[0];
    }

    Vec3 lower_;
    float voxel_;  ///< side of a voxel [scene units]
    Eigen::Vector3i voxels_;
    std::vector<Bounds> boxes_;
};

/// Appends balls around the pieces of one shape.
struct BallsOf {
    int resolution;
    std::uint32_t shape;
    std::vector<Ball>& balls;

    void operator()(const Mesh& mesh) const {
        Bounds bounds;
        for (const auto& t : mesh.triangles)
            for (const std::uint32_t v : t)
                bounds.add(mesh.vertex(v));
        if (bounds.empty()) return;
        const std::size_t per_block = std::max<std::size_t>(1 << 16, mesh.triangles.size() / 16 + 1);
        const std::size_t blocks = (mesh.triangles.size() + per_block - 1) / per_block;
        std::vector<TriangleGrid> grids(blocks, TriangleGrid(bounds, resolution));
        parallel_blocks(mesh.triangles.size(), per_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto& t = mesh.triangles[i];
                grids[block].add(mesh.vertex(t[0]), mesh.vertex(t[1]), mesh.vertex(t[2]));
            }
        });
        for (std::size_t i = 1; i < blocks; ++i)
            grids.front().add(grids[i]);
        grids.front().append_balls(shape, balls);
    }

    void operator()(const Sphere& sphere) const { balls.push_back(ball_of(sphere.center, sphere.radius, shape, true)); }

    /// The balls hold the parallelogram around the disk.
    void operator()(const Disk& disk) const {
        const Vec3 a = disk.center - disk.du - disk.dv, b = disk.center + disk.du - disk.dv;
        const Vec3 c = disk.center + disk.du + disk.dv, d = disk.center - disk.du + disk.dv;
        Bounds bounds;
        for (const Vec3& p : {a, b, c, d})
            bounds.add(p);
        TriangleGrid grid(bounds, resolution);
        grid.add(a, b, c);
        grid.add(a, c, d);
        grid.append_balls(shape, balls);
    }

    /// Cuts the cylinder into pieces about as long as they are wide.
    void operator()(const Cylinder& cylinder) const {
        const float length = cylinder.axis.norm();
        const float wanted = std::ceil(length / (2.f * cylinder.radius));
        const int pieces = static_cast<int>(std::clamp(wanted, 1.f, static_cast<float>(4 * resolution)));
        const float half = 0.5f / static_cast<float>(pieces);
        for (int i = 0; i < pieces; ++i)
            balls.push_back(ball_of(cylinder.base + (static_cast<float>(2 * i + 1) * half) * cylinder.axis,
                                    std::hypot(cylinder.radius, half * length), shape, false));
    }
};

void append_balls(const Shape& shape, std::uint32_t index, int resolution, std::vector<Ball>& balls) {
    std::visit(BallsOf{resolution, index, balls}, shape);
}

std::vector<Ball> balls_of(const Scene& scene, TargetSurfaces surfaces, std::size_t wanted_balls) {
    const InstancedGroups& groups = scene.groups();
    const std::size_t in_scene = groups.begin.empty() ? scene.shapes().size() : groups.begin.front();
    const auto wanted = [&](std::size_t shape) {
        return surfaces == TargetSurfaces::all || scene.material_of_shape(shape).traits().specular();
    };
    double copies = 0;
    for (std::size_t i = 0; i < in_scene; ++i)
        copies += wanted(i);
    for (const Instance& instance : groups.instances)
        for (std::size_t i = groups.begin[instance.group]; i < groups.begin[instance.group + 1]; ++i)
            copies += wanted(i);
    // A grid of n^3 voxels holds a surface in about 6 n^2 of them.
    const double finest = std::sqrt(static_cast<double>(wanted_balls) / (6 * std::max(copies, 1.0)));
    const int resolution = std::clamp(static_cast<int>(finest), 1, finest_grid);

    std::vector<Ball> balls;
    for (std::size_t i = 0; i < in_scene; ++i)
        if (wanted(i)) append_balls(scene.shapes()[i], static_cast<std::uint32_t>(i), resolution, balls);
    std::vector<std::vector<Ball>> of_group(groups.begin.empty() ? 0 : groups.begin.size() - 1);
    for (std::size_t g = 0; g < of_group.size(); ++g)
        for (std::size_t i = groups.begin[g]; i < groups.begin[g + 1]; ++i)
            if (wanted(i)) append_balls(scene.shapes()[i], ProjectionTargets::no_shape, resolution, of_group[g]);
    for (const Instance& instance : groups.instances) {
        // Bound of the map's largest singular value: the root of the largest row sum of |M^T M|, where
        // M is the map's matrix.
        const Eigen::Matrix3d square = instance.linear.transpose() * instance.linear;
        const double stretch = std::sqrt(square.cwiseAbs().rowwise().sum().maxCoeff());
        for (const Ball& ball : of_group[instance.group]) {
            const Vec3d center = instance.linear * ball.center.cast<double>() + instance.translation;
            balls.push_back(ball_of(center.cast<float>(),
                                    static_cast<float>(stretch * static_cast<double>(ball.radius)),
                                    ProjectionTargets::no_shape, false));
        }
    }
    return balls;
}

/// Tests whether rays from the ball (c, rho) into a cone with the half-angle alpha can meet the ball (q, r). With d =
/// |q - c|, they can if d <= r + rho, or if the angle between the cone's axis and q - c is at most alpha + asin((r +
/// rho) / d).
class BundleTest {
public:
    explicit BundleTest(const RayBundle& bundle)
        : bundle_(bundle),
          everywhere_(bundle.cone.half_angle >= std::numbers::pi),
          sine_(std::sin(bundle.cone.half_angle)),
          cosine_(std::cos(bundle.cone.half_angle)) {}

    bool can_meet(const Vec3& center, float radius) const {
        // By coordinates: Eigen computes two at once and waits until these are together in memory.
        const double x = double{center.x()} - bundle_.center.x(), y = double{center.y()} - bundle_.center.y(),
                     z = double{center.z()} - bundle_.center.z();
        const double reach = static_cast<double>(radius) + bundle_.radius, d2 = (x * x + y * y) + z * z;
        if (everywhere_ || d2 <= sqr(reach)) return true;
        const double adjacent = std::sqrt(d2 - sqr(reach));
        // If sin(alpha + beta) <= 0, with beta = asin((r + rho) / d), the sum is pi or more.
        if (sine_ * adjacent + cosine_ * reach <= 0) return true;
        const Vec3d& axis = bundle_.cone.axis;
        const double along = (axis.x() * x + axis.y() * y) + axis.z() * z;
        return (bundle_.lines ? std::abs(along) : along) >= cosine_ * adjacent - sine_ * reach;
    }

    /// Whether every ray of the bundle meets the sphere. This holds if the parallel rays that start in c meet a
    /// sphere that is smaller by rho.
    bool all_meet(const Vec3& center, float radius) const {
        const Vec3d to = center.cast<double>() - bundle_.center;
        // ball_of() has enlarged the ball for rounding, so the sphere itself is a little smaller.
        const double reach = static_cast<double>(radius) * (1 - 10 * static_cast<double>(rounding)) - bundle_.radius -
                             10 * static_cast<double>(rounding * center.cwiseAbs().maxCoeff());
        if (reach <= 0) return false;
        const double d2 = to.squaredNorm();
        if (d2 <= sqr(reach)) return true;
        if (bundle_.cone.half_angle >= 0.5 * std::numbers::pi) return false;
        const double angle = std::acos(std::clamp(bundle_.cone.axis.dot(to) / std::sqrt(d2), -1.0, 1.0));
        return angle + bundle_.cone.half_angle <= std::asin(reach / std::sqrt(d2));
    }

private:
    const RayBundle& bundle_;
    bool everywhere_;
    double sine_, cosine_;
};

}  // namespace

ProjectionTargets::ProjectionTargets(const Scene& scene, TargetSurfaces surfaces, std::size_t wanted_balls)
    : ProjectionTargets(balls_of(scene, surfaces, wanted_balls)) {}

ProjectionTargets::ProjectionTargets(std::vector<Ball> balls) {
    if (balls.empty()) return;
    nodes_.reserve(2 * balls.size() - 1);
    build(balls, 0, balls.size());
}

/// Builds the subtree over the balls [begin, end), halved at the median of the longest axis of their centres.
void ProjectionTargets::build(std::vector<Ball>& balls, std::size_t begin, std::size_t end) {
    const std::size_t node = nodes_.size();
    nodes_.emplace_back();
    if (end - begin == 1) {
        const Ball& ball = balls[begin];
        nodes_[node] = {.center = ball.center,
                        .radius = ball.radius,
                        .next = static_cast<std::uint32_t>(node + 1),
                        .shape = ball.shape,
                        .leaf = true,
                        .whole_sphere = ball.whole_sphere};
        return;
    }
    Bounds bounds, centers;
    for (std::size_t i = begin; i < end; ++i) {
        bounds.add(balls[i].center - Vec3::Constant(balls[i].radius));
        bounds.add(balls[i].center + Vec3::Constant(balls[i].radius));
        centers.add(balls[i].center);
    }
    float radius = 0.f;
    for (std::size_t i = begin; i < end; ++i)
        radius = std::max(radius, (balls[i].center - bounds.center()).norm() + balls[i].radius);
    Eigen::Index axis = 0;
    (centers.upper - centers.lower).maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return balls.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const Ball& a, const Ball& b) { return a.center[axis] < b.center[axis]; });
    build(balls, begin, middle);
    build(balls, middle, end);
    nodes_[node] = {.center = bounds.center(),
                    .radius = radius * (1.f + rounding),
                    .next = static_cast<std::uint32_t>(nodes_.size()),
                    .shape = no_shape,
                    .leaf = false,
                    .whole_sphere = false};
}

ProjectionTargets::Reach ProjectionTargets::reach(const RayBundle& bundle, std::uint32_t except,
                                                  std::uint32_t& hint) const {
    const BundleTest test(bundle);
    const auto meets = [&](const Node& node) {
        return test.can_meet(node.center, node.radius) && !(node.leaf && node.shape == except && except != no_shape);
    };
    const auto found = [&](std::uint32_t i) {
        hint = i;
        const Node& node = nodes_[i];
        return node.whole_sphere && test.all_meet(node.center, node.radius) ? Reach::all_meet : Reach::some;
    };
    if (nodes_.empty()) return Reach::none;
    if (nodes_[hint].leaf && meets(nodes_[hint])) return found(hint);
    for (std::uint32_t i = 0; i < nodes_.size();) {
        const Node& node = nodes_[i];
        if (!meets(node)) i = node.next;
        else if (node.leaf) return found(i);
        else ++i;
    }
    return Reach::none;
}

}  // namespace gib
