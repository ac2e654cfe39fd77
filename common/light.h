#pragma once
// Emitters: a closed set, sampled from a point that they light (LightSample) or as the start of a light path
// (EmissionSample).

#include "common/shape.h"

#include <optional>
#include <variant>
#include <vector>

namespace gib {

/// A surface that emits `radiance` [W/(sr m^2)] in every direction of its front side.
struct AreaLight {
    std::uint32_t shape;  ///< index into the scene's shapes
    Color radiance;
    AreaSampler surface;
};

/// `intensity` [W/sr] in every direction.
struct PointLight {
    Vec3 position;
    Color intensity;
};

using Light = std::variant<AreaLight, PointLight>;

/// A point of a light as seen from a point that it may light.
struct LightSample {
    Vec3 wi;  ///< from the lit point to the light, unit
    float distance;
    Color Le;     ///< emitted radiance towards the point; for a point light intensity / distance^2, with pdf_w = choice
    float pdf_w;  ///< [1/sr], the choice of the light included
    bool delta;   ///< no other technique can hit it
    Vec3 target;  ///< the end of the shadow ray, in front of the light's surface
};

/// The start of a light path with its share of power.
struct EmissionSample {
    Ray ray;
    Color power;  ///< emitted power / density [W]: the mean over samples is the light's power
    Vec3 normal;  ///< geometric normal at the origin; zero for a point light
};

/// [W] per channel.
Colord power_of(const Light& light);

/// Uniform over the light; over the visible cone for a sphere seen from outside. pdf_w without the choice of the light.
/// Empty where nothing is emitted towards p.
std::optional<LightSample> sample_light(const Light& light, const std::vector<Shape>& shapes, const Vec3& p,
                                        const Vec2& u);

/// Density [1/sr] with which sample_light from `p` would have found the point `hit` of the area light.
float light_pdf_w(const AreaLight& light, const std::vector<Shape>& shapes, const Vec3& p, const SurfacePoint& hit);

EmissionSample sample_emission(const Light& light, const std::vector<Shape>& shapes, const Vec2& u_position,
                               const Vec2& u_direction);

/// The origin of a ray that leaves `point` to the side of `w`.
inline Vec3 offset_origin(const SurfacePoint& point, const Vec3& w) {
    return point.p + (w.dot(point.ng) >= 0.f ? point.offset : -point.offset) * point.ng;
}

/// The end, in front of the emitting side of `light`, of a shadow ray from near `p`. Forming the ray rounds its end by up to an ulp of the larger of
/// the two positions, which the light's own offset does not know of.
inline Vec3 shadow_ray_target(const SurfacePoint& light, const Vec3& p) {
    const float connection = 8.f * unit_roundoff * (p.cwiseAbs().sum() + light.p.cwiseAbs().sum());
    return light.p + (light.offset + connection) * light.ng;
}

}  // namespace gib
