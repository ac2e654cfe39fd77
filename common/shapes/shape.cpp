#include "common/shapes/shape.h"

#include "common/core/memory_limit.h"
#include "common/core/parallel.h"

#include <fmt/format.h>

namespace gib {

namespace {

/// Bound of the relative error of n rounded operations in a row (Higham 2002, lemma 3.1).
constexpr float gamma(int n) {
    return static_cast<float>(n) * unit_roundoff / (1.f - static_cast<float>(n) * unit_roundoff);
}

/// A point in a coordinate plane through the origin has no rounding error, but a ray that starts there would hit the
/// shape at distance 0. This fraction of the shape's size moves the start off the plane.
constexpr float off_the_plane = 0x1p-33f;

struct Triangle {
    Vec3 v0, e1, e2;  ///< the first vertex and the edges from it to the second and third
};

Triangle triangle_of(const Mesh& mesh, std::size_t i) {
    const auto& t = mesh.triangles[i];
    const Vec3 v0 = mesh.vertex(t[0]);
    return {v0, mesh.vertex(t[1]) - v0, mesh.vertex(t[2]) - v0};
}

/// e1 x e2 of the exact edges. It is computed in double, because the edges of a needle are nearly parallel, so that
/// the products cancel, and because the products of a small triangle underflow in float.
Vec3d product_of_edges(const Mesh& mesh, std::size_t i) {
    const auto& t = mesh.triangles[i];
    const Vec3d v0 = mesh.vertex(t[0]).cast<double>();
    return (mesh.vertex(t[1]).cast<double>() - v0).cross(mesh.vertex(t[2]).cast<double>() - v0);
}

double area_of_triangle(const Mesh& mesh, std::size_t i) { return 0.5 * mesh.normal_of(i).norm(); }

SurfacePoint point_on_disk(const Disk& disk, float a, float b) {
    SurfacePoint s;
    s.p = disk.center + a * disk.du + b * disk.dv;
    s.ng = disk.normal;
    const Vec3 extent = disk.du.cwiseAbs() + disk.dv.cwiseAbs();
    s.offset = gamma(8) * s.ng.cwiseAbs().dot(disk.center.cwiseAbs() + extent) + off_the_plane * extent.sum();
    return s;
}

/// The point in the direction `normal` from the axis, at the fraction `v` of the axis's length. The offset only has
/// to bound the rounding of p along `normal`: that of the sums and of the unit vector's length.
SurfacePoint point_on_cylinder(const Cylinder& cylinder, const Vec3& normal, float v) {
    SurfacePoint s;
    s.p = cylinder.base + v * cylinder.axis + cylinder.radius * normal;
    s.ng = (cylinder.flip_normals ? -1.f : 1.f) * normal;
    const Vec3 along = cylinder.base.cwiseAbs() + cylinder.axis.cwiseAbs();
    s.offset = gamma(8) * normal.cwiseAbs().dot(along) + gamma(16) * cylinder.radius;
    return s;
}

/// The angle of (x, y) in full turns, from 0 to 1.
float turns(float x, float y) {
    const float phi = std::atan2(y, x);
    return (phi < 0.f ? phi + 2.f * pi : phi) / (2.f * pi);
}

const Vec2 no_uv = Vec2::Zero();

/// Projects `p_ray` onto the cylinder. It does so in double, because the axis may be many times longer
/// than the radius.
SurfaceGeometry surface_of_cylinder(const Cylinder& cylinder, const Vec3& p_ray, bool with_uv) {
    const Vec3d axis = cylinder.axis.cast<double>(), d = p_ray.cast<double>() - cylinder.base.cast<double>();
    const double v = d.dot(axis) / axis.squaredNorm();
    const Vec3d across = d - v * axis;
    const double length = across.norm();
    const Vec3 n = length > 0 ? Vec3((across / length).cast<float>()) : cylinder.s;
    const float height = std::clamp(static_cast<float>(v), 0.f, 1.f);
    const SurfacePoint s = point_on_cylinder(cylinder, n, height);
    return {s, s.ng, with_uv ? Vec2(turns(n.dot(cylinder.s), n.dot(cylinder.t)), height) : no_uv};
}

struct Roots {
    double near, far;
};

// Eigen computes two coordinates at once and waits until these are together in memory.
Vec3d to_double(const Vec3& v) { return {double{v.x()}, double{v.y()}, double{v.z()}}; }
double dot(const Vec3d& a, const Vec3d& b) { return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z(); }

/// The values of t at which |f + t d|^2 = r2, in the form of Haines et al. 2019, which does not cancel. Empty if
/// there are none, and also if d = 0.
std::optional<Roots> meet(const Vec3d& f, const Vec3d& d, double r2) {
    const double a = dot(d, d), b = -dot(f, d);
    if (a == 0) return std::nullopt;
    const double per_a = 1 / a;
    const Vec3d nearest = f + (b * per_a) * d;
    const double discriminant = r2 - dot(nearest, nearest);
    if (!(discriminant >= 0)) return std::nullopt;
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    // One root, q / a, does not cancel; the other is the product of the roots divided by it. q is 0 if the line
    // touches at its origin, where both roots are 0.
    const double first = q == 0 ? 0 : (dot(f, f) - r2) / q, second = q * per_a;
    return first > second ? Roots{second, first} : Roots{first, second};
}

bool within(const Ray& ray, double t) {
    return t > static_cast<double>(ray.t_min) && t < static_cast<double>(ray.t_max);
}

}  // namespace

Vec2 Sphere::uv_at(const Vec3& direction) const {
    // An arc cosine would lose half of the digits near a pole.
    const Vec3 d = axes.transpose() * direction;
    return {turns(d.x(), d.y()), std::atan2(std::sqrt(sqr(d.x()) + sqr(d.y())), d.z()) / pi};
}

void Mesh::prepare() {
    require_memory(static_cast<double>(triangles.size()) * sizeof(Facet),
                   fmt::format("a mesh of {} triangles", triangles.size()));
    facets.resize(triangles.size());
    parallel_blocks(triangles.size(), 1 << 14, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i)
            facets[i] = facet_of(i);
    });
}

/// The offset of the triangle's points is the sum of two bounds of distances along the normal. Each is formed
/// component by component, so that a floor in a coordinate plane needs next to no offset, whatever its size. The
/// first bounds the rounding of p, which is no further out than the vertices. The second bounds the error of a
/// ray-triangle test for a ray that starts at p. The test forms (v0 - p) . n, where |v0 - p| <= |e1| + |e2|, and
/// each component of n has the rounding error of the products that it is the sum of; `m` is the sum of their
/// magnitudes (Higham 2002, section 3.1). The division by |n| makes the second bound large for needles, whose
/// normal is uncertain.
Mesh::Facet Mesh::facet_of(std::size_t i) const {
    const Triangle t = triangle_of(*this, i);
    Vec3d n = product_of_edges(*this, i);
    // Ray queries use the rounded edges, whose triangle may have an area although that of the exact edges has none.
    if (n.isZero(0)) n = t.e1.cast<double>().cross(t.e2.cast<double>());
    const double length = n.norm();
    // A triangle without an area has no normal, and no ray finds it.
    const double scale = length > 0 ? 1 / length : std::numeric_limits<double>::quiet_NaN();
    const Vec3 ng = (scale * n).cast<float>();
    const Vec3d a1 = t.e1.cwiseAbs().cast<double>(), a2 = t.e2.cwiseAbs().cast<double>();
    const Vec3d m(a1.y() * a2.z() + a1.z() * a2.y(), a1.z() * a2.x() + a1.x() * a2.z(),
                  a1.x() * a2.y() + a1.y() * a2.x());
    const Vec3 furthest = t.v0.cwiseAbs().cwiseMax((t.v0 + t.e1).cwiseAbs()).cwiseMax((t.v0 + t.e2).cwiseAbs());
    const float of_point = gamma(8) * ng.cwiseAbs().dot(furthest);
    const float of_query =
        gamma(16) * static_cast<float>(scale * (a1 + a2).dot(m)) + off_the_plane * static_cast<float>((a1 + a2).sum());
    // Points keep a distance of `off_edges` from each edge, a bound of the rounding of p in any direction; the least
    // weight of a vertex is this distance over the vertex's height. But no point is moved by more than about eight
    // times this distance: to keep off the long edges of a needle, it would have to move far along them. Lengths are
    // in double, because the squares of lengths below 1e-23 underflow in float.
    const Vec3 e3 = t.e2 - t.e1;
    const auto length_of = [](const Vec3& v) { return v.cast<double>().norm(); };
    const double off_edges = static_cast<double>(gamma(4)) * length_of(furthest);
    const double longest = std::max({length_of(t.e1), length_of(t.e2), length_of(e3)});
    const double most = length > 0 ? std::min(0.25, 8 * off_edges / longest) : 0.;
    const auto least = [&](const Vec3& edge) {
        return most > 0 ? static_cast<float>(std::min(most, off_edges / length * length_of(edge))) : 0.f;
    };
    const auto four = [](const Vec3& v, float last) { return Facet::Four{v.x(), v.y(), v.z(), last}; };
    return {.v0 = four(t.v0, of_point + of_query),
            .e1 = four(t.e1, least(t.e2)),
            .e2 = four(t.e2, least(t.e1)),
            .ng = four(flip_normals ? Vec3(-ng) : ng, least(e3))};
}

void Mesh::Facet::keep_off_edges(float& b1, float& b2) const {
    const float least1 = e1[3], least2 = e2[3], room = 1.f - least1 - least2 - ng[3];
    float more1 = std::max(0.f, b1 - least1), more2 = std::max(0.f, b2 - least2);
    const float more = more1 + more2;
    if (more > room) {
        more1 *= room / more;
        more2 *= room / more;
    }
    b1 = least1 + more1;
    b2 = least2 + more2;
}

Vec3 Mesh::interpolated_normal(std::size_t i, float b1, float b2) const {
    const auto& t = triangles[i];
    const Vec3 ns = (1.f - b1 - b2) * normals[t[0]] + b1 * normals[t[1]] + b2 * normals[t[2]];
    const float length = ns.norm();
    return length > 0.f ? Vec3(ns * ((flip_normals ? -1.f : 1.f) / length)) : Vec3(Vec3::Zero());
}

Vec3d Mesh::normal_of(std::size_t i) const {
    const Vec3d n = product_of_edges(*this, i);
    return flip_normals ? Vec3d(-n) : n;
}

Bounds bounds_of(const Shape& shape) {
    Bounds b;
    if (const auto* mesh = std::get_if<Mesh>(&shape)) {
        for (const auto& t : mesh->triangles)
            for (std::uint32_t i : t)
                b.add(mesh->vertex(i));
    } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        b.add(sphere->center - Vec3::Constant(sphere->radius));
        b.add(sphere->center + Vec3::Constant(sphere->radius));
    } else if (const auto* disk = std::get_if<Disk>(&shape)) {
        const Vec3 extent = (disk->du.cwiseAbs2() + disk->dv.cwiseAbs2()).cwiseSqrt();
        b.add(disk->center - extent);
        b.add(disk->center + extent);
    } else {
        const auto& cylinder = std::get<Cylinder>(shape);
        const Vec3 extent = cylinder.radius * (cylinder.s.cwiseAbs2() + cylinder.t.cwiseAbs2()).cwiseSqrt();
        for (const Vec3& end : {cylinder.base, Vec3(cylinder.base + cylinder.axis)}) {
            b.add(end - extent);
            b.add(end + extent);
        }
    }
    return b;
}

double area_of(const Shape& shape) {
    if (const auto* mesh = std::get_if<Mesh>(&shape)) {
        double area = 0;
        for (std::size_t i = 0; i < mesh->triangles.size(); ++i)
            area += area_of_triangle(*mesh, i);
        return area;
    }
    if (const auto* sphere = std::get_if<Sphere>(&shape))
        return 4.0 * std::numbers::pi * sqr(static_cast<double>(sphere->radius));
    if (const auto* disk = std::get_if<Disk>(&shape))
        return std::numbers::pi * disk->du.cast<double>().norm() * disk->dv.cast<double>().norm();
    const auto& cylinder = std::get<Cylinder>(shape);
    return 2.0 * std::numbers::pi * static_cast<double>(cylinder.radius) * cylinder.axis.cast<double>().norm();
}

bool has_smooth_normals(const Shape& shape) {
    const auto* mesh = std::get_if<Mesh>(&shape);
    return mesh && !mesh->normals.empty();
}

SurfaceGeometry surface_at_analytic(const Shape& shape, const Vec3& p_ray, bool with_uv) {
    if (const auto* sphere = std::get_if<Sphere>(&shape)) {
        const Vec3 direction = sphere->direction_to(p_ray);
        const SurfacePoint s = sphere->point_at(direction);
        return {s, s.ng, with_uv ? sphere->uv_at(direction) : no_uv};
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return surface_of_cylinder(*cylinder, p_ray, with_uv);
    const auto& disk = std::get<Disk>(shape);
    const Vec3 d = p_ray - disk.center;
    const float a = d.dot(disk.du) / disk.du.squaredNorm(), b = d.dot(disk.dv) / disk.dv.squaredNorm();
    const SurfacePoint s = point_on_disk(disk, a, b);
    return {s, s.ng, with_uv ? Vec2(std::sqrt(a * a + b * b), turns(a, b)) : no_uv};
}

std::optional<float> intersect(const Sphere& sphere, const Ray& ray) {
    const auto roots = meet(to_double(ray.o) - to_double(sphere.center), to_double(ray.d), sqr(double{sphere.radius}));
    if (!roots) return std::nullopt;
    const double t = roots->near > static_cast<double>(ray.t_min) ? roots->near : roots->far;
    if (!within(ray, t)) return std::nullopt;
    return static_cast<float>(t);
}

std::optional<float> intersect(const Disk& disk, const Ray& ray) {
    const Vec3d n = disk.du.cast<double>().cross(disk.dv.cast<double>());
    const Vec3d d = ray.d.cast<double>(), f = disk.center.cast<double>() - ray.o.cast<double>();
    const double denominator = n.dot(d);
    if (denominator == 0) return std::nullopt;
    const double t = n.dot(f) / denominator;
    if (!within(ray, t)) return std::nullopt;
    const Vec3d p = t * d - f;
    const double a = p.dot(disk.du.cast<double>()) / disk.du.cast<double>().squaredNorm();
    const double b = p.dot(disk.dv.cast<double>()) / disk.dv.cast<double>().squaredNorm();
    if (a * a + b * b > 1) return std::nullopt;
    return static_cast<float>(t);
}

std::optional<float> intersect(const Cylinder& cylinder, const Ray& ray) {
    const Vec3d axis = cylinder.axis.cast<double>(), d = ray.d.cast<double>();
    const Vec3d f = ray.o.cast<double>() - cylinder.base.cast<double>();
    const double dv = d.dot(axis) / axis.squaredNorm(), v = f.dot(axis) / axis.squaredNorm();
    const auto roots = meet(f - v * axis, d - dv * axis, sqr(static_cast<double>(cylinder.radius)));
    if (!roots) return std::nullopt;
    for (const double t : {roots->near, roots->far})
        if (within(ray, t) && v + t * dv >= 0 && v + t * dv <= 1) return static_cast<float>(t);
    return std::nullopt;
}

AreaSampler::AreaSampler(const Shape& shape) : area_(static_cast<float>(area_of(shape))) {
    if (const auto* mesh = std::get_if<Mesh>(&shape)) {
        std::vector<double> areas;
        for (std::size_t i = 0; i < mesh->triangles.size(); ++i)
            areas.push_back(area_of_triangle(*mesh, i));
        triangles_ = DiscreteDistribution(areas);
        if (!mesh->facets.empty()) facets_ = mesh->facets.data();
    }
}

SurfacePoint AreaSampler::sample(const Shape& shape, const Vec2& u) const {
    if (const auto* mesh = std::get_if<Mesh>(&shape)) {
        const MeshSample at = sample_mesh(u);
        return mesh->point_at(at.triangle, at.b.x(), at.b.y());
    }
    if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->point_at(square_to_sphere(u));
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
        const float phi = 2.f * pi * u.y();
        return point_on_cylinder(*cylinder, std::cos(phi) * cylinder->s + std::sin(phi) * cylinder->t, u.x());
    }
    const Vec2 d = square_to_disk(u);
    return point_on_disk(std::get<Disk>(shape), d.x(), d.y());
}

SurfaceGeometry AreaSampler::sample_geometry(const Shape& shape, const Vec2& u) const {
    const auto* mesh = std::get_if<Mesh>(&shape);
    if (!mesh) return surface_at(shape, 0, 0, 0, sample(shape, u).p);
    const MeshSample at = sample_mesh(u);
    return mesh->surface_at(at.triangle, at.b.x(), at.b.y());
}

}  // namespace gib
