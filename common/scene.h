#pragma once
// The scene: geometry, materials, lights and the camera, immutable once built. It holds no film, sampler or setting.

#include "common/accelerator.h"
#include "common/bsdf.h"
#include "common/light.h"
#include "common/sensor.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// Where a ray met a surface.
struct SurfaceHit : SurfaceGeometry {
    const Bsdf* bsdf;
    const AreaLight* emitter;                  ///< null: not a light
    std::uint32_t light;                       ///< index of the emitter among the scene's lights
    Frame shading;                             ///< around ns
    std::uint32_t shape, primitive, instance;  ///< what was hit, for what is computed on demand

    /// [W/(sr m^2)] emitted towards wo.
    Color Le(const Vec3& wo) const { return emitter && ng.dot(wo) > 0.f ? emitter->radiance : Color(Color::Zero()); }
    Ray spawn_ray(const Vec3& wi) const { return {offset_origin(*this, wi), wi}; }
};

/// What a scene is built from, in the file's own coordinates.
struct SceneParts {
    struct Object {
        Shape shape;
        std::uint32_t bsdf;             ///< index into bsdfs
        std::optional<Color> radiance;  ///< of an area light
    };
    std::vector<Object> objects;
    std::vector<std::vector<Object>> groups;  ///< what instances show, each in coordinates of its own; no lights
    std::vector<Instance> instances;
    std::vector<Bsdf> bsdfs;
    std::vector<PointLight> point_lights;
    std::optional<Sensor> sensor;  ///< required
    Vec3d origin = Vec3d::Zero();  ///< the file's coordinates of the scene's own origin: shapes and lights are given
                                   ///< relative to it, the sensor in the file's coordinates
};

class Scene {
public:
    /// Builds the tree and the light distribution.
    explicit Scene(SceneParts parts);

    const Sensor& sensor() const { return sensor_; }
    /// Those of groups too, once each.
    const std::vector<Shape>& shapes() const { return shapes_; }
    const std::vector<Instance>& instances() const { return groups_.instances; }
    const std::vector<Light>& lights() const { return lights_; }
    const std::vector<Bsdf>& bsdfs() const { return bsdfs_; }
    const Bsdf& bsdf_of_shape(std::size_t shape) const { return bsdfs_[surfaces_[shape].bsdf]; }
    const Bounds& bounds() const { return bounds_; }
    /// Of the box around all surfaces [scene units]; lengths given as fractions refer to it.
    float diagonal() const { return bounds_.diagonal(); }
    const Accelerator& accelerator() const { return *accelerator_; }

    std::optional<SurfaceHit> intersect(const Ray& ray) const;
    /// At what intersect() returned.
    SurfaceDerivatives derivatives_at(const SurfaceHit& hit) const;
    bool occluded(const Ray& ray) const { return accelerator_->occluded(ray); }

    /// Whether any light emits anything.
    bool has_light() const { return light_choice_.total() > 0; }
    /// A light, chosen by its power (mean of the channels), and a point on it.
    std::optional<LightSample> sample_light(const Vec3& p, float u_choice, const Vec2& u) const;
    /// Density [1/sr] with which sample_light from `p` finds `hit`, which lies on an emitter.
    float light_pdf_w(const Vec3& p, const SurfaceHit& hit) const;
    /// The start of a light path; power is divided by the probability of choosing its light.
    EmissionSample sample_emission(float u_choice, const Vec2& u_position, const Vec2& u_direction) const;
    /// [W] of all lights together, per channel.
    Colord emitted_power() const;

private:
    static constexpr std::uint32_t no_light = ~0u;
    struct Surface {
        std::uint32_t bsdf;
        std::uint32_t light;
    };

    void add(SceneParts::Object&& object);
    SurfaceGeometry geometry_at(const Intersection& i, const Ray& ray) const;

    std::vector<Shape> shapes_;
    std::vector<Surface> surfaces_;  ///< parallel to shapes_
    InstancedGroups groups_;
    std::vector<Bsdf> bsdfs_;
    std::vector<Light> lights_;
    DiscreteDistribution light_choice_;
    Sensor sensor_;
    Bounds bounds_;
    std::unique_ptr<Accelerator> accelerator_;
};

}  // namespace gib
