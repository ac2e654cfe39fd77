#pragma once
// Emitters, a closed set. They are sampled from a point that they light (LightSample) or as the start of a
// light path (EmissionSample).

#include "common/images/texture.h"
#include "common/lights/environment_map.h"
#include "common/lights/projector_light.h"
#include "common/lights/spot_light.h"
#include "common/shapes/shape.h"

#include <memory>
#include <numbers>
#include <optional>
#include <variant>
#include <vector>

namespace gib {

/// A ball around all surfaces; the power of lights at infinity refers to it.
struct BoundingSphere {
    Vec3 center = Vec3::Zero();
    float radius = 1.f;

    BoundingSphere() = default;
    BoundingSphere(const Vec3& middle, float r) : center(middle), radius(r) {}
    explicit BoundingSphere(const Bounds& bounds);
    /// Area of the ball's cross-section [scene units^2]. It is in double so that the lights of a tiny scene
    /// do not underflow.
    double area() const { return std::numbers::pi * sqr(double{radius}); }
    /// A distance from p [scene units] after which a ray in any direction is outside of the ball.
    float distance_past(const Vec3& p) const { return 1.01f * ((p - center).norm() + radius); }
};

/// A surface that emits the same radiance in every direction of its front side.
struct AreaLight {
    /// The shape must have an area above 0.
    AreaLight(std::uint32_t shape_index, const Shape& shape, const Texture& emitted);

    std::uint32_t shape;             ///< index into the scene's shapes
    Color radiance;                  ///< [W/(sr m^2)]; with a texture its mean over the surface
    std::optional<Texture> texture;  ///< texture of the radiance; none: the radiance is constant
    AreaSampler surface;

    Color radiance_at(const TexturePoint& at) const { return texture ? texture->color(at) : radiance; }
    /// Whether it is a mesh of constant radiance, by far the most common light, whose samples are made inline.
    bool is_plain_mesh() const { return surface.has_facets() && !texture; }
};

/// `intensity` [W/sr] in every direction.
struct PointLight {
    Vec3 position;
    Color intensity;
};

/// Light from infinitely far away, along one direction.
struct DirectionalLight {
    Vec3 direction;    ///< direction in which the light travels, unit
    Color irradiance;  ///< [W/m^2] on a surface across this direction
    BoundingSphere scene;
};

/// The same radiance [W/(sr m^2)] from every direction, infinitely far away.
struct ConstantEnvironment {
    Color radiance;
    BoundingSphere scene;
};

/// Radiance from an image, infinitely far away.
struct MappedEnvironment {
    std::shared_ptr<const EnvironmentMap> map;
    BoundingSphere scene;
};

using Light = std::variant<AreaLight, PointLight, SpotLight, ProjectorLight, DirectionalLight, ConstantEnvironment,
                           MappedEnvironment>;

/// Whether the light lies at infinity in every direction, so that rays that leave the scene find it.
inline bool is_environment(const Light& light) {
    return std::holds_alternative<ConstantEnvironment>(light) || std::holds_alternative<MappedEnvironment>(light);
}

inline bool is_at_infinity(const Light& light) {
    return is_environment(light) || std::holds_alternative<DirectionalLight>(light);
}

/// Whether the light shines from one point.
inline bool is_point(const Light& light) {
    return std::holds_alternative<PointLight>(light) || std::holds_alternative<SpotLight>(light) ||
           std::holds_alternative<ProjectorLight>(light);
}

/// Whether the light shines from one point or in one direction, so that only light sampling finds it.
inline bool is_delta(const Light& light) { return is_point(light) || std::holds_alternative<DirectionalLight>(light); }

/// A point of a light as seen from a point that it may light.
struct LightSample {
    Vec3 wi;         ///< direction from the lit point to the light, unit
    float distance;  ///< distance from the lit point to the light [scene units]; infinite for a light at infinity
    /// Emitted radiance towards the point [W/(sr m^2)]; may be black. For delta lights it is instead intensity /
    /// distance^2 (lights at a point) or the irradiance (directional) [W/m^2], and pdf_w is the probability of the
    /// choice.
    Color Le;
    float pdf_w;  ///< [1/sr], the choice of the light included
    bool delta;   ///< only light sampling finds this light
    /// The cosine of the angle at the light between its normal and the way to the point; 1 without a surface.
    float cos_light = 1.f;
    std::uint32_t light = 0;  ///< index among the scene's lights
    Vec3 target;  ///< the end of the shadow ray: in front of the light's surface, or past the scene's surfaces
};

/// The start of a light path with its share of power.
struct EmissionSample {
    Ray ray;
    /// Emitted power / density [W]: the mean over samples is the light's power; may be black. In double, because a
    /// lamp of 1e-24 m^2 and radiance 1e-20 emits less than a float holds exactly.
    Colord power;
    Vec3 normal;              ///< geometric normal at the origin; zero for a light without a surface
    std::uint32_t light = 0;  ///< index among the scene's lights
};

/// Emitted power [W] per channel; for lights at infinity the power that passes the scene's bounding sphere.
Colord power_of(const Light& light);

/// The largest radiance that the lights emit towards a ray that finds them by chance, mean of the channels [W/(sr m^2)]: 0 for
/// delta lights, infinite where an image gives the radiance.
double brightest_radiance(const std::vector<Light>& lights);

/// Samples the light as seen from p: uniformly over its area; for a sphere seen from outside, over the cone of its
/// directions; for a map, with EnvironmentMap's density. pdf_w does not include the choice of the light. Empty if the
/// light cannot be seen from p.
std::optional<LightSample> sample_light(const Light& light, const std::vector<Shape>& shapes, const Vec3& p,
                                        const Vec2& u);

/// Density [1/sr] with which sample_light from `p` would have found the point `hit` of the area light.
float light_pdf_w(const AreaLight& light, const std::vector<Shape>& shapes, const Vec3& p, const SurfacePoint& hit);

/// Radiance [W/(sr m^2)] that an environment sends towards a viewer who looks along the unit vector w.
Color environment_radiance(const Light& environment, const Vec3& w);
/// Density [1/sr] with which sample_light finds the direction w.
float environment_pdf_w(const Light& environment, const Vec3& w);

/// The start of a light path, without the choice of the light.
EmissionSample sample_emission(const Light& light, const std::vector<Shape>& shapes, const Vec2& u_position,
                               const Vec2& u_direction);

/// The density of sample_emission() at a start in direction w, whose angle with the normal of an area light has this
/// cosine. Its unit is that of the light's start: [1/(m^2 sr)] for an area light (the area on its surface) and an
/// environment (across w), [1/sr] for a light at a point, [1/m^2] (across w) for a directional light. In double,
/// because the extent of a scene is not bounded.
double emission_pdf(const Light& light, const Vec3& w, float cos_light);

/// The origin of a ray that leaves `point` on the side that `w` points to.
inline Vec3 offset_origin(const SurfacePoint& point, const Vec3& w) {
    return point.p + (w.dot(point.ng) >= 0.f ? point.offset : -point.offset) * point.ng;
}

/// How far rounding may move the end of a ray between two points [scene units]. The end is the sum of an origin and a
/// distance along a direction, each of them rounded a few times, relative to positions of this size.
inline float rounding_of_connection(const Vec3& a, const Vec3& b) {
    return 8.f * unit_roundoff * (a.cwiseAbs().sum() + b.cwiseAbs().sum());
}

/// The end of a shadow ray from near `p`, in front of the emitting side of `light`. The light's own offset does not
/// include the rounding of the ray between the two points.
inline Vec3 shadow_ray_target(const SurfacePoint& light, const Vec3& p) {
    return light.p + (light.offset + rounding_of_connection(light.p, p)) * light.ng;
}

}  // namespace gib
