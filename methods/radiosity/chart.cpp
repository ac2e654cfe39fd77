#include "methods/radiosity/chart.h"

#include <algorithm>
#include <numbers>

namespace gib {

namespace {

constexpr std::uint32_t no_chart = ~0u;
/// A point inside every chart.
const Vec2d inside = Vec2d::Constant(0.25);
constexpr double two_pi = 2 * std::numbers::pi;

/// The largest distance of four points from a plane, as a share of their size, at which they are one quadrilateral.
constexpr double planarity = 1e-6;
/// Twice a chart's area over its longest diagonal or edge squared, below which it counts as a line.
constexpr double least_shape = 1e-10;
/// The extent of a chart over its distance from the origin below which rounding decides about its patches' corners.
constexpr double least_resolution = 0x1p-40;
/// The least numbers of pieces around a curved shape and from pole to pole: their normals differ by 28 degrees.
constexpr std::uint32_t least_around = 13, least_along = 7;
/// The largest number of pieces in one direction; smaller patches are made by halving pieces.
constexpr double most_pieces = 256;

/// The weights with which the sum of e1 and e2 is closest to p - a.
Vec2d barycentric(const Vec3d& a, const Vec3d& e1, const Vec3d& e2, const Vec3d& p) {
    const Vec3d n = e1.cross(e2), d = p - a;
    const double scale = n.squaredNorm();
    return {d.cross(e2).dot(n) / scale, e1.cross(d).dot(n) / scale};
}

/// Inverse of Chart::position() on a convex quadrilateral, by Newton's method; a parallelogram takes one step. A step of
/// (a, b) leaves a b times the distance of the third corner from that of a parallelogram. Hits are known to 1e-7.
Vec2d bilinear_place(const Chart& chart, const Vec3d& p) {
    const std::array<Vec3d, 4>& c = chart.corners;
    const double twist = (c[0] - c[1] + c[2] - c[3]).norm() / (c[2] - c[0]).norm();
    Vec2d uv = Vec2d::Constant(0.5);
    for (int step = 0; step < 16; ++step) {
        const Vec3d du = (1 - uv.y()) * (c[1] - c[0]) + uv.y() * (c[2] - c[3]);
        const Vec3d dv = (1 - uv.x()) * (c[3] - c[0]) + uv.x() * (c[2] - c[1]);
        const Vec2d change = barycentric(chart.position(uv), du, dv, p);
        uv = (uv + change).cwiseMax(-0.1).cwiseMin(1.1);
        if (std::abs(change.prod()) * twist < 1e-7) break;
    }
    return uv.cwiseMax(0.0).cwiseMin(1.0);
}

using TriangleCorners = std::array<Vec3d, 3>;

Vec3d normal_of(const TriangleCorners& t) { return (t[1] - t[0]).cross(t[2] - t[0]); }
double longest2(const TriangleCorners& t) {
    return std::max({(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
}

/// The quadrilateral that two triangles form; empty unless they share an edge, turn the same way and lie in one
/// plane, and the quadrilateral is convex.
std::optional<std::array<Vec3d, 4>> quad_of(const TriangleCorners& a, const TriangleCorners& b) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            // The edge i -> i + 1 of the first runs the other way in the second.
            if (a[i] != b[(j + 1) % 3] || a[(i + 1) % 3] != b[j]) continue;
            const std::array<Vec3d, 4> q = {a[i], b[(j + 2) % 3], a[(i + 1) % 3], a[(i + 2) % 3]};
            const Vec3d n = normal_of(a).normalized();
            if (std::abs(n.dot(q[1] - q[0])) > planarity * std::sqrt(longest2(a))) return std::nullopt;
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

/// The point of a curved shape, in its own coordinates, at `at`: turns around it first (SurfaceGeometry::uv has them
/// second on a disk), then the share of the way from pole to pole, from the centre, or along the axis. `wider` is the
/// share by which the shape is scaled about its centre or axis.
Vec3d point_of(const Shape& shape, const Vec2d& at, double wider = 1) {
    const double cosine = std::cos(two_pi * at.x()), sine = std::sin(two_pi * at.x());
    if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        const double theta = std::numbers::pi * at.y();
        const Vec3d direction(std::sin(theta) * cosine, std::sin(theta) * sine, std::cos(theta));
        return sphere->center.cast<double>() +
               wider * static_cast<double>(sphere->radius) * (sphere->axes.cast<double>() * direction);
    }
    if (const auto* disk = std::get_if<Disk>(&shape))
        return disk->center.cast<double>() +
               wider * at.y() * (cosine * disk->du.cast<double>() + sine * disk->dv.cast<double>());
    const auto& cylinder = std::get<Cylinder>(shape);
    return cylinder.base.cast<double>() + at.y() * cylinder.axis.cast<double>() +
           wider * static_cast<double>(cylinder.radius) *
               (cosine * cylinder.s.cast<double>() + sine * cylinder.t.cast<double>());
}

/// Twice the area of the quadrilateral of chords over the cell from `lower` to `upper`.
double doubled_area(const Shape& shape, const Vec2d& lower, const Vec2d& upper) {
    const Vec3d across = point_of(shape, upper) - point_of(shape, lower);
    return across.cross(point_of(shape, {lower.x(), upper.y()}) - point_of(shape, {upper.x(), lower.y()})).norm();
}

}  // namespace

Vec3d Chart::position(const Vec2d& uv) const {
    if (triangle) return corners[0] + uv.x() * (corners[1] - corners[0]) + uv.y() * (corners[3] - corners[0]);
    return (1 - uv.y()) * ((1 - uv.x()) * corners[0] + uv.x() * corners[1]) +
           uv.y() * ((1 - uv.x()) * corners[3] + uv.x() * corners[2]);
}

Vec2d Chart::lengths() const {
    return {std::max((corners[1] - corners[0]).norm(), (corners[2] - corners[3]).norm()),
            std::max((corners[3] - corners[0]).norm(), (corners[2] - corners[1]).norm())};
}

Charts::Charts(const Scene& scene, double size) : scene_(scene), size_(size) {
    const auto& groups = scene.groups();
    const std::size_t shapes = groups.begin.empty() ? scene.shapes().size() : groups.begin.front();
    for (std::uint32_t shape = 0; shape < shapes; ++shape)
        add_shape(shape, no_instance);
    for (std::uint32_t i = 0; i < groups.instances.size(); ++i) {
        first_object_.push_back(objects_.size());
        const std::uint32_t group = groups.instances[i].group;
        const std::size_t end = group + 1 < groups.begin.size() ? groups.begin[group + 1] : scene.shapes().size();
        for (std::uint32_t shape = groups.begin[group]; shape < end; ++shape)
            add_shape(shape, i);
    }
    known_.clear();
}

void Charts::add_shape(std::uint32_t shape, std::uint32_t instance) {
    objects_.push_back({chart_of_.size()});
    if (const auto* mesh = std::get_if<Mesh>(&scene_.shapes()[shape])) add_mesh(*mesh, shape, instance);
    else add_curved(shape, instance);
}

std::uint32_t Charts::add(Chart chart) {
    const auto& c = chart.corners;
    const Vec3d turn =
        chart.triangle ? Vec3d((c[1] - c[0]).cross(c[3] - c[0])) : Vec3d((c[2] - c[0]).cross(c[3] - c[1]));
    double longest2 = 0, place = 0;
    Outline outline;
    for (std::size_t i = 0; i < 4; ++i) {
        longest2 = std::max({longest2, (c[i] - c[(i + 1) % 4]).squaredNorm(), (c[i] - c[(i + 2) % 4]).squaredNorm()});
        place = std::max(place, c[i].cwiseAbs().maxCoeff());
        outline[i] = {c[i].x(), c[i].y(), c[i].z()};
    }
    if (!(turn.norm() > least_shape * longest2) || !(longest2 > sqr(least_resolution * place))) return no_chart;
    chart.reversed = turn.dot(surface_at(chart, inside).ng.cast<double>()) < 0;
    std::sort(outline.begin(), outline.end());
    const auto number = static_cast<std::uint32_t>(charts_.size());
    const auto [twin, is_new] = known_.try_emplace(outline, number);
    if (is_new) {
        charts_.push_back(chart);
        return number;
    }
    const bool faces_the_same_way =
        surface_at(chart, inside).ng.dot(surface_at(charts_[twin->second], inside).ng) > 0.f;
    return faces_the_same_way ? twin->second : no_chart;
}

void Charts::add_mesh(const Mesh& mesh, std::uint32_t shape, std::uint32_t instance) {
    const std::size_t count = mesh.triangles.size();
    const auto corners = [&](std::size_t i) {
        const auto& t = mesh.triangles[i];
        const auto at = [&](std::size_t k) { return to_scene(mesh.vertex(t[k]).cast<double>(), instance); };
        return TriangleCorners{at(0), at(1), at(2)};
    };
    for (std::size_t i = 0; i < count; ++i) {
        const TriangleCorners here = corners(i);
        const auto number = static_cast<std::uint32_t>(i);
        Chart chart{.shape = shape, .instance = instance, .primitive = number, .second = number, .triangle = true};
        chart.corners = {here[0], here[1], here[2], here[2]};
        const auto quad = i + 1 < count ? quad_of(here, corners(i + 1)) : std::nullopt;
        if (quad) {
            chart.triangle = false;
            chart.corners = *quad;
            chart.second = number + 1;
            ++i;
        }
        chart_of_.resize(chart_of_.size() + (quad ? 2 : 1), add(chart));
    }
}

void Charts::add_curved(std::uint32_t shape, std::uint32_t instance) {
    const Shape& s = scene_.shapes()[shape];
    // The lengths of the longest lines around and along the shape, of chords.
    Vec2d length = Vec2d::Zero();
    constexpr int chords = 32;
    for (const double across : {0.0, 0.25, 0.5, 1.0}) {
        Vec2d sum = Vec2d::Zero();
        const auto at = [&](double around, double along) { return to_scene(point_of(s, {around, along}), instance); };
        for (int i = 0; i < chords; ++i) {
            const double from = static_cast<double>(i) / chords, to = static_cast<double>(i + 1) / chords;
            sum += Vec2d((at(to, across) - at(from, across)).norm(), (at(across, to) - at(across, from)).norm());
        }
        length = length.cwiseMax(sum);
    }
    const auto pieces = [&](double whole, std::uint32_t least) {
        return std::max(least, static_cast<std::uint32_t>(std::clamp(std::ceil(whole / size_), 1.0, most_pieces)));
    };
    Object& object = objects_.back();
    object.around = pieces(length.x(), least_around);
    object.along = pieces(length.y(), std::holds_alternative<Sphere>(s) ? least_along : 1);
    const auto at = [&](std::uint32_t i, std::uint32_t k) {
        return Vec2d(static_cast<double>(i) / object.around, static_cast<double>(k) / object.along);
    };
    // Chords cut off a part of a convex shape. The polyhedron is scaled until it has the area of the shape.
    double area = 0;
    for (std::uint32_t k = 0; k < object.along; ++k)
        area += 0.5 * object.around * doubled_area(s, at(0, k), at(1, k + 1));
    const double share = area > 0 ? area_of(s) / area : 1;
    const double wider = std::holds_alternative<Cylinder>(s) ? share : std::sqrt(share);
    for (std::uint32_t k = 0; k < object.along; ++k)
        for (std::uint32_t i = 0; i < object.around; ++i) {
            Chart chart{.shape = shape, .instance = instance, .curved = true};
            chart.lower = at(i, k);
            chart.upper = at(i + 1, k + 1);
            const auto corner = [&](std::uint32_t a, std::uint32_t b) {
                return to_scene(point_of(s, at(a % object.around, b), wider), instance);
            };
            chart.corners = {corner(i, k), corner(i + 1, k), corner(i + 1, k + 1), corner(i, k + 1)};
            chart_of_.push_back(add(chart));
        }
}

Vec3d Charts::to_scene(const Vec3d& p, std::uint32_t instance) const {
    if (instance == no_instance) return p;
    const Instance& i = scene_.instances()[instance];
    return i.linear * p + i.translation;
}

SurfaceHit Charts::surface_at(const Chart& chart, const Vec2d& uv) const {
    const Shape& shape = scene_.shapes()[chart.shape];
    Vec3d p = chart.position(uv);
    Intersection at{
        .shape = chart.shape, .primitive = chart.primitive, .instance = chart.instance, .u = 0.f, .t = 0.f, .v = 0.f};
    if (chart.curved) {
        p = to_scene(point_of(shape, chart.lower + uv.cwiseProduct(chart.upper - chart.lower)), chart.instance);
    } else {
        const auto& mesh = std::get<Mesh>(shape);
        const auto place = [&](std::uint32_t primitive) {
            const auto& t = mesh.triangles[primitive];
            const auto corner = [&](std::size_t k) {
                return to_scene(mesh.vertex(t[k]).cast<double>(), chart.instance);
            };
            return barycentric(corner(0), corner(1) - corner(0), corner(2) - corner(0), p);
        };
        const auto outside = [](const Vec2d& b) { return std::max({-b.x(), -b.y(), b.x() + b.y() - 1}); };
        Vec2d b = place(chart.primitive);
        if (outside(b) > 0) {
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

std::optional<Charts::Place> Charts::locate(const SurfaceHit& hit) const {
    const bool own = hit.instance == no_instance;
    const Object& object =
        objects_[own ? hit.shape
                     : first_object_[hit.instance] +
                           (hit.shape - scene_.groups().begin[scene_.instances()[hit.instance].group])];
    if (object.around > 0) {
        const Shape& shape = scene_.shapes()[hit.shape];
        const Vec3 p = own ? hit.p : carried_to_group(scene_.instances()[hit.instance], {hit.p, Vec3::UnitZ()}).o;
        const bool disk = std::holds_alternative<Disk>(shape);
        const Vec2d uv = surface_at_analytic(shape, p).uv.cast<double>(), at = disk ? Vec2d(uv.y(), uv.x()) : uv;
        const Vec2d pieces(object.around, object.along), scaled = at.cwiseProduct(pieces);
        const Vec2d cell = scaled.array().floor().max(0.0).min(pieces.array() - 1).matrix();
        const auto number = static_cast<std::size_t>(cell.y() * pieces.x() + cell.x());
        const std::uint32_t chart = chart_of_[object.first + number];
        if (chart == no_chart) return std::nullopt;
        return Place{chart, (scaled - cell).cwiseMax(0.0).cwiseMin(1.0)};
    }
    const std::uint32_t chart = chart_of_[object.first + hit.primitive];
    if (chart == no_chart) return std::nullopt;
    const Vec3d p = hit.p.cast<double>();
    if (!charts_[chart].triangle) return Place{chart, bilinear_place(charts_[chart], p)};
    const auto& c = charts_[chart].corners;
    Vec2d uv = barycentric(c[0], c[1] - c[0], c[3] - c[0], p).cwiseMax(0.0);
    if (uv.sum() > 1) uv /= uv.sum();
    return Place{chart, uv};
}

}  // namespace gib
