#pragma once
// The scene: geometry, materials, lights and the camera, immutable once built. It holds no film, sampler or setting.

#include "common/lights/light.h"
#include "common/lights/light_tree.h"
#include "common/materials/material.h"
#include "common/media/medium.h"
#include "common/scene/sensor.h"
#include "common/shapes/accelerator.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// Where a ray met a surface.
struct SurfaceHit : SurfaceGeometry {
    explicit SurfaceHit(const SurfaceGeometry& geometry)
        : SurfaceGeometry(geometry), interpolated(geometry.ns), is_flat_(ns == ng || ns == -ng) {}
    /// On a triangle or a sphere with its own normal, where nothing depends on uv.
    SurfaceHit(const SurfacePoint& point, std::uint32_t triangle, const Vec2& of_vertices)
        : SurfaceGeometry{point, point.ng, of_vertices, triangle, of_vertices},
          interpolated(point.ng),
          is_flat_(true) {}

    const Bsdf* bsdf = nullptr;
    const AreaLight* emitter = nullptr;  ///< null: not a light
    std::uint32_t light = 0;             ///< index of the emitter among the scene's lights
    Frame shading;                       ///< frame around ns; its first axis along dp_du where the material follows uv
    std::uint32_t shape, instance;       ///< indices of the surface that was hit, for data computed on demand
    Vec3 interpolated;                   ///< the file's shading normal, which is `ns` unless delta_only
    /// True if the ray arrives above one of the two normals, the file's shading normal and the geometric one, and
    /// below the other. `ns` is then the geometric normal, and only delta lobes (mirrors, smooth interfaces) scatter.
    bool delta_only = false;
    std::shared_ptr<const Bsdf> own_bsdf = nullptr;  ///< bsdf of a material that varies over the surface; else null

    void take(Bsdf&& bsdf_here);

    /// Emitted radiance [W/(sr m^2)] towards wo.
    Color Le(const Vec3& wo) const {
        return emitter && ng.dot(wo) > 0.f ? emitter->radiance_at(texture_point()) : Color(Color::Zero());
    }
    /// Whether the file's shading normal is the geometric one, from either side.
    bool is_flat() const { return is_flat_; }
    /// Whether w is on the same side of the surface by the shading normal as by the geometric one. The two normals
    /// may point to opposite sides, as in meshes whose triangles are wound the other way: this is no disagreement.
    bool normals_agree_about(const Vec3& w) const { return agree_about(ns, w); }
    /// The same by the file's shading normal, also where `ns` has taken another value.
    bool file_normals_agree_about(const Vec3& w) const { return agree_about(interpolated, w); }
    /// The share of light that goes straight on along w, through holes and thin sheets.
    Color straight_on(const Vec3& w) const { return bsdf->straight_on_local(shading.to_local(w)); }
    Ray spawn_ray(const Vec3& wi) const { return {offset_origin(*this, wi), wi}; }
    /// This point as lights light it, for a viewer in direction wo. A material that transmits none scatters to wo only
    /// light from the side of wo (normals_agree_about()); with a bump or normal map that is not exact.
    LitPoint lit_for(const Vec3& wo) const {
        const bool one_sided = !bsdf->traits().transmission && !bsdf->is_tilted();
        return {p, one_sided ? normal_towards(*this, wo) : Vec3(Vec3::Zero())};
    }

private:
    bool agree_about(const Vec3& n, const Vec3& w) const { return is_flat_ || n.dot(w) * ng.dot(w) * n.dot(ng) >= 0.f; }

    bool is_flat_;
};

inline constexpr std::uint32_t no_medium = ~0u;

/// The media on the two sides of a shape's surface.
struct MediumSides {
    bool boundary = false;                                     ///< false: the surface does not change the medium
    std::uint32_t interior = no_medium, exterior = no_medium;  ///< behind the geometric normal, and in front of it
};

/// The parts that a scene is built from. `origin` says in which coordinates they are given.
struct SceneParts {
    struct Object {
        Shape shape;
        std::uint32_t material;           ///< index into materials
        std::optional<Texture> radiance;  ///< radiance of an area light; none: no light
        MediumSides media{};
    };
    std::vector<Object> objects;
    std::vector<std::vector<Object>> groups;  ///< shown by instances, each in its own coordinates; no lights
    std::vector<Instance> instances;
    std::vector<Material> materials;
    std::vector<Medium> media;
    std::uint32_t camera_medium = no_medium;
    std::vector<Light> lights;     ///< all but the area lights; at most one environment
    std::optional<Sensor> sensor;  ///< required
    Vec3d origin = Vec3d::Zero();  ///< the file's coordinates of the scene's own origin: shapes and lights are given
                                   ///< relative to it, the sensor in the file's coordinates
};

class Scene {
public:
    /// Builds the tree and the light distribution. Throws InputError if there is no sensor.
    explicit Scene(SceneParts parts);

    const Sensor& sensor() const { return sensor_; }
    /// All shapes; those of groups appear once each.
    const std::vector<Shape>& shapes() const { return shapes_; }
    const std::vector<Instance>& instances() const { return groups_.instances; }
    const InstancedGroups& groups() const { return groups_; }
    const std::vector<Light>& lights() const { return lights_; }
    const std::vector<Material>& materials() const { return materials_; }
    const Material& material_of_shape(std::size_t shape) const { return materials_[surfaces_[shape].material]; }
    /// Whether any surface lets light go straight on (masks, thin sheets).
    bool has_holes() const { return has_holes_; }
    /// Whether any surface splits light by its wavelength.
    bool has_dispersion() const { return has_dispersion_; }
    /// Sets the bsdf of a hit on a material that splits light to that for one stratum of wavelengths.
    void disperse(SurfaceHit& hit, int stratum) const;
    /// Whether any space between surfaces absorbs or scatters light.
    bool has_media() const { return has_media_; }
    bool has_scattering_media() const;
    /// Whether a medium may have no surface around it: one that the camera stands in, or one that lies
    /// outside a shape.
    bool has_unbounded_medium() const;
    /// The medium that the camera stands in; null: none.
    const Medium* camera_medium() const { return medium(camera_medium_); }
    /// Puts the camera into a medium of a scene that has media already.
    void set_camera_medium(std::uint32_t index) { camera_medium_ = index; }
    /// The medium beyond a surface for a ray of direction w that was in `before` in front of the surface; null: none.
    const Medium* medium_beyond(const SurfaceHit& hit, const Vec3& w, const Medium* before) const {
        const MediumSides& sides = media_sides_[hit.shape];
        if (!sides.boundary) return before;
        return medium(w.dot(hit.ng) > 0.f ? sides.exterior : sides.interior);
    }
    /// Whether the camera looks through this surface, a lamp, because it sees no emitters.
    bool hidden_from_camera(const SurfaceHit& hit) const { return hit.emitter && sensor_.hides_emitters(); }
    bool bounds_medium(const SurfaceHit& hit) const { return media_sides_[hit.shape].boundary; }
    const Bounds& bounds() const { return bounds_; }
    /// The diagonal of the box around all surfaces [scene units]; lengths given as fractions refer to it.
    float diagonal() const { return bounds_.diagonal(); }
    const Accelerator& accelerator() const { return *accelerator_; }

    std::optional<SurfaceHit> intersect(const Ray& ray) const { return surface_hit(ray, accelerator_->intersect(ray)); }
    /// The surface where the accelerator found `intersection` on the ray.
    std::optional<SurfaceHit> surface_hit(const Ray& ray, const std::optional<Intersection>& intersection) const {
        if (!intersection) return std::nullopt;
        return surface_on(ray, *intersection);
    }
    /// Starts to fetch the data that surface_hit() will read, for callers that have other work in between.
    void prefetch(const std::optional<Intersection>& intersection) const {
        if (!intersection) return;
        const auto* mesh = std::get_if<Mesh>(&shapes_[intersection->shape]);
        if (mesh) __builtin_prefetch(&mesh->facets[intersection->primitive]);
    }
    /// The derivatives at a hit that intersect() returned.
    SurfaceDerivatives derivatives_at(const SurfaceHit& hit) const;
    /// normal_derivative() of the file's shading normal at such a hit.
    Eigen::Matrix3d normal_derivative_at(const SurfaceHit& hit) const;
    bool occluded(const Ray& ray) const { return accelerator_->occluded(ray); }

    /// The hit as lights light it, for a viewer in direction wo. Its side is worked out only where it counts.
    LitPoint lit(const SurfaceHit& hit, const Vec3& wo) const {
        return light_tree_.chooses() ? hit.lit_for(wo) : LitPoint(hit.p);
    }
    /// Whether any light emits anything.
    bool has_light() const { return light_choice_.total() > 0; }
    /// How lights are chosen for a point that they may light.
    const LightTree& light_tree() const { return light_tree_; }
    /// Chooses a light by what it can do at a point (light_tree.h) and samples a point on it; empty if this cannot be
    /// seen from there.
    std::optional<LightSample> sample_light(const LitPoint& at, float u_choice, const Vec2& u) const {
        if (!light_tree_.chooses()) return sample_chosen(light_tree_.only(), 1.f, at.p, u);
        const auto choice = light_tree_.choose(at, u_choice);
        if (!choice) return std::nullopt;
        return sample_chosen(choice->light, choice->probability, at.p, u);
    }
    /// Density [1/sr] with which sample_light for `at` finds `hit`, which lies on an emitter.
    float light_pdf_w(const LitPoint& at, const SurfaceHit& hit) const;
    /// The light that rays see when they leave the scene; null: none.
    const Light* environment() const { return environment_ ? &lights_[*environment_] : nullptr; }
    /// Radiance [W/(sr m^2)] seen along the unit vector w by a ray that hits nothing.
    Color environment_radiance(const Vec3& w) const {
        return environment_ ? gib::environment_radiance(lights_[*environment_], w) : Color(Color::Zero());
    }
    /// Density [1/sr] with which sample_light for `at` finds the direction w; 0 without an environment.
    float environment_pdf_w(const LitPoint& at, const Vec3& w) const;
    /// The start of a light path; power is divided by the probability of choosing its light.
    EmissionSample sample_emission(float u_choice, const Vec2& u_position, const Vec2& u_direction) const;
    /// The density of sample_emission() at a start in direction w (lights/light.h), with the choice of the light.
    double emission_pdf(std::uint32_t light, const Vec3& w, float cos_light) const {
        return double{light_choice_.probability(light)} * gib::emission_pdf(lights_[light], w, cos_light);
    }
    /// Density with which sample_light for `at` finds the start of a light path that leaves `point` of the light in
    /// direction w: [1/sr], or the probability of the choice for a delta light.
    float light_pdf_w(const LitPoint& at, std::uint32_t light, const SurfacePoint& point, const Vec3& w) const;
    /// The index of environment() among the lights.
    std::uint32_t environment_index() const { return *environment_; }
    /// Power [W] of all lights together, per channel.
    Colord emitted_power() const;

private:
    void add_light(Light&& light, const BoundingSphere& sphere);

    static constexpr std::uint32_t no_light = ~0u;
    struct Surface {
        std::uint32_t material;
        std::uint32_t light;
        bool uses_uv;  ///< the material or the emission depends on uv
        // Resolved when all parts of the scene are in their places:
        const Bsdf* bsdf = nullptr;          ///< null: to be made at each point, or about a frame that follows uv
        const AreaLight* emitter = nullptr;  ///< null: not a light
        // One of these is set if the shape is outside of all groups and needs no uv.
        const Mesh::Facet* facets = nullptr;  ///< facets of a flat mesh
        const Sphere* sphere = nullptr;
    };
    const Medium* medium(std::uint32_t i) const { return i == no_medium ? nullptr : &media_[i]; }
    // Large results are made in place, by functions that return nothing else: a copy waits for all its parts.
    std::optional<LightSample> sample_chosen(std::uint32_t light, float probability, const Vec3& p,
                                             const Vec2& u) const;
    std::optional<SurfaceHit> surface_on(const Ray& ray, const Intersection& i) const;
    std::optional<SurfaceHit> place_on_shape(const Ray& ray, const Intersection& i) const;
    void resolve_material(const Material& material, SurfaceHit& hit) const;
    MaterialPoint material_point(const Material& material, const SurfaceHit& hit) const;

    void add(SceneParts::Object&& object);
    void resolve_surfaces();
    SurfaceGeometry geometry_at(const Intersection& i, const Ray& ray, bool with_uv) const;

    std::vector<Shape> shapes_;
    std::vector<Surface> surfaces_;  ///< parallel to shapes_
    InstancedGroups groups_;
    std::vector<Material> materials_;
    bool has_holes_ = false, has_dispersion_ = false;
    std::vector<Medium> media_;
    std::vector<MediumSides> media_sides_;  ///< parallel to shapes_
    std::uint32_t camera_medium_ = no_medium;
    bool has_media_ = false;
    std::vector<Light> lights_;
    std::optional<std::uint32_t> environment_;  ///< index among the lights
    DiscreteDistribution light_choice_;         ///< choice for the starts of light paths
    LightTree light_tree_;                      ///< choice for points that are lit
    Sensor sensor_;
    Bounds bounds_;
    std::unique_ptr<Accelerator> accelerator_;
};

}  // namespace gib
