#include "methods/radiosity/chart.h"

#include <algorithm>
#include <numbers>

namespace gib {

namespace {

constexpr std::uint32_t no_chart = ~0u;
constexpr double pi_d = std::numbers::pi;
constexpr double quarter_turn = pi_d / 2;

/// The largest distance of four points from a plane, as a share of their size, at which they are one quadrilateral.
constexpr double planarity = 1e-6;
/// Twice a triangle's area over its longest edge squared, below which it counts as a line.
constexpr double least_shape = 1e-10;
/// The extent of a curved piece over its distance from the origin below which rounding decides about
/// its patches' corners.
constexpr double least_resolution = 0x1p-40;

/// The direction of uv on face `part` of the cube. The tangent makes the areas of equal squares of uv nearly equal.
Vec3d cube_direction(std::uint32_t part, const Vec2d& uv) {
    const auto warp = [](double x) { return std::tan(pi_d / 4 * (2 * x - 1)); };
    const int axis = static_cast<int>(part / 2);
    Vec3d d = Vec3d::Zero();
    d[axis] = part % 2 == 0 ? 1 : -1;
    d[(axis + 1) % 3] = warp(uv.x());
    d[(axis + 2) % 3] = warp(uv.y());
    return d.normalized();
}

/// Inverse of cube_direction(): the face and uv; d need not be a unit vector.
std::pair<std::uint32_t, Vec2d> cube_place(const Vec3d& d) {
    Eigen::Index axis = 0;
    d.cwiseAbs().maxCoeff(&axis);
    const auto unwarp = [&](Eigen::Index i) {
        return std::clamp(std::atan(d[i % 3] / std::abs(d[axis])) * 2 / pi_d + 0.5, 0.0, 1.0);
    };
    return {static_cast<std::uint32_t>(2 * axis + (d[axis] < 0 ? 1 : 0)), {unwarp(axis + 1), unwarp(axis + 2)}};
}

/// Maps the unit square to the unit disk and keeps areas in proportion. Source: Shirley and Chiu 1997, "A Low
/// Distortion Map Between Disk and Square", JGT 2(3).
Vec2d square_to_disk(const Vec2d& uv) {
    const Vec2d s = 2 * uv - Vec2d::Ones();
    if (s.isZero(0)) return Vec2d::Zero();
    const bool wide = std::abs(s.x()) > std::abs(s.y());
    const double r = wide ? s.x() : s.y();
    const double phi = wide ? pi_d / 4 * (s.y() / s.x()) : pi_d / 2 - pi_d / 4 * (s.x() / s.y());
    return r * Vec2d(std::cos(phi), std::sin(phi));
}

/// Inverse of square_to_disk().
Vec2d disk_to_square(const Vec2d& d) {
    const double r = d.norm();
    if (r == 0) return Vec2d::Constant(0.5);
    double phi = std::atan2(d.y(), d.x());
    if (phi < -pi_d / 4) phi += 2 * pi_d;
    Vec2d s;
    if (phi < pi_d / 4) s = Vec2d(r, phi * r / (pi_d / 4));
    else if (phi < 3 * pi_d / 4) s = Vec2d((pi_d / 2 - phi) * r / (pi_d / 4), r);
    else if (phi < 5 * pi_d / 4) s = Vec2d(-r, (pi_d - phi) * r / (pi_d / 4));
    else s = Vec2d((phi - 3 * pi_d / 2) * r / (pi_d / 4), -r);
    return (s + Vec2d::Ones()).cwiseMax(0.0).cwiseMin(2.0) / 2;
}

/// The solid angle of a triangle of unit vectors [sr]. Source: Van Oosterom and Strackee 1983.
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return 2 * std::atan2(std::abs(a.dot(b.cross(c))), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

/// The weights with which the sum of e1 and e2 is closest to p - a.
Vec2d barycentric(const Vec3d& a, const Vec3d& e1, const Vec3d& e2, const Vec3d& p) {
    const Vec3d n = e1.cross(e2), d = p - a;
    const double scale = n.squaredNorm();
    return {d.cross(e2).dot(n) / scale, e1.cross(d).dot(n) / scale};
}

Vec3d bilinear(const std::array<Vec3d, 4>& c, const Vec2d& uv) {
    return (1 - uv.y()) * ((1 - uv.x()) * c[0] + uv.x() * c[1]) + uv.y() * ((1 - uv.x()) * c[3] + uv.x() * c[2]);
}

/// Inverse of bilinear() on a convex quadrilateral, by Newton's method; a parallelogram takes one step.
Vec2d bilinear_place(const std::array<Vec3d, 4>& c, const Vec3d& p) {
    Vec2d uv = Vec2d::Constant(0.5);
    for (int step = 0; step < 16; ++step) {
        const Vec3d du = (1 - uv.y()) * (c[1] - c[0]) + uv.y() * (c[2] - c[3]);
        const Vec3d dv = (1 - uv.x()) * (c[3] - c[0]) + uv.x() * (c[2] - c[1]);
        const Vec2d change = barycentric(bilinear(c, uv), du, dv, p);
        uv = (uv + change).cwiseMax(-0.1).cwiseMin(1.1);
        if (change.cwiseAbs().maxCoeff() < 1e-9) break;
    }
    return uv.cwiseMax(0.0).cwiseMin(1.0);
}

struct TriangleCorners {
    std::array<Vec3d, 3> p;
    Vec3d normal() const { return (p[1] - p[0]).cross(p[2] - p[0]); }
    double longest2() const {
        return std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
    }
    bool has_area() const { return normal().norm() > least_shape * longest2(); }
};

/// The quadrilateral that two triangles form; empty unless they share an edge, turn the same way and lie in one
/// plane, and the quadrilateral is convex.
std::optional<std::array<Vec3d, 4>> quad_of(const TriangleCorners& a, const TriangleCorners& b) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            // The edge i -> i + 1 of the first runs the other way in the second.
            if (a.p[i] != b.p[(j + 1) % 3] || a.p[(i + 1) % 3] != b.p[j]) continue;
            const std::array<Vec3d, 4> q = {a.p[i], b.p[(j + 2) % 3], a.p[(i + 1) % 3], a.p[(i + 2) % 3]};
            const Vec3d n = a.normal().normalized();
            if (std::abs(n.dot(q[1] - q[0])) > planarity * std::sqrt(a.longest2())) return std::nullopt;
            for (std::size_t k = 0; k < 4; ++k) {
                const Vec3d turn = (q[(k + 1) % 4] - q[k]).cross(q[(k + 2) % 4] - q[(k + 1) % 4]);
                if (!(turn.dot(n) > 1e-3 * std::sqrt((q[(k + 1) % 4] - q[k]).squaredNorm() *
                                                     (q[(k + 2) % 4] - q[(k + 1) % 4]).squaredNorm())))
                    return std::nullopt;
            }
            return q;
        }
    return std::nullopt;
}

/// p as a key that can be ordered.
std::array<double, 3> coordinates(const Vec3d& p) { return {p.x(), p.y(), p.z()}; }

std::uint32_t parts_of(Chart::Kind kind) {
    return kind == Chart::Kind::sphere ? 6 : kind == Chart::Kind::cylinder ? 4 : 1;
}

}  // namespace

Charts::Charts(const Scene& scene) : scene_(scene) {
    const auto& groups = scene.groups();
    Outlines known;
    const std::size_t shapes = groups.begin.empty() ? scene.shapes().size() : groups.begin.front();
    for (std::uint32_t shape = 0; shape < shapes; ++shape)
        add_shape(shape, no_instance, known);
    for (std::uint32_t i = 0; i < groups.instances.size(); ++i) {
        first_object_.push_back(first_of_.size());
        const std::uint32_t group = groups.instances[i].group;
        const std::size_t end = group + 1 < groups.begin.size() ? groups.begin[group + 1] : scene.shapes().size();
        for (std::uint32_t shape = groups.begin[group]; shape < end; ++shape)
            add_shape(shape, i, known);
    }
}

void Charts::add_shape(std::uint32_t shape, std::uint32_t instance, Outlines& known) {
    if (const auto* mesh = std::get_if<Mesh>(&scene_.shapes()[shape])) {
        first_of_.push_back(chart_of_.size());
        add_mesh(*mesh, shape, instance, known);
        return;
    }
    const Shape& s = scene_.shapes()[shape];
    const auto kind = std::holds_alternative<Sphere>(s) ? Chart::Kind::sphere
                      : std::holds_alternative<Disk>(s) ? Chart::Kind::disk
                                                        : Chart::Kind::cylinder;
    const auto next = static_cast<std::uint32_t>(charts_.size());
    std::vector<Chart> parts;
    for (std::uint32_t part = 0; part < parts_of(kind); ++part) {
        Chart chart{kind, shape, instance};
        chart.part = part;
        finish(chart);
        parts.push_back(chart);
    }
    const auto at = [&](double u, double v) { return coordinates(position(parts[0], Vec2d(u, v))); };
    const Outline outline = {at(0, 0), at(1, 0), at(0, 1), at(1, 1), at(0.5, 0.5)};
    const double place = Vec3d(outline[0].data()).cwiseAbs().maxCoeff();
    const bool is_resolved = std::all_of(parts.begin(), parts.end(), [&](const Chart& chart) {
        return chart.lengths.minCoeff() > least_resolution * place;
    });
    if (!is_resolved) {
        first_of_.push_back(no_chart);
    } else if (const auto [twin, is_new] = known.try_emplace(outline, next); !is_new) {
        first_of_.push_back(chart_of_twin(parts[0], twin->second));
    } else {
        first_of_.push_back(next);
        charts_.insert(charts_.end(), parts.begin(), parts.end());
    }
}

std::uint32_t Charts::chart_of_twin(const Chart& twin, std::uint32_t known) const {
    const Vec2d middle = Vec2d::Constant(0.25);
    const bool faces_the_same_way = surface_at(twin, middle).ng.dot(surface_at(charts_[known], middle).ng) > 0.f;
    return faces_the_same_way ? known : no_chart;
}

void Charts::add_mesh(const Mesh& mesh, std::uint32_t shape, std::uint32_t instance, Outlines& known) {
    const std::size_t first = chart_of_.size(), count = mesh.triangles.size();
    chart_of_.resize(first + count, no_chart);
    const auto corners = [&](std::size_t i) {
        const auto& t = mesh.triangles[i];
        const auto at = [&](std::size_t k) { return to_scene(mesh.vertex(t[k]).cast<double>(), instance); };
        return TriangleCorners{{at(0), at(1), at(2)}};
    };
    // The number of the first chart with the corners of t, and whether it is the next chart to be made.
    const auto chart_at = [&](const TriangleCorners& t) {
        Outline outline = {coordinates(t.p[0]), coordinates(t.p[1]), coordinates(t.p[2])};
        std::sort(outline.begin(), outline.begin() + 3);
        return known.try_emplace(outline, static_cast<std::uint32_t>(charts_.size()));
    };
    for (std::size_t i = 0; i < count; ++i) {
        const TriangleCorners here = corners(i);
        if (!here.has_area()) continue;
        Chart chart{.kind = Chart::Kind::triangle,
                    .shape = shape,
                    .instance = instance,
                    .primitive = static_cast<std::uint32_t>(i)};
        chart.corners = {here.p[0], here.p[1], here.p[1], here.p[2]};
        if (const auto [place, is_new] = chart_at(here); !is_new) {
            chart_of_[first + i] = chart_of_twin(chart, place->second);
            continue;
        }
        chart_of_[first + i] = static_cast<std::uint32_t>(charts_.size());
        if (i + 1 < count) {
            const TriangleCorners next = corners(i + 1);
            const auto quad = next.has_area() ? quad_of(here, next) : std::nullopt;
            if (quad && chart_at(next).second) {
                chart.kind = Chart::Kind::quad;
                chart.corners = *quad;
                chart.second = static_cast<std::uint32_t>(i + 1);
                chart_of_[first + i + 1] = chart_of_[first + i];
                ++i;
            }
        }
        finish(chart);
        charts_.push_back(chart);
    }
}

void Charts::finish(Chart& chart) const {
    const auto at = [&](double u, double v) { return position(chart, Vec2d(u, v)); };
    if (chart.kind == Chart::Kind::triangle) {
        chart.lengths = {(chart.corners[1] - chart.corners[0]).norm(), (chart.corners[3] - chart.corners[0]).norm()};
    } else {
        constexpr int steps = 8;  // chords for the length of a curved line
        for (const double across : {0.0, 0.5, 1.0}) {
            Vec2d length = Vec2d::Zero();
            for (int i = 0; i < steps; ++i) {
                const double from = static_cast<double>(i) / steps, to = static_cast<double>(i + 1) / steps;
                length += Vec2d((at(to, across) - at(from, across)).norm(), (at(across, to) - at(across, from)).norm());
            }
            chart.lengths = chart.lengths.cwiseMax(length);
        }
    }
    const Vec2d middle = Vec2d::Constant(0.25);
    const Vec3d turn = (position(chart, middle + Vec2d(1e-3, 0)) - position(chart, middle))
                           .cross(position(chart, middle + Vec2d(0, 1e-3)) - position(chart, middle));
    chart.reversed = turn.dot(surface_at(chart, middle).ng.cast<double>()) < 0;
}

Vec3d Charts::to_scene(const Vec3d& p, std::uint32_t instance) const {
    if (instance == no_instance) return p;
    const Instance& i = scene_.instances()[instance];
    return i.linear * p + i.translation;
}

Vec3d Charts::to_shape(const Vec3d& p, std::uint32_t instance) const {
    if (instance == no_instance) return p;
    const Instance& i = scene_.instances()[instance];
    return i.inverse * (p - i.translation);
}

Vec3d Charts::position(const Chart& chart, const Vec2d& uv) const {
    const Shape& shape = scene_.shapes()[chart.shape];
    switch (chart.kind) {
        case Chart::Kind::triangle:
            return chart.corners[0] + uv.x() * (chart.corners[1] - chart.corners[0]) +
                   uv.y() * (chart.corners[3] - chart.corners[0]);
        case Chart::Kind::quad:
            return bilinear(chart.corners, uv);
        case Chart::Kind::sphere: {
            const auto& sphere = std::get<Sphere>(shape);
            const Vec3d p =
                sphere.center.cast<double>() + static_cast<double>(sphere.radius) * cube_direction(chart.part, uv);
            return to_scene(p, chart.instance);
        }
        case Chart::Kind::disk: {
            const auto& disk = std::get<Disk>(shape);
            const Vec2d d = square_to_disk(uv);
            return to_scene(
                disk.center.cast<double>() + d.x() * disk.du.cast<double>() + d.y() * disk.dv.cast<double>(),
                chart.instance);
        }
        case Chart::Kind::cylinder:
            break;
    }
    const auto& cylinder = std::get<Cylinder>(shape);
    const double phi = quarter_turn * (chart.part + uv.x());
    const Vec3d around = std::cos(phi) * cylinder.s.cast<double>() + std::sin(phi) * cylinder.t.cast<double>();
    return to_scene(cylinder.base.cast<double>() + uv.y() * cylinder.axis.cast<double>() +
                        static_cast<double>(cylinder.radius) * around,
                    chart.instance);
}

SurfaceHit Charts::surface_at(const Chart& chart, const Vec2d& uv) const {
    const Vec3d p = position(chart, uv);
    Intersection at{
        .shape = chart.shape, .primitive = chart.primitive, .instance = chart.instance, .u = 0.f, .t = 0.f, .v = 0.f};
    if (const auto* mesh = std::get_if<Mesh>(&scene_.shapes()[chart.shape])) {
        const auto place = [&](std::uint32_t primitive) {
            const auto& t = mesh->triangles[primitive];
            const auto corner = [&](std::size_t k) {
                return to_scene(mesh->vertex(t[k]).cast<double>(), chart.instance);
            };
            return barycentric(corner(0), corner(1) - corner(0), corner(2) - corner(0), p);
        };
        const auto outside = [](const Vec2d& b) { return std::max({-b.x(), -b.y(), b.x() + b.y() - 1}); };
        Vec2d b = place(chart.primitive);
        if (chart.kind == Chart::Kind::quad && outside(b) > 0) {
            const Vec2d other = place(chart.second);
            if (outside(other) < outside(b)) {
                b = other;
                at.primitive = chart.second;
            }
        }
        at.u = static_cast<float>(b.x());
        at.v = static_cast<float>(b.y());
    }
    const Vec3 ng = scene_.surface_hit({p.cast<float>(), Vec3::UnitZ()}, at)->ng;
    return *scene_.surface_hit({p.cast<float>(), ng}, at);  // hit along ng, about which the normals agree
}

double Charts::curved_area(const Chart& chart, const ChartPoint& lower, const ChartPoint& upper) const {
    const Vec2d a = uv_of(lower), b = uv_of(upper);
    const double part = (b - a).prod();
    const Shape& shape = scene_.shapes()[chart.shape];
    const auto corner = [&](double u, double v) { return position(chart, Vec2d(u, v)); };
    if (chart.instance != no_instance) {
        const Vec3d p = corner(a.x(), a.y()), q = corner(b.x(), b.y());
        return 0.5 * (q - p).cross(corner(a.x(), b.y()) - corner(b.x(), a.y())).norm();
    }
    if (const auto* disk = std::get_if<Disk>(&shape))
        return pi_d * part * disk->du.cast<double>().norm() * disk->dv.cast<double>().norm();
    if (const auto* cylinder = std::get_if<Cylinder>(&shape))
        return quarter_turn * part * static_cast<double>(cylinder->radius) * cylinder->axis.cast<double>().norm();
    const double radius = static_cast<double>(std::get<Sphere>(shape).radius);
    const auto w = [&](double u, double v) { return cube_direction(chart.part, Vec2d(u, v)); };
    const Vec3d p = w(a.x(), a.y()), q = w(b.x(), b.y());
    return radius * radius * (solid_angle(p, w(b.x(), a.y()), q) + solid_angle(p, q, w(a.x(), b.y())));
}

std::size_t Charts::object_of(std::uint32_t shape, std::uint32_t instance) const {
    if (instance == no_instance) return shape;
    return first_object_[instance] + (shape - scene_.groups().begin[scene_.instances()[instance].group]);
}

std::optional<Charts::Place> Charts::locate(const SurfaceHit& hit) const {
    const std::size_t first = first_of_[object_of(hit.shape, hit.instance)];
    const Shape& shape = scene_.shapes()[hit.shape];
    const Vec3d p = hit.p.cast<double>();
    if (std::holds_alternative<Mesh>(shape)) {
        const std::uint32_t chart = chart_of_[first + hit.primitive];
        if (chart == no_chart) return std::nullopt;
        const auto& corners = charts_[chart].corners;
        if (charts_[chart].kind == Chart::Kind::quad) return Place{chart, bilinear_place(corners, p)};
        Vec2d uv = barycentric(corners[0], corners[1] - corners[0], corners[3] - corners[0], p).cwiseMax(0.0);
        if (uv.sum() > 1) uv /= uv.sum();
        return Place{chart, uv};
    }
    if (first == no_chart) return std::nullopt;
    const Vec3d local = to_shape(p, hit.instance);
    const auto chart = [&](std::uint32_t part) { return static_cast<std::uint32_t>(first + part); };
    if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        const auto [part, uv] = cube_place(local - sphere->center.cast<double>());
        return Place{chart(part), uv};
    }
    if (const auto* disk = std::get_if<Disk>(&shape)) {
        const Vec3d d = local - disk->center.cast<double>(), du = disk->du.cast<double>(), dv = disk->dv.cast<double>();
        return Place{chart(0), disk_to_square(Vec2d(d.dot(du) / du.squaredNorm(), d.dot(dv) / dv.squaredNorm()))};
    }
    const auto& cylinder = std::get<Cylinder>(shape);
    const Vec3d d = local - cylinder.base.cast<double>(), axis = cylinder.axis.cast<double>();
    double turns = std::atan2(d.dot(cylinder.t.cast<double>()), d.dot(cylinder.s.cast<double>())) / quarter_turn;
    if (turns < 0) turns += 4;
    const double part = std::clamp(std::floor(turns), 0.0, 3.0);
    return Place{chart(static_cast<std::uint32_t>(part)),
                 Vec2d(turns - part, d.dot(axis) / axis.squaredNorm()).cwiseMax(0.0).cwiseMin(1.0)};
}

}  // namespace gib
