#include "common/lights/emission_bounds.h"

#include "common/lights/emission_axes.h"

#include <algorithm>

namespace gib {

namespace {

/// Relative rounding error of a position in float.
constexpr double rounding = 2e-6;
/// Rounding error of the square of a sine or cosine in float.
constexpr double rounding_of_square = 4e-7;
/// The most triangles that are examined one by one to bound a part of a mesh.
constexpr std::size_t most_triangles = 256;

double largest_coordinate(const Vec3d& p) { return p.cwiseAbs().maxCoeff(); }

/// A part of the unit disk in polar coordinates, angles in rad.
struct DiskPatch {
    double r0, r1, phi0, phi1;
};

/// The angle to which square_to_disk maps the direction (a, b) from the square's centre.
double concentric_angle(double a, double b) {
    const double quarter = 0.25 * std::numbers::pi;
    if (std::abs(a) > std::abs(b)) return quarter * (b / a) + (a < 0 ? 4 * quarter : 0);
    return quarter * (2 - a / b) + (b < 0 ? 4 * quarter : 0);
}

/// The image of the box [x0, x1] x [y0, y1] under square_to_disk. The radius is max(|a|, |b|). In each quadrant the
/// angle is monotone in a and in b, so that the corners give its range unless the centre lies inside.
DiskPatch square_to_disk_patch(double x0, double x1, double y0, double y1) {
    const double a0 = 2 * x0 - 1, a1 = 2 * x1 - 1, b0 = 2 * y0 - 1, b1 = 2 * y1 - 1;
    const auto least = [](double low, double high) {
        return low < 0 && high > 0 ? 0 : std::min(std::abs(low), std::abs(high));
    };
    DiskPatch patch{};
    patch.r0 = std::max(least(a0, a1), least(b0, b1));
    patch.r1 = std::max({std::abs(a0), std::abs(a1), std::abs(b0), std::abs(b1)});
    patch.phi0 = 0;
    patch.phi1 = 2 * std::numbers::pi;
    if (a0 < 0 && a1 > 0 && b0 < 0 && b1 > 0) return patch;
    const double middle = concentric_angle(0.5 * (a0 + a1), 0.5 * (b0 + b1));
    double low = 0, high = 0;
    for (const double a : {a0, a1}) {
        for (const double b : {b0, b1}) {
            if (a == 0 && b == 0) continue;
            const double from_middle = std::remainder(concentric_angle(a, b) - middle, 2 * std::numbers::pi);
            low = std::min(low, from_middle);
            high = std::max(high, from_middle);
        }
    }
    patch.phi0 = middle + low;
    patch.phi1 = middle + high;
    return patch;
}

struct Disc {
    Vec2d center;
    double radius;
};

Disc disc_around(const DiskPatch& patch) {
    const double r = 0.5 * (patch.r0 + patch.r1), phi = 0.5 * (patch.phi0 + patch.phi1);
    const double across = 0.5 * (patch.phi1 - patch.phi0);
    double squared = 0;
    for (const double end : {patch.r0, patch.r1})
        squared = std::max(squared, sqr(r - end) + 4 * r * end * sqr(std::sin(0.5 * across)));
    if (std::sqrt(squared) >= patch.r1) return {Vec2d::Zero(), patch.r1};
    return {r * Vec2d(std::cos(phi), std::sin(phi)), std::sqrt(squared)};
}

DiskPatch position_patch(const EmissionBox& box) {
    const auto at = [](float u) { return static_cast<double>(u); };
    return square_to_disk_patch(at(box.lower[0]), at(box.upper[0]), at(box.lower[1]), at(box.upper[1]));
}

Vec2 direction_lower(const EmissionBox& box) { return {box.lower[2], box.lower[3]}; }
Vec2 direction_upper(const EmissionBox& box) { return {box.upper[2], box.upper[3]}; }

/// The image of the box's directions under square_to_cosine_hemisphere. Near the rim z = sqrt(1 - r^2) loses half of
/// its digits, for which the patch is widened.
SphericalPatch cosine_hemisphere_patch(const EmissionBox& box) {
    const auto at = [](float u) { return static_cast<double>(u); };
    const DiskPatch d = square_to_disk_patch(at(box.lower[2]), at(box.upper[2]), at(box.lower[3]), at(box.upper[3]));
    const auto theta = [](double cosine2) { return std::acos(std::sqrt(std::clamp(cosine2, 0.0, 1.0))); };
    return {.theta0 = theta(1 - sqr(d.r0) + rounding_of_square),
            .theta1 = theta(1 - sqr(d.r1) - rounding_of_square),
            .phi0 = d.phi0,
            .phi1 = d.phi1};
}

/// How far Frame(w) v can move, for |v| = 1, while w stays within `angle` [rad] of an axis with |axis.z| = z; 2 if
/// the frame jumps. Frame(w) is the smallest rotation from +-z to w. Besides turning with w, it spins about w at a
/// rate of tan(theta / 2) <= 1; together this is a rate of at most sqrt(2) within a hemisphere of z.
double frame_motion(double z, double angle) {
    if (angle == 0) return 0;
    const bool jumps = angle >= 0.5 * std::numbers::pi || std::abs(z) <= std::sin(angle) + rounding;
    return jumps ? 2 : std::min(2.0, std::numbers::sqrt2 * angle);
}

/// Bounds the points center + Frame(w) (d, 0) for d on a patch of the disk of radius `radius` and w in the cone:
/// every line along w through a point on the disk meets the ball of the bundle.
RayBundle bundle_across(const Vec3& center, double radius, const DiskPatch& patch, const DirectionCone& w) {
    const Vec3d c = center.cast<double>();
    RayBundle bundle{c, radius * patch.r1, w};
    const double motion = frame_motion(w.axis.z(), w.half_angle);
    if (motion < 2) {
        const Disc disc = disc_around(patch);
        const Frame frame(w.axis.cast<float>());
        const double moved = radius * (disc.radius + motion * patch.r1);
        if (moved < bundle.radius) {
            bundle.radius = moved;
            bundle.center +=
                radius * (disc.center.x() * frame.s.cast<double>() + disc.center.y() * frame.t.cast<double>());
        }
    }
    bundle.radius += rounding * (largest_coordinate(c) + 2 * radius);
    return bundle;
}

/// Triangles `first` to `last` of a mesh: those that the box's u_position.x chooses among.
struct TriangleRange {
    std::size_t first, last;
};
TriangleRange triangles_of(const AreaSampler& surface, const EmissionBox& box) {
    return {surface.triangle_at(box.lower[0]), surface.triangle_at(std::nextafter(box.upper[0], 0.f))};
}

RayBundle bundle_of_triangle(const Mesh& mesh, const AreaSampler& surface, std::size_t i, const EmissionBox& box) {
    const auto& corner = mesh.triangles[i];
    const Vec3d v0 = mesh.vertex(corner[0]).cast<double>();
    const Vec3d e1 = mesh.vertex(corner[1]).cast<double>() - v0, e2 = mesh.vertex(corner[2]).cast<double>() - v0;
    const SurfacePoint point = mesh.point_at(i, 0.f, 0.f);
    // square_to_triangle gives b = u - min(u) / 2: each b increases with its own number and decreases with the other.
    const auto within = [&](float u) { return std::clamp(surface.within_triangle(i, u), 0.0, 1.0); };
    const double x0 = within(box.lower[0]), x1 = within(box.upper[0]);
    const double y0 = static_cast<double>(box.lower[1]), y1 = static_cast<double>(box.upper[1]);
    const auto b = [](double own, double other) { return own - 0.5 * std::min(own, other); };
    const Vec2d low(b(x0, y1), b(y0, x1)), high(b(x1, y0), b(y1, x0));
    const Vec2d middle = 0.5 * (low + high), half = 0.5 * (high - low);
    const Vec3d along = half.x() * e1, across = half.y() * e2;
    RayBundle bundle{v0 + middle.x() * e1 + middle.y() * e2, std::max((along + across).norm(), (along - across).norm()),
                     cone_around(cosine_hemisphere_patch(box), Frame(point.ng))};
    bundle.radius += static_cast<double>(point.offset) +
                     rounding * (largest_coordinate(v0) + largest_coordinate(e1) + largest_coordinate(e2));
    return bundle;
}

/// Bounds the rays of several triangles by a ball around their box and a cone around their directions.
RayBundle bundle_of_triangles(const Mesh& mesh, const TriangleRange& range, const EmissionBox& box) {
    Bounds bounds;
    Vec3d axis = Vec3d::Zero();
    double offset = 0;
    for (std::size_t i = range.first; i <= range.last; ++i) {
        for (const std::uint32_t v : mesh.triangles[i])
            bounds.add(mesh.vertex(v));
        const SurfacePoint point = mesh.point_at(i, 0.f, 0.f);
        // A triangle without an area has no normal and no offset, and is never chosen.
        if (mesh.normal_of(i).isZero(0)) continue;
        axis += point.ng.cast<double>();
        offset = std::max(offset, static_cast<double>(point.offset));
    }
    RayBundle bundle{bounds.center().cast<double>(), 0.5 * static_cast<double>(bounds.diagonal()), {}};
    bundle.radius += offset + rounding * (largest_coordinate(bundle.center) + bundle.radius);
    if (!(axis.norm() > 1e-3)) return bundle;
    const Vec3 n = axis.normalized().cast<float>();
    const Frame frame(n);
    double turn = 0;  // the largest motion of a frame's axis, the normal included
    for (std::size_t i = range.first; i <= range.last; ++i) {
        if (mesh.normal_of(i).isZero(0)) continue;
        const Frame own(mesh.point_at(i, 0.f, 0.f).ng);
        turn = std::max({turn, static_cast<double>((own.s - frame.s).norm()),
                         static_cast<double>((own.t - frame.t).norm()), static_cast<double>((own.n - frame.n).norm())});
    }
    // A unit vector is the sum of three coordinates, whose axes move by at most `turn` each: it moves by a chord of
    // at most sqrt(3) turn.
    const double chord = std::min(std::numbers::sqrt3 * turn, 2.0);
    bundle.cone = cone_around(cosine_hemisphere_patch(box), frame);
    bundle.cone.half_angle += 2 * std::asin(0.5 * chord);
    return bundle;
}

struct BundleOf {
    const std::vector<Shape>& shapes;
    const EmissionBox& box;

    RayBundle operator()(const AreaLight& light) const {
        return std::visit([&](const auto& shape) { return from(light, shape); }, shapes[light.shape]);
    }

    RayBundle operator()(const PointLight& light) const {
        return from_point(light.position, sphere_cone(emission_axes(light.position)));
    }

    RayBundle operator()(const SpotLight& light) const {
        return from_point(light.position(), light.cone_of(direction_lower(box), direction_upper(box)));
    }

    RayBundle operator()(const ProjectorLight& light) const {
        return from_point(light.position(), light.cone_of(direction_lower(box), direction_upper(box)));
    }

    RayBundle operator()(const DirectionalLight& light) const {
        return from_infinity(light.scene, {-light.direction.cast<double>().normalized(), 0});
    }

    RayBundle operator()(const ConstantEnvironment& light) const {
        return from_infinity(light.scene, sphere_cone(emission_axes(Vec3::Zero())));
    }

    RayBundle operator()(const MappedEnvironment& light) const {
        return from_infinity(light.scene, light.map->cone_of(direction_lower(box), direction_upper(box)));
    }

private:
    DirectionCone sphere_cone(const Frame& axes) const {
        return cone_around(square_to_sphere_patch(direction_lower(box), direction_upper(box)), axes);
    }

    static RayBundle from_point(const Vec3& p, const DirectionCone& cone) { return {p.cast<double>(), 0, cone}; }

    /// The origins lie on a disk far outside and do not matter: the lines pass the parallel disk in the scene's
    /// middle at the same places.
    RayBundle from_infinity(const BoundingSphere& scene, const DirectionCone& w) const {
        RayBundle bundle = bundle_across(scene.center, static_cast<double>(scene.radius), position_patch(box), w);
        bundle.cone.axis = -w.axis;
        bundle.lines = true;
        return bundle;
    }

    RayBundle from(const AreaLight& light, const Mesh& mesh) const {
        const TriangleRange range = triangles_of(light.surface, box);
        if (range.first == range.last) return bundle_of_triangle(mesh, light.surface, range.first, box);
        if (range.last - range.first < most_triangles) return bundle_of_triangles(mesh, range, box);
        const Bounds bounds = bounds_of(shapes[light.shape]);
        // The offset of a point is far below the size of the mesh. Needles are an exception; in smaller boxes they
        // are examined one by one.
        return {bounds.center().cast<double>(), 0.51 * static_cast<double>(bounds.diagonal()), {}};
    }

    RayBundle from(const AreaLight&, const Disk& disk) const {
        const Disc disc = disc_around(position_patch(box));
        const Vec3d du = disk.du.cast<double>(), dv = disk.dv.cast<double>(), c = disk.center.cast<double>();
        RayBundle bundle{c + disc.center.x() * du + disc.center.y() * dv, disc.radius * std::max(du.norm(), dv.norm()),
                         cone_around(cosine_hemisphere_patch(box), Frame(disk.normal))};
        bundle.radius += 2 * rounding * (largest_coordinate(c) + du.norm() + dv.norm());
        return bundle;
    }

    RayBundle from(const AreaLight&, const Cylinder& cylinder) const {
        const double turn = 2 * std::numbers::pi;
        const double phi0 = turn * static_cast<double>(box.lower[1]), phi1 = turn * static_cast<double>(box.upper[1]);
        const double phi = 0.5 * (phi0 + phi1), half = 0.5 * (phi1 - phi0);
        const double v = 0.5 * (static_cast<double>(box.lower[0]) + static_cast<double>(box.upper[0]));
        const Vec3d axis = cylinder.axis.cast<double>(), base = cylinder.base.cast<double>();
        const Vec3d n = std::cos(phi) * cylinder.s.cast<double>() + std::sin(phi) * cylinder.t.cast<double>();
        const double radius = static_cast<double>(cylinder.radius);
        const double along = 0.5 * static_cast<double>(box.width(0)) * axis.norm();
        const double across = 2 * std::sin(0.5 * std::min(half, std::numbers::pi)) * radius;
        const bool all_round = across >= radius;
        RayBundle bundle{base + v * axis, std::hypot(along, all_round ? radius : across), {}};
        if (!all_round) bundle.center += radius * n;
        bundle.radius += 4 * rounding * (largest_coordinate(base) + axis.norm() + radius);
        const Vec3 ng = (cylinder.flip_normals ? Vec3d(-n) : n).cast<float>();
        bundle.cone = cone_around(cosine_hemisphere_patch(box), frame_along(ng, cylinder.axis));
        bundle.cone.half_angle += half;  // the frame turns about the axis with the normal
        return bundle;
    }

    /// The line of a ray that leaves the sphere passes through the disk across its middle. A ray into a sphere that
    /// emits inwards starts up to a radius before this disk.
    RayBundle from(const AreaLight&, const Sphere& sphere) const {
        const double radius = static_cast<double>(sphere.radius);
        RayBundle bundle =
            bundle_across(sphere.center, radius, position_patch(box), sphere_cone(emission_axes(sphere.center)));
        if (sphere.flip_normals) {
            bundle.center -= radius * bundle.cone.axis;
            bundle.radius += radius * 2 * std::sin(0.5 * std::min(bundle.cone.half_angle, std::numbers::pi));
        }
        bundle.radius += 8 * rounding * (largest_coordinate(sphere.center.cast<double>()) + radius);
        return bundle;
    }
};

}  // namespace

RayBundle emission_bundle(const Light& light, const std::vector<Shape>& shapes, const EmissionBox& box) {
    return std::visit(BundleOf{shapes, box}, light);
}

std::array<bool, 4> emission_dimensions(const Light& light) {
    if (is_point(light)) return {false, false, true, true};
    if (std::holds_alternative<DirectionalLight>(light)) return {true, true, false, false};
    return {true, true, true, true};
}

float split_point(const Light& light, const std::vector<Shape>& shapes, const EmissionBox& box, std::size_t dimension) {
    const float middle = 0.5f * (box.lower[dimension] + box.upper[dimension]);
    const auto* area = std::get_if<AreaLight>(&light);
    if (dimension != 0 || !area || !std::holds_alternative<Mesh>(shapes[area->shape])) return middle;
    const TriangleRange range = triangles_of(area->surface, box);
    if (range.first == range.last) return middle;
    // The cut is the boundary between two triangles that is nearest to the middle.
    const std::size_t i = area->surface.triangle_at(middle);
    const float before = area->surface.begin_of_triangle(i);
    const float after = i < range.last ? area->surface.begin_of_triangle(i + 1) : box.lower[0];
    const auto inside = [&](float u) { return u > box.lower[0] && u < box.upper[0]; };
    if (!inside(before)) return inside(after) ? after : middle;
    if (!inside(after)) return before;
    return middle - before < after - middle ? before : after;
}

bool cannot_see_itself(const AreaLight& light, const std::vector<Shape>& shapes) {
    const Shape& shape = shapes[light.shape];
    if (const auto* sphere = std::get_if<Sphere>(&shape)) return !sphere->flip_normals;
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return !cylinder->flip_normals;
    const auto* mesh = std::get_if<Mesh>(&shape);
    if (!mesh) return true;
    if (mesh->triangles.size() * mesh->vertices.size() > (1u << 20)) return false;
    for (std::size_t i = 0; i < mesh->triangles.size(); ++i) {
        const SurfacePoint point = mesh->point_at(i, 0.f, 0.f);
        if (mesh->normal_of(i).isZero(0)) continue;
        // Rays start at the offset in front of the triangle and go to its front: they cannot meet vertices that lie
        // further back.
        for (const auto& t : mesh->triangles)
            for (const std::uint32_t v : t)
                if (!(point.ng.dot(mesh->vertex(v) - point.p) <= point.offset)) return false;
    }
    return true;
}

}  // namespace gib
