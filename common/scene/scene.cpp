#include "common/scene/scene.h"

#include "common/core/error.h"
#include "common/lights/light_choice.h"

#include <algorithm>

namespace gib {

namespace {

Sensor required_sensor(std::optional<Sensor>& sensor) {
    if (!sensor) throw InputError("the scene has no sensor");
    return *std::move(sensor);
}

}  // namespace

void SurfaceHit::take(Bsdf&& bsdf_here) {
    own_bsdf = std::make_shared<const Bsdf>(std::move(bsdf_here));
    bsdf = own_bsdf.get();
}

Scene::Scene(SceneParts parts)
    : materials_(std::move(parts.materials)),
      media_(std::move(parts.media)),
      camera_medium_(parts.camera_medium),
      has_media_(camera_medium_ != no_medium),
      sensor_(required_sensor(parts.sensor)) {
    sensor_.translate(-parts.origin);
    for (auto& object : parts.objects) {
        bounds_.add(bounds_of(object.shape));
        add(std::move(object));
    }
    std::vector<Bounds> group_bounds;
    for (auto& group : parts.groups) {
        groups_.begin.push_back(static_cast<std::uint32_t>(shapes_.size()));
        Bounds& bounds = group_bounds.emplace_back();
        for (auto& object : group) {
            bounds.add(bounds_of(object.shape));
            add(std::move(object));
        }
    }
    if (!parts.groups.empty()) groups_.begin.push_back(static_cast<std::uint32_t>(shapes_.size()));
    groups_.instances = std::move(parts.instances);
    for (const auto& instance : groups_.instances)
        bounds_.add(transformed(instance, group_bounds[instance.group]));
    const BoundingSphere sphere(bounds_);
    for (auto& light : parts.lights)
        add_light(std::move(light), sphere);

    light_choice_ = light_choice(lights_);
    light_tree_ = LightTree(lights_, shapes_);
    resolve_surfaces();
    accelerator_ = std::make_unique<Accelerator>(shapes_, groups_);
}

void Scene::add(SceneParts::Object&& object) {
    const auto shape = static_cast<std::uint32_t>(shapes_.size());
    shapes_.push_back(std::move(object.shape));
    if (auto* mesh = std::get_if<Mesh>(&shapes_.back())) mesh->prepare();
    std::uint32_t light = no_light;
    if (object.radiance && !is_black(object.radiance->maximum())) {
        light = static_cast<std::uint32_t>(lights_.size());
        lights_.push_back(AreaLight(shape, shapes_.back(), *object.radiance));
    }
    const Material& material = materials_[object.material];
    const bool uses_uv =
        !material.constant() || material.follows_uv() || (object.radiance && !object.radiance->constant());
    surfaces_.push_back({object.material, light, uses_uv});
    media_sides_.push_back(object.media);
    has_media_ |= object.media.interior != no_medium || object.media.exterior != no_medium;
    has_holes_ |= materials_[object.material].has_holes();
    has_dispersion_ |= materials_[object.material].is_dispersive();
}

bool Scene::has_unbounded_medium() const {
    if (camera_medium_ != no_medium) return true;
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        const MediumSides& sides = media_sides_[i];
        const bool encloses = std::visit(
            [](const auto& shape) {
                if constexpr (requires { shape.flip_normals; }) return !shape.flip_normals;
                else return false;
            },
            shapes_[i]);
        if (sides.exterior != no_medium || (sides.interior != no_medium && !encloses)) return true;
    }
    return false;
}

SurfaceGeometry Scene::geometry_at(const Intersection& i, const Ray& ray, bool with_uv) const {
    if (i.instance == no_instance)
        return surface_at(shapes_[i.shape], i.primitive, i.u, i.v, ray.o + i.t * ray.d, with_uv);
    const Instance& instance = groups_.instances[i.instance];
    const Ray r = carried_to_group(instance, ray);
    return carried_to_scene(instance, surface_at(shapes_[i.shape], i.primitive, i.u, i.v, r.o + i.t * r.d, with_uv));
}

void Scene::add_light(Light&& light, const BoundingSphere& sphere) {
    if (auto* directional = std::get_if<DirectionalLight>(&light)) directional->scene = sphere;
    if (auto* constant = std::get_if<ConstantEnvironment>(&light)) constant->scene = sphere;
    if (auto* mapped = std::get_if<MappedEnvironment>(&light)) mapped->scene = sphere;
    if (is_environment(light) && power_of(light).maxCoeff() > 0)
        environment_ = static_cast<std::uint32_t>(lights_.size());
    lights_.push_back(std::move(light));
}

void Scene::resolve_surfaces() {
    const std::size_t outside_groups = groups_.begin.empty() ? shapes_.size() : groups_.begin[0];
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        Surface& surface = surfaces_[i];
        const Material& material = materials_[surface.material];
        if (!material.follows_uv()) surface.bsdf = material.constant();
        if (surface.light != no_light) surface.emitter = &std::get<AreaLight>(lights_[surface.light]);
        if (i >= outside_groups || surface.uses_uv) continue;
        surface.sphere = std::get_if<Sphere>(&shapes_[i]);
        const auto* mesh = std::get_if<Mesh>(&shapes_[i]);
        if (mesh && mesh->normals.empty()) surface.facets = mesh->facets.data();
    }
}

std::optional<SurfaceHit> Scene::surface_on(const Ray& ray, const Intersection& i) const {
    const Surface& surface = surfaces_[i.shape];
    // The hit is made in place: the compiler would set an empty one to zero first.
    auto hit = surface.facets ? std::optional<SurfaceHit>(std::in_place, surface.facets[i.primitive].point_at(i.u, i.v),
                                                          i.primitive, Vec2(i.u, i.v))
               : surface.sphere
                   ? std::optional<SurfaceHit>(std::in_place, surface.sphere->point_near(ray.o + i.t * ray.d),
                                               i.primitive, Vec2(i.u, i.v))
                   : place_on_shape(ray, i);
    hit->bsdf = surface.bsdf;
    hit->emitter = surface.emitter;
    hit->light = surface.light;
    hit->shape = i.shape;
    hit->instance = i.instance;
    hit->shading = Frame(hit->ns);
    if (!hit->bsdf) resolve_material(materials_[surface.material], *hit);
    return hit;
}

/// The geometry of a hit, with the shading normal that counts for the ray.
std::optional<SurfaceHit> Scene::place_on_shape(const Ray& ray, const Intersection& i) const {
    std::optional<SurfaceHit> hit(std::in_place, geometry_at(i, ray, surfaces_[i.shape].uses_uv));
    hit->primitive = i.primitive;
    if (hit->normals_agree_about(ray.d)) return hit;
    hit->delta_only = true;
    hit->ns = hit->ns.dot(hit->ng) > 0.f ? hit->ng : Vec3(-hit->ng);
    return hit;
}

MaterialPoint Scene::material_point(const Material& material, const SurfaceHit& hit) const {
    MaterialPoint point{.uv = hit.uv,
                        .ng = hit.ng,
                        .dp_du = Vec3::Zero(),
                        .dp_dv = Vec3::Zero(),
                        .shading = hit.shading,
                        .triangle = hit.primitive,
                        .weights = hit.weights};
    if (!material.follows_uv()) return point;
    const SurfaceDerivatives derivatives = derivatives_at(hit);
    point.dp_du = derivatives.dp_du;
    point.dp_dv = derivatives.dp_dv;
    point.shading = frame_along(hit.ns, derivatives.dp_du);
    return point;
}

void Scene::resolve_material(const Material& material, SurfaceHit& hit) const {
    const MaterialPoint point = material_point(material, hit);
    hit.shading = point.shading;
    hit.bsdf = material.constant();
    if (!hit.bsdf) hit.take(material.at(point));
}

void Scene::disperse(SurfaceHit& hit, int stratum) const {
    const Material& material = material_of_shape(hit.shape);
    hit.bsdf = material.constant(stratum);
    if (!hit.bsdf) hit.take(material.at(material_point(material, hit), stratum));
}

SurfaceDerivatives Scene::derivatives_at(const SurfaceHit& hit) const {
    const Shape& shape = shapes_[hit.shape];
    return hit.instance == no_instance
               ? gib::derivatives_at(shape, hit.primitive, hit)
               : gib::derivatives_at(groups_.instances[hit.instance], shape, hit.primitive, hit);
}

Eigen::Matrix3d Scene::normal_derivative_at(const SurfaceHit& hit) const {
    const Shape& shape = shapes_[hit.shape];
    return hit.instance == no_instance ? normal_derivative(shape, hit.primitive, hit)
                                       : normal_derivative(groups_.instances[hit.instance], shape, hit.primitive, hit);
}

bool Scene::has_scattering_media() const {
    return has_media_ && std::any_of(media_.begin(), media_.end(), [](const Medium& m) { return m.scatters(); });
}

std::optional<LightSample> Scene::sample_chosen(std::uint32_t light, float probability, const Vec3& p,
                                                const Vec2& u) const {
    auto sample = gib::sample_light(lights_[light], shapes_, p, u);
    if (sample) {
        sample->pdf_w *= probability;
        sample->light = light;
    }
    return sample;
}

float Scene::light_pdf_w(const LitPoint& at, const SurfaceHit& hit) const {
    return light_tree_.probability(at, hit.light) * gib::light_pdf_w(*hit.emitter, shapes_, at.p, hit);
}

float Scene::environment_pdf_w(const LitPoint& at, const Vec3& w) const {
    if (!environment_) return 0.f;
    return light_tree_.probability(at, *environment_) * gib::environment_pdf_w(lights_[*environment_], w);
}

float Scene::light_pdf_w(const LitPoint& at, std::uint32_t light, const SurfacePoint& point, const Vec3& w) const {
    const float choice = light_tree_.probability(at, light);
    const Light& of = lights_[light];
    if (const auto* area = std::get_if<AreaLight>(&of)) return choice * gib::light_pdf_w(*area, shapes_, at.p, point);
    return is_environment(of) ? choice * gib::environment_pdf_w(of, -w) : choice;
}

EmissionSample Scene::sample_emission(float u_choice, const Vec2& u_position, const Vec2& u_direction) const {
    const auto choice = light_choice_.sample(u_choice);
    EmissionSample sample = gib::sample_emission(lights_[choice.index], shapes_, u_position, u_direction);
    if (choice.probability != 1.f) sample.power /= double{choice.probability};
    sample.light = static_cast<std::uint32_t>(choice.index);
    return sample;
}

Colord Scene::emitted_power() const {
    Colord power = Colord::Zero();
    for (const auto& light : lights_)
        power += power_of(light);
    return power;
}

}  // namespace gib
