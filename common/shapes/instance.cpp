#include "common/shapes/instance.h"

namespace gib {

std::optional<Instance> make_instance(std::uint32_t group, const Mat4d& to_scene) {
    Instance result;
    result.group = group;
    result.linear = to_scene.topLeftCorner<3, 3>();
    result.translation = to_scene.topRightCorner<3, 1>();
    result.inverse = result.linear.inverse();
    constexpr double largest = 1e12;
    const bool sound = result.translation.array().isFinite().all() && result.linear.cwiseAbs().maxCoeff() <= largest &&
                       result.inverse.array().isFinite().all() && result.inverse.cwiseAbs().maxCoeff() <= largest;
    return sound ? std::optional(result) : std::nullopt;
}

Bounds transformed(const Instance& instance, const Bounds& in_group) {
    Bounds bounds;
    if (in_group.empty()) return bounds;
    const Vec3d lower = in_group.lower.cast<double>(), upper = in_group.upper.cast<double>();
    const Vec3d center = instance.linear * (0.5 * (lower + upper)) + instance.translation;
    const Vec3d extent = instance.linear.cwiseAbs() * (0.5 * (upper - lower));
    bounds.add(Vec3((center - extent).cast<float>()));
    bounds.add(Vec3((center + extent).cast<float>()));
    return bounds;
}

Ray carried_to_group(const Instance& instance, const Ray& ray) {
    return {.o = (instance.inverse * (ray.o.cast<double>() - instance.translation)).cast<float>(),
            .d = (instance.inverse * ray.d.cast<double>()).cast<float>(),
            .t_min = ray.t_min,
            .t_max = ray.t_max};
}

SurfaceGeometry carried_to_scene(const Instance& instance, const SurfaceGeometry& in_group) {
    SurfaceGeometry s;
    s.p = (instance.linear * in_group.p.cast<double>() + instance.translation).cast<float>();
    const Vec3d n = instance.inverse.transpose() * in_group.ng.cast<double>();
    const double length = n.norm();
    s.ng = (n / length).cast<float>();
    s.ns = (instance.inverse.transpose() * in_group.ns.cast<double>()).normalized().cast<float>();
    s.uv = in_group.uv;
    s.primitive = in_group.primitive;
    s.weights = in_group.weights;
    // The offset is the sum of two bounds, each the distance of two parallel planes. The first is the group's offset,
    // which covers the rounding of p and of a ray's start in the group; the map divides such distances by `length`.
    // The second covers the rounding of p and of a ray's start in the scene.
    s.offset = static_cast<float>(static_cast<double>(in_group.offset) / length) +
               8.f * unit_roundoff * s.ng.cwiseAbs().dot(s.p.cwiseAbs());
    return s;
}

SurfaceDerivatives derivatives_at(const Instance& instance, const Shape& shape, std::uint32_t primitive,
                                  const SurfaceGeometry& in_scene) {
    SurfaceGeometry in_group = in_scene;
    in_group.ng = (instance.linear.transpose() * in_scene.ng.cast<double>()).normalized().cast<float>();
    const SurfaceDerivatives d = derivatives_at(shape, primitive, in_group);
    return {(instance.linear * d.dp_du.cast<double>()).cast<float>(),
            (instance.linear * d.dp_dv.cast<double>()).cast<float>()};
}

/// With the map A and n' = A^-T n / |A^-T n|, dn' = (I - n' n'^T) A^-T dn / |A^-T n|.
Eigen::Matrix3d normal_derivative(const Instance& instance, const Shape& shape, std::uint32_t primitive,
                                  const SurfaceGeometry& in_scene) {
    const Vec3d n = in_scene.ns.cast<double>();
    const Vec3d in_group = (instance.linear.transpose() * n).normalized();
    const double length = (instance.inverse.transpose() * in_group).norm();
    const Eigen::Matrix3d change =
        instance.inverse.transpose() * normal_derivative(shape, primitive, in_scene) * instance.inverse / length;
    return change - n * (n.transpose() * change);
}

}  // namespace gib
