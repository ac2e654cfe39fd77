#include "methods/radiosity/view.h"

#include "methods/parts/gathering/final_gather.h"

namespace gib {

namespace {

/// Reflectance of the diffuse lobes at a hit seen from wo, in [0, 1]; 0 where there are none. If the diffuse lobes
/// are not ideal, it is the share of the light arriving from wo that they reflect.
Color diffuse_reflectance(const SurfaceHit& hit, const Vec3& wo) {
    const Vec3 wo_local = hit.shading.to_local(wo);
    if (const auto ideal = hit.bsdf->ideal_diffuse_reflectance(wo_local.z())) return *ideal;
    return hit.bsdf->coefficients_local(wo_local).diffuse;
}

/// Sums the light that patches reflect along a final gather ray: L = rho E / pi with the E of the patch.
class GatherRayVisitor {
public:
    static constexpr bool wants_emission = false;
    static constexpr int splits = 0;

    explicit GatherRayVisitor(const RadiosityModel& model) : model_(model) {}

    const Color& radiance() const { return radiance_; }
    void diffuse(const EyeVertex& vertex, const SurfaceHit& hit, const VertexNumbers&) {
        radiance_ += diffuse_reflectance(hit, vertex.wo) * model_.irradiance_of_patch(hit, vertex.wo) * inv_pi;
    }
    void emitted(const Color&) {}
    void scattered(const EyeVertex&, const Vec3&) {}

private:
    const RadiosityModel& model_;
    Color radiance_ = Color::Zero();
};

/// Samples a path from the eye up to the first surface; specular surfaces are left out.
class EyeVisitor {
public:
    static constexpr bool wants_emission = true;
    static constexpr int splits = 0;

    EyeVisitor(const RadiosityModel* model, const RadiosityViewSettings& settings)
        : model_(model), settings_(settings) {}

    const PixelSample& sample() const { return sample_; }

    void emitted(const Color& radiance) { sample_[Component::emission] += radiance; }
    void scattered(const EyeVertex&, const Vec3&) {}
    void diffuse(const EyeVertex& vertex, const SurfaceHit& hit, const VertexNumbers& u) {
        const Vec3& wo = vertex.wo;
        if (settings_.samples_lights)
            sample_[Component::direct] +=
                sample_direct_light(vertex.walk.rays, hit, hit.shading.to_local(wo), u, vertex.walk.surroundings(),
                                    LightTechniques::light_sampling_only, Lobes::diffuse)
                    .diffuse;
        if (!model_) return;
        if (settings_.gather > 0) sample_[Component::indirect] += gathered(vertex, hit);
        else sample_[Component::indirect] += diffuse_reflectance(hit, wo) * model_->irradiance(hit, wo) * inv_pi;
    }

private:
    Color gathered(const EyeVertex& vertex, const SurfaceHit& hit) {
        return gather_by_rays(vertex, hit, settings_.gather, 0, [&](const TracedRay& ray, const Sampler& u) {
            GatherRayVisitor visitor(*model_);
            follow_specular_path(vertex.walk.rays, u, ray, nullptr, {2, false, false}, visitor);
            return visitor.radiance();
        });
    }

    const RadiosityModel* model_;
    const RadiosityViewSettings& settings_;
    PixelSample sample_;
};

}  // namespace

PixelSample sample_radiosity(RayQueries& rays, const TracedRay& eye, const Sampler& sampler,
                             const RadiosityModel* model, const RadiosityViewSettings& settings) {
    EyeVisitor visitor(model, settings);
    follow_specular_path(rays, sampler, eye, nullptr, {settings.max_edges, settings.samples_lights, false}, visitor);
    return visitor.sample();
}

}  // namespace gib
