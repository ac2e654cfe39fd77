#include "common/lights/light.h"

#include "common/lights/emission_axes.h"
#include "common/sampling/sampler.h"

namespace gib {

namespace {

/// The mean of a texture over a surface. The points are deterministic, so that a light's power is the same
/// at every call.
Color mean_over_surface(const Texture& texture, const AreaSampler& surface, const Shape& shape) {
    constexpr std::uint32_t points = 1u << 16;
    Colord sum = Colord::Zero();
    for (std::uint32_t i = 0; i < points; ++i)
        sum +=
            texture.color(surface.sample_geometry(shape, Sampler(PointSet::sobol, 0, 0, i).get_2d(0)).texture_point())
                .cast<double>();
    // If all points met dark parts of the texture, its plain mean is used, so that the light can still be chosen.
    return sum.maxCoeff() > 0 ? Color((sum / points).cast<float>()) : texture.mean();
}

/// The cone of directions from a point p to a sphere that does not contain p.
struct SphereCone {
    Vec3 axis;
    float distance;  ///< distance to the centre [scene units]
    float one_minus_cos_max;

    /// [sr]
    float solid_angle() const { return 2.f * pi * one_minus_cos_max; }
};

/// Empty also for a flipped sphere, which emits inwards and is sampled by area.
[[gnu::always_inline]] inline std::optional<SphereCone> emitting_cone(const Sphere& sphere, const Vec3& p) {
    if (sphere.flip_normals) return std::nullopt;
    const Vec3 to_center = sphere.center - p;
    const float d2 = to_center.squaredNorm(), r2 = sqr(sphere.radius);
    // Inside or on the sphere there is no cone; a margin keeps the division below well conditioned.
    if (d2 <= r2 * 1.0001f) return std::nullopt;
    // 1 - cos = (d - tangent) / d = r^2 / (d (d + tangent)), which does not cancel for a distant sphere.
    const float d = std::sqrt(d2), tangent = std::sqrt(d2 - r2);
    return SphereCone{to_center * (1.f / d), d, r2 / (d2 + d * tangent)};
}

Color radiance_of_sphere(const AreaLight& light, const Sphere& sphere, const Vec3& direction) {
    return light.texture ? light.texture->color(sphere.uv_at(direction)) : light.radiance;
}

std::optional<LightSample> sample_cone(const AreaLight& light, const Sphere& sphere, const SphereCone& cone,
                                       const Vec3& p, const Vec2& u) {
    const Vec3 w = square_to_cone(u, cone.one_minus_cos_max);
    const Frame frame(cone.axis);
    // The near intersection along w, with the radius as the unit of length; rays at the rim touch the sphere. In the
    // frame of the cone, the point n is t w minus (0, 0, d) from the centre. This is written without cancellation,
    // because the cone of a small or distant sphere is known to more digits than the cosine of its angle. At the rim,
    // rounding moves the point along the sphere.
    const float d = cone.distance / sphere.radius;
    const float one_minus_cos = u.x() * cone.one_minus_cos_max, sin2 = one_minus_cos * (2.f - one_minus_cos);
    const float cos_light = safe_sqrt(1.f - sqr(d) * sin2), t = d * w.z() - cos_light;
    const Vec3 n = frame.to_world(Vec3(t * w.x(), t * w.y(), -d * sin2 - cos_light * w.z()));
    std::optional<LightSample> sample(std::in_place);  // member by member, as in seen_from_front()
    sample->wi = frame.to_world(w);
    sample->distance = t * sphere.radius;
    sample->Le = radiance_of_sphere(light, sphere, n);
    sample->pdf_w = 1.f / cone.solid_angle();
    sample->delta = false;
    sample->cos_light = cos_light;
    sample->target = shadow_ray_target(sphere.point_at(n), p);
    return sample;
}

/// A sample of a light at infinity, whose shadow ray ends past all surfaces.
LightSample distant_sample(const BoundingSphere& scene, const Vec3& p, const Vec3& wi, const Color& Le, float pdf_w,
                           bool delta) {
    return {.wi = wi,
            .distance = infinity,
            .Le = Le,
            .pdf_w = pdf_w,
            .delta = delta,
            .target = p + scene.distance_past(p) * wi};
}

struct LightSampler {
    const std::vector<Shape>& shapes;
    const Vec3& p;
    const Vec2& u;

    std::optional<LightSample> operator()(const AreaLight& light) const {
        return light.is_plain_mesh() ? seen_from_front(light, light.surface.sample_facets(u), light.radiance)
                                     : sample_other_surface(light);
    }
    /// Apart, since meshes would pay for its many registers.
    [[gnu::noinline]] std::optional<LightSample> sample_other_surface(const AreaLight& light) const {
        const Shape& shape = shapes[light.shape];
        if (const auto* sphere = std::get_if<Sphere>(&shape))
            if (const auto cone = emitting_cone(*sphere, p)) return sample_cone(light, *sphere, *cone, p, u);
        if (!light.texture) return seen_from_front(light, light.surface.sample(shape, u), light.radiance);
        const SurfaceGeometry q = light.surface.sample_geometry(shape, u);
        return seen_from_front(light, q, light.texture->color(q.texture_point()));
    }

    std::optional<LightSample> operator()(const PointLight& light) const {
        return from_point(light.position, [&](const Vec3&) { return light.intensity; });
    }

    std::optional<LightSample> operator()(const SpotLight& light) const {
        return from_point(light.position(), [&](const Vec3& w) { return light.intensity(w); });
    }

    std::optional<LightSample> operator()(const ProjectorLight& light) const {
        return from_point(light.position(), [&](const Vec3& w) { return light.intensity(w); });
    }

    std::optional<LightSample> operator()(const DirectionalLight& light) const {
        return distant_sample(light.scene, p, -light.direction, light.irradiance, 1.f, true);
    }

    std::optional<LightSample> operator()(const ConstantEnvironment& light) const {
        return distant_sample(light.scene, p, square_to_sphere(u), light.radiance, uniform_sphere_pdf_w, false);
    }

    std::optional<LightSample> operator()(const MappedEnvironment& light) const {
        const EnvironmentMap::Sample sample = light.map->sample(u);
        return distant_sample(light.scene, p, sample.w, sample.radiance, sample.pdf_w, false);
    }

private:
    std::optional<LightSample> seen_from_front(const AreaLight& light, const SurfacePoint& q, const Color& Le) const {
        const Vec3 to_light = q.p - p;
        const float towards = -to_light.dot(q.ng);
        if (!(towards > 0.f)) return std::nullopt;
        const float d2 = to_light.squaredNorm(), d = std::sqrt(d2), per_d = 1.f / d;
        const Vec3 wi = to_light * per_d;
        const float cos_light = towards * per_d;
        // The sample is built in place, member by member, because clang 14 cannot initialise an
        // aggregate in parentheses.
        std::optional<LightSample> sample(std::in_place);
        sample->wi = wi;
        sample->distance = d;
        sample->Le = Le;
        sample->pdf_w = d2 / (cos_light * light.surface.area());
        sample->delta = false;
        sample->cos_light = cos_light;
        sample->target = shadow_ray_target(q, p);
        return sample;
    }

    template <typename Intensity>
    std::optional<LightSample> from_point(const Vec3& position, Intensity intensity) const {
        const Vec3 to_light = position - p;
        const float d2 = to_light.squaredNorm(), d = std::sqrt(d2);
        if (!(d2 > 0.f)) return std::nullopt;
        const Vec3 wi = to_light / d;
        const Color I = intensity(-wi);
        if (is_black(I)) return std::nullopt;
        // The shadow ray ends before the light. If the light lies in a surface, rounding would decide whether a ray
        // to the light itself meets this surface.
        return LightSample{.wi = wi,
                           .distance = d,
                           .Le = I / d2,
                           .pdf_w = 1.f,
                           .delta = true,
                           .target = position - rounding_of_connection(position, p) * wi};
    }
};

/// Power [W] of an area light that emits `radiance` everywhere.
Colord power_of_area(const AreaLight& light, const Color& radiance) {
    return std::numbers::pi * double{light.surface.area()} * radiance.cast<double>();
}

struct EmissionSampler {
    const std::vector<Shape>& shapes;
    const Vec2& u_position;
    const Vec2& u_direction;

    EmissionSample operator()(const AreaLight& light) const {
        if (light.is_plain_mesh()) {
            const SurfacePoint q = light.surface.sample_facets(u_position);
            return emitted_from(light, q, Frame(q.ng), light.radiance);
        }
        const Shape& shape = shapes[light.shape];
        if (const auto* sphere = std::get_if<Sphere>(&shape)) return from_sphere(light, *sphere);
        if (!light.texture) return from_surface(light, light.surface.sample(shape, u_position), light.radiance);
        const SurfaceGeometry q = light.surface.sample_geometry(shape, u_position);
        return from_surface(light, q, light.texture->color(q.texture_point()));
    }

    EmissionSample operator()(const PointLight& light) const {
        const Vec3 w = emission_axes(light.position).to_world(square_to_sphere(u_direction));
        return {from_point(light.position, w), 4 * std::numbers::pi * light.intensity.cast<double>(), Vec3::Zero()};
    }

    EmissionSample operator()(const SpotLight& light) const {
        const SpotLight::Direction sample = light.sample(u_direction);
        return {from_point(light.position(), sample.w), sample.power, Vec3::Zero()};
    }

    EmissionSample operator()(const ProjectorLight& light) const {
        const ProjectorLight::Direction sample = light.sample(u_direction);
        return {from_point(light.position(), sample.w), sample.power, Vec3::Zero()};
    }

    EmissionSample operator()(const DirectionalLight& light) const {
        return from_infinity(light.scene, -light.direction, light.irradiance.cast<double>());
    }

    EmissionSample operator()(const ConstantEnvironment& light) const {
        return from_infinity(light.scene, square_to_sphere(u_direction),
                             light.radiance.cast<double>() / double{uniform_sphere_pdf_w});
    }

    EmissionSample operator()(const MappedEnvironment& light) const {
        const EnvironmentMap::Sample sample = light.map->sample(u_direction);
        return from_infinity(light.scene, sample.w, sample.radiance.cast<double>() / double{sample.pdf_w});
    }

private:
    /// The light may lie in a surface, which must not block its own light: the ray starts beyond the rounding error.
    static Ray from_point(const Vec3& position, const Vec3& w) {
        return {position, w, rounding_of_connection(position, position)};
    }

    /// Uniform on the surface and cosine-weighted: Le cos / (pdf_a pdf_w) = Le A pi.
    EmissionSample from_surface(const AreaLight& light, const SurfacePoint& q, const Color& Le) const {
        // Around a cylinder the frame must turn with the normal: Frame's axes jump where n.z changes its sign.
        const auto* cylinder = std::get_if<Cylinder>(&shapes[light.shape]);
        return emitted_from(light, q, cylinder ? frame_along(q.ng, cylinder->axis) : Frame(q.ng), Le);
    }
    EmissionSample emitted_from(const AreaLight& light, const SurfacePoint& q, const Frame& frame,
                                const Color& Le) const {
        const Vec3 w = frame.to_world(square_to_cosine_hemisphere(u_direction));
        return {Ray{offset_origin(q, w), {w.x(), w.y(), w.z()}}, power_of_area(light, Le), q.ng};
    }

    /// Samples the direction first, uniformly, and then a point of the disk across it, which is lifted to the sphere.
    /// cos dA on the sphere is an area on the disk. The density 1 / (4 pi) 1 / (pi r^2) per cos dA dw is therefore
    /// that of a uniform point and a cosine-weighted direction, cos / pi 1 / A per dA dw. No frame has to be spread
    /// over the sphere: neighbours in (u_position, u_direction) are neighbours in position and direction.
    EmissionSample from_sphere(const AreaLight& light, const Sphere& sphere) const {
        const Vec3 w = emission_axes(sphere.center).to_world(square_to_sphere(u_direction));
        const Vec2 d = square_to_disk(u_position);
        // As in square_to_cosine_hemisphere: no ray leaves along the surface.
        const float lift = std::sqrt(std::max(1.f - d.squaredNorm(), 1e-12f));
        const Vec3 n = Frame(w).to_world(Vec3(d.x(), d.y(), sphere.flip_normals ? -lift : lift));
        const SurfacePoint q = sphere.point_at(n);
        return {Ray{q.p + q.offset * q.ng, w}, power_of_area(light, radiance_of_sphere(light, sphere, n)), q.ng};
    }

    /// Parallel light that comes from the direction w, uniform over the disk that covers the scene: E / pdf_a =
    /// E pi r^2.
    EmissionSample from_infinity(const BoundingSphere& scene, const Vec3& w, const Colord& irradiance) const {
        const Vec2 d = scene.radius * square_to_disk(u_position);
        return {Ray{scene.center + Frame(w).to_world(Vec3(d.x(), d.y(), scene.radius)), -w}, scene.area() * irradiance,
                Vec3::Zero()};
    }
};

struct EmissionPdf {
    const Vec3& w;
    float cos_light;

    double operator()(const AreaLight& light) const {
        return double{cos_light} / (std::numbers::pi * double{light.surface.area()});
    }
    double operator()(const PointLight&) const { return 1 / (4 * std::numbers::pi); }
    double operator()(const SpotLight& light) const { return light.pdf_w(w); }
    double operator()(const ProjectorLight& light) const { return light.pdf_w(w); }
    double operator()(const DirectionalLight& light) const { return 1 / light.scene.area(); }
    double operator()(const ConstantEnvironment& light) const {
        return double{uniform_sphere_pdf_w} / light.scene.area();
    }
    double operator()(const MappedEnvironment& light) const {
        return double{light.map->pdf_w(-w)} / light.scene.area();
    }
};

struct PowerOf {
    Colord operator()(const AreaLight& light) const { return power_of_area(light, light.radiance); }
    Colord operator()(const PointLight& light) const { return 4 * std::numbers::pi * light.intensity.cast<double>(); }
    Colord operator()(const SpotLight& light) const { return light.power(); }
    Colord operator()(const ProjectorLight& light) const { return light.power(); }
    Colord operator()(const DirectionalLight& light) const {
        return light.scene.area() * light.irradiance.cast<double>();
    }
    Colord operator()(const ConstantEnvironment& light) const {
        return light.scene.area() * 4 * std::numbers::pi * light.radiance.cast<double>();
    }
    Colord operator()(const MappedEnvironment& light) const { return light.scene.area() * light.map->integral(); }
};

}  // namespace

BoundingSphere::BoundingSphere(const Bounds& bounds) {
    // The margin covers the rounding of the box and of the points on the disk; a scene without extent keeps a disk.
    center = bounds.center();
    radius = std::max(0.5f * bounds.diagonal() * 1.00001f, 1e-15f);
}

AreaLight::AreaLight(std::uint32_t shape_index, const Shape& of, const Texture& emitted)
    : shape(shape_index), radiance(emitted.mean()), surface(of) {
    if (emitted.constant()) return;
    texture = emitted;
    radiance = mean_over_surface(emitted, surface, of);
}

Colord power_of(const Light& light) { return std::visit(PowerOf(), light); }

double brightest_radiance(const std::vector<Light>& lights) {
    double largest = 0;
    for (const Light& light : lights) {
        const auto* area = std::get_if<AreaLight>(&light);
        const auto* constant = std::get_if<ConstantEnvironment>(&light);
        if (std::holds_alternative<MappedEnvironment>(light) || (area && area->texture))
            return std::numeric_limits<double>::infinity();
        if (area || constant) largest = std::max(largest, double{(area ? area->radiance : constant->radiance).mean()});
    }
    return largest;
}

std::optional<LightSample> sample_light(const Light& light, const std::vector<Shape>& shapes, const Vec3& p,
                                        const Vec2& u) {
    return std::visit(LightSampler{shapes, p, u}, light);
}

float light_pdf_w(const AreaLight& light, const std::vector<Shape>& shapes, const Vec3& p, const SurfacePoint& hit) {
    if (const auto* sphere = std::get_if<Sphere>(&shapes[light.shape]))
        if (const auto cone = emitting_cone(*sphere, p)) return 1.f / cone->solid_angle();
    const Vec3 to_light = hit.p - p;
    const float d2 = to_light.squaredNorm(), towards = -to_light.dot(hit.ng);
    if (!(towards > 0.f && d2 > 0.f)) return 0.f;
    const float cos_light = towards / std::sqrt(d2);
    return d2 / (cos_light * light.surface.area());
}

Color environment_radiance(const Light& environment, const Vec3& w) {
    if (const auto* constant = std::get_if<ConstantEnvironment>(&environment)) return constant->radiance;
    return std::get<MappedEnvironment>(environment).map->radiance(w);
}

float environment_pdf_w(const Light& environment, const Vec3& w) {
    if (std::holds_alternative<ConstantEnvironment>(environment)) return uniform_sphere_pdf_w;
    return std::get<MappedEnvironment>(environment).map->pdf_w(w);
}

EmissionSample sample_emission(const Light& light, const std::vector<Shape>& shapes, const Vec2& u_position,
                               const Vec2& u_direction) {
    return std::visit(EmissionSampler{shapes, u_position, u_direction}, light);
}

double emission_pdf(const Light& light, const Vec3& w, float cos_light) {
    return std::visit(EmissionPdf{w, cos_light}, light);
}

}  // namespace gib
