// Derivatives of a surface's points with respect to uv, for bump maps and texture frames. They are computed on
// demand, because most hits do not need them.

#include "common/shapes/shape.h"

namespace gib {

namespace {

/// A radius of 0 is replaced by this one, so that the derivative keeps its direction. It is far below any
/// derivative that matters.
constexpr float least_radius = 1e-6f;

struct Circle {
    float radius, cos_phi, sin_phi;
};

/// (x, y) in polar coordinates; the angle at the centre is 0, as atan2(0, 0) is.
Circle circle_through(float x, float y) {
    const float r = std::sqrt(x * x + y * y);
    return r > 0.f ? Circle{r, x / r, y / r} : Circle{0.f, 1.f, 0.f};
}

/// An orthonormal basis of the tangent plane. `normal` is the normal before flip_normals, with which Mitsuba's basis
/// does not turn.
SurfaceDerivatives tangent_basis(const Vec3& normal) {
    const Frame frame(normal);
    return {frame.s, frame.t};
}

/// Each edge is dp_du times its difference in u plus dp_dv times its difference in v. This system of two equations is
/// solved in double, because uv may be any numbers.
SurfaceDerivatives derivatives_of(const Mesh& mesh, std::uint32_t triangle, const SurfaceGeometry& at) {
    const auto fallback = [&] { return tangent_basis(mesh.flip_normals ? Vec3(-at.ng) : at.ng); };
    if (mesh.uvs.empty()) return fallback();
    const auto& t = mesh.triangles[triangle];
    const Vec2d uv0 = mesh.uvs[t[0]].cast<double>();
    const Vec2d a = mesh.uvs[t[1]].cast<double>() - uv0, b = mesh.uvs[t[2]].cast<double>() - uv0;
    const double determinant = a.x() * b.y() - a.y() * b.x();
    if (determinant == 0) return fallback();
    const Vec3d v0 = mesh.vertex(t[0]).cast<double>();
    const Vec3d e1 = mesh.vertex(t[1]).cast<double>() - v0, e2 = mesh.vertex(t[2]).cast<double>() - v0;
    const SurfaceDerivatives d{((b.y() * e1 - a.y() * e2) / determinant).cast<float>(),
                               ((a.x() * e2 - b.x() * e1) / determinant).cast<float>()};
    return d.dp_du.array().isFinite().all() && d.dp_dv.array().isFinite().all() ? d : fallback();
}

SurfaceDerivatives derivatives_of(const Sphere& sphere, std::uint32_t, const SurfaceGeometry& at) {
    const Vec3 d = sphere.axes.transpose() * (sphere.flip_normals ? Vec3(-at.ng) : at.ng);
    const Circle parallel = circle_through(d.x(), d.y());
    const Vec3 east(-parallel.sin_phi, parallel.cos_phi, 0.f);
    const Vec3 south(d.z() * parallel.cos_phi, d.z() * parallel.sin_phi, -parallel.radius);
    return {2.f * pi * sphere.radius * std::max(parallel.radius, least_radius) * (sphere.axes * east),
            pi * sphere.radius * (sphere.axes * south)};
}

/// u is the distance from the centre in units of the disk's radius, v the angle in turns.
SurfaceDerivatives derivatives_of(const Disk& disk, std::uint32_t, const SurfaceGeometry& at) {
    const float phi = 2.f * pi * at.uv.y(), c = std::cos(phi), s = std::sin(phi);
    return {c * disk.du + s * disk.dv, 2.f * pi * std::max(at.uv.x(), least_radius) * (c * disk.dv - s * disk.du)};
}

/// u is the angle in turns.
SurfaceDerivatives derivatives_of(const Cylinder& cylinder, std::uint32_t, const SurfaceGeometry& at) {
    const Vec3 normal = cylinder.flip_normals ? Vec3(-at.ng) : at.ng;
    const Vec3 around = normal.dot(cylinder.s) * cylinder.t - normal.dot(cylinder.t) * cylinder.s;
    return {2.f * pi * cylinder.radius * around, cylinder.axis};
}

/// n = m / |m| with the sum m of the vertex normals by barycentric weights, so that dn = (I - n n^T) dm / |m|. The weights of
/// the second and third vertex change by g1.dp and g2.dp, where g1 and g2 are the dual basis of the edges.
Eigen::Matrix3d normal_derivative_of(const Mesh& mesh, std::uint32_t triangle, const SurfaceGeometry& at) {
    if (mesh.normals.empty()) return Eigen::Matrix3d::Zero();
    const auto& t = mesh.triangles[triangle];
    const Vec3d v0 = mesh.vertex(t[0]).cast<double>(), n0 = mesh.normals[t[0]].cast<double>();
    const Vec3d e1 = mesh.vertex(t[1]).cast<double>() - v0, e2 = mesh.vertex(t[2]).cast<double>() - v0;
    const Vec3d d1 = mesh.normals[t[1]].cast<double>() - n0, d2 = mesh.normals[t[2]].cast<double>() - n0;
    const Vec3d across = e1.cross(e2), m = n0 + double{at.weights.x()} * d1 + double{at.weights.y()} * d2;
    const double length = m.norm(), area2 = across.squaredNorm();
    if (!(length > 0 && area2 > 0)) return Eigen::Matrix3d::Zero();
    const Vec3d n = m / length, g1 = e2.cross(across) / area2, g2 = across.cross(e1) / area2;
    const Eigen::Matrix3d dm = d1 * g1.transpose() + d2 * g2.transpose();
    return (dm - n * (n.transpose() * dm)) * ((mesh.flip_normals ? -1 : 1) / length);
}

/// On a sphere n = (p - center) / radius.
Eigen::Matrix3d normal_derivative_of(const Sphere& sphere, std::uint32_t, const SurfaceGeometry&) {
    return Eigen::Matrix3d::Identity() * ((sphere.flip_normals ? -1 : 1) / double{sphere.radius});
}

Eigen::Matrix3d normal_derivative_of(const Disk&, std::uint32_t, const SurfaceGeometry&) {
    return Eigen::Matrix3d::Zero();
}

/// The same as on a sphere, but steps along the axis change nothing.
Eigen::Matrix3d normal_derivative_of(const Cylinder& cylinder, std::uint32_t, const SurfaceGeometry&) {
    const Vec3d s = cylinder.s.cast<double>(), t = cylinder.t.cast<double>();
    return (s * s.transpose() + t * t.transpose()) * ((cylinder.flip_normals ? -1 : 1) / double{cylinder.radius});
}

}  // namespace

Eigen::Matrix3d normal_derivative(const Shape& shape, std::uint32_t primitive, const SurfaceGeometry& at) {
    return std::visit([&](const auto& s) { return normal_derivative_of(s, primitive, at); }, shape);
}

SurfaceDerivatives derivatives_at(const Shape& shape, std::uint32_t primitive, const SurfaceGeometry& at) {
    return std::visit([&](const auto& s) { return derivatives_of(s, primitive, at); }, shape);
}

}  // namespace gib
