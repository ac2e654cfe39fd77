#include "common/light.h"

namespace gib {

namespace {

/// The directions from p to a sphere that it lies outside of.
struct SphereCone {
    Vec3 axis;
    float distance;  ///< to the centre
    float one_minus_cos_max;
};

std::optional<SphereCone> cone_to_sphere(const Sphere& sphere, const Vec3& p) {
    const Vec3 to_center = sphere.center - p;
    const float d2 = to_center.squaredNorm(), r2 = sqr(sphere.radius);
    // Inside or on the sphere there is no cone; a margin keeps the division below well conditioned.
    if (d2 <= r2 * 1.0001f) return std::nullopt;
    const float d = std::sqrt(d2), sin2 = r2 / d2;
    // 1 - cos = sin^2 / (1 + cos), which does not cancel for a distant sphere.
    return SphereCone{to_center / d, d, sin2 / (1.f + safe_sqrt(1.f - sin2))};
}

/// Emission is outwards only: a flipped sphere emits inwards and is sampled by area.
std::optional<SphereCone> emitting_cone(const Shape& shape, const Vec3& p) {
    const auto* sphere = std::get_if<Sphere>(&shape);
    return sphere && !sphere->flip_normals ? cone_to_sphere(*sphere, p) : std::nullopt;
}

std::optional<LightSample> sample_cone(const AreaLight& light, const Sphere& sphere, const SphereCone& cone,
                                       const Vec3& p, const Vec2& u) {
    const Vec3 w = square_to_cone(u, cone.one_minus_cos_max);
    const Vec3 wi = Frame(cone.axis).to_world(w);
    // The near intersection along wi; rays at the rim touch.
    const float sin2 = std::max(1.f - w.z() * w.z(), 0.f);
    const float t = cone.distance * w.z() - safe_sqrt(sqr(sphere.radius) - sqr(cone.distance) * sin2);
    const SurfacePoint q = surface_at(sphere, 0, 0, 0, p + t * wi);
    return LightSample{
        wi, t, light.radiance, 1.f / (2.f * pi * cone.one_minus_cos_max), false, shadow_ray_target(q, p)};
}

struct LightSampler {
    const std::vector<Shape>& shapes;
    const Vec3& p;
    const Vec2& u;

    std::optional<LightSample> operator()(const PointLight& light) const {
        const Vec3 to_light = light.position - p;
        const float d2 = to_light.squaredNorm(), d = std::sqrt(d2);
        if (!(d2 > 0.f)) return std::nullopt;
        return LightSample{to_light / d, d, light.intensity / d2, 1.f, true, light.position};
    }

    std::optional<LightSample> operator()(const AreaLight& light) const {
        const Shape& shape = shapes[light.shape];
        if (const auto cone = emitting_cone(shape, p)) return sample_cone(light, std::get<Sphere>(shape), *cone, p, u);
        const SurfacePoint q = light.surface.sample(shape, u);
        const Vec3 to_light = q.p - p;
        const float d2 = to_light.squaredNorm(), d = std::sqrt(d2);
        const Vec3 wi = to_light / d;
        const float cos_light = -wi.dot(q.ng);
        if (!(cos_light > 0.f)) return std::nullopt;
        return LightSample{
            wi, d, light.radiance, d2 / (cos_light * light.surface.area()), false, shadow_ray_target(q, p)};
    }
};

}  // namespace

Colord power_of(const Light& light) {
    if (const auto* point = std::get_if<PointLight>(&light))
        return 4 * std::numbers::pi * point->intensity.cast<double>();
    const auto& area = std::get<AreaLight>(light);
    return std::numbers::pi * area.surface.area() * area.radiance.cast<double>();
}

std::optional<LightSample> sample_light(const Light& light, const std::vector<Shape>& shapes, const Vec3& p,
                                        const Vec2& u) {
    return std::visit(LightSampler{shapes, p, u}, light);
}

float light_pdf_w(const AreaLight& light, const std::vector<Shape>& shapes, const Vec3& p, const SurfacePoint& hit) {
    if (const auto cone = emitting_cone(shapes[light.shape], p)) return 1.f / (2.f * pi * cone->one_minus_cos_max);
    const Vec3 to_light = hit.p - p;
    const float d2 = to_light.squaredNorm();
    const float cos_light = -to_light.dot(hit.ng) / std::sqrt(d2);
    return cos_light > 0.f ? d2 / (cos_light * light.surface.area()) : 0.f;
}

EmissionSample sample_emission(const Light& light, const std::vector<Shape>& shapes, const Vec2& u_position,
                               const Vec2& u_direction) {
    if (const auto* point = std::get_if<PointLight>(&light))
        return {Ray{point->position, square_to_sphere(u_direction)}, 4.f * pi * point->intensity, Vec3::Zero()};
    const auto& area = std::get<AreaLight>(light);
    const SurfacePoint q = area.surface.sample(shapes[area.shape], u_position);
    // Uniform on the surface and cosine-weighted: Le cos / (pdf_a pdf_w) = Le A pi for every sample.
    const Vec3 w = Frame(q.ng).to_world(square_to_cosine_hemisphere(u_direction));
    return {Ray{offset_origin(q, w), w}, pi * area.surface.area() * area.radiance, q.ng};
}

}  // namespace gib
