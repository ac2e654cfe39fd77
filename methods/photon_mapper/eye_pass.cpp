#include "methods/photon_mapper/eye_pass.h"

#include "methods/parts/transport/direct_light.h"

namespace gib {

namespace {

/// Dimensions of the random numbers that probe the disc of a look-up: they lie beyond all dimensions of
/// a path of 2^16 vertices.
constexpr std::uint32_t caustic_disc = dimension::at_vertex(1 << 16, 0);
constexpr std::uint32_t global_disc = caustic_disc + 1;
/// The first of the dimensions that probe the ball of a look-up in a medium, which takes as many of them as it needs.
constexpr std::uint32_t volume_ball = 0x60000000;

}  // namespace

/// Adds up the light that one eye path meets, as a sample of its pixel.
class EyePass::EyePathVisitor {
public:
    static constexpr bool wants_emission = true;
    static constexpr int splits = 2;

    EyePathVisitor(EyePass& pass, SpecularWalk& walk)
        : maps_(pass.maps_), neighbours_(pass.neighbours_), walk_(walk), rays_(walk.rays()), scene_(rays_.scene()) {}

    const PixelSample& sample() const { return sample_; }

    void emitted(const Color& radiance) { sample_[Component::emission] += radiance; }

    /// Adds the light that a scattering event at p in a medium sends towards wo: straight from a light, by light
    /// sampling, and all other from the volume map (Jensen and Christensen 1998; Jensen 2001, chapter 10).
    void scattered(const Vec3& p, const Vec3& wo) {
        Color radiance = Color::Zero();
        if (walk_.settings().samples_lights)
            radiance += sample_direct_light(rays_, p, wo, walk_.sampler().at_vertex(walk_.vertex()),
                                            {walk_.medium(), walk_.flights()}, LightTechniques::light_sampling_only);
        if (maps_.volume.size() > 0)
            radiance += maps_.volume_estimator.scattered_radiance(maps_.volume, rays_, p, walk_.medium()->phase(), wo,
                                                                  eye(), walk_.sampler(), volume_ball, neighbours_);
        sample_[Component::volume] += walk_.throughput() * radiance;
    }

    /// Adds the light that a diffuse surface reflects towards wo. Its integral is split by how light arrives (Jensen
    /// 2001, section 9.2): straight from a light, by way of specular surfaces only (caustic), or
    /// after a diffuse reflection (indirect).
    void diffuse(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) {
        if (walk_.settings().samples_lights)
            sample_[Component::direct] += walk_.throughput() * direct_light(hit, wo, u);
        look_up(maps_.caustic, maps_.caustic_estimator, hit, wo, Component::caustic, caustic_disc);
        if (maps_.final_gather) sample_[Component::indirect] += walk_.throughput() * gathered(hit, wo);
        else look_up(maps_.global, maps_.global_estimator, hit, wo, Component::indirect, global_disc);
    }

private:
    /// Adds the radiance that the density of photons around the hit gives (Jensen 2001, chapter 7).
    void look_up(const PhotonMap& map, const DensityEstimator& estimator, const SurfaceHit& hit, const Vec3& wo,
                 Component component, std::uint32_t disc) {
        if (map.size() == 0) return;
        const Reflected light =
            estimator.reflected_radiance(map, rays_, hit, wo, eye(), walk_.sampler(), disc, neighbours_);
        sample_[component] += walk_.throughput() * light.between_surfaces;
        if (!is_black(light.through_media)) sample_[Component::volume] += walk_.throughput() * light.through_media;
    }

    /// Indirect light by final gathering, from the irradiance cache where it has records and else by rays.
    Color gathered(const SurfaceHit& hit, const Vec3& wo) {
        const auto cached =
            maps_.cache ? maps_.cache->reflected_radiance(walk_, hit, wo, neighbours_) : std::optional<Color>();
        return cached ? *cached : maps_.final_gather->reflected_radiance(walk_, hit, wo, neighbours_);
    }

    /// Direct light at the diffuse lobes of `hit`, by light sampling; rough lobes also follow a sample of the bsdf.
    Color direct_light(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) {
        const Vec3 wo_local = hit.shading.to_local(wo);
        if (scene_.has_media())
            return sample_direct_light(rays_, hit, wo_local, u, {walk_.medium(), walk_.flights()},
                                       LightTechniques::light_sampling_only, Lobes::diffuse)
                .diffuse;
        const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
        if (maps_.light_visibility && !lobes.rough && !hit.bsdf->traits().transmission)
            return maps_.light_visibility->sample_direct_light(rays_, hit, wo, u);
        // A rough lobe has a preferred direction, which light sampling would hit by chance only.
        if (!lobes.rough)
            return sample_direct_light(rays_, hit, wo_local, u, LightTechniques::light_sampling_only, Lobes::diffuse)
                .diffuse;
        return sample_direct_light(rays_, hit, wo_local, u, LightTechniques::light_and_bsdf_sampling, Lobes::diffuse)
                   .diffuse +
               follow_to_light(rays_, hit, wo_local, u, Lobes::diffuse).diffuse;
    }

    EyePath eye() const { return {walk_.edges_left(), walk_.stratum()}; }

    const PhotonMaps& maps_;
    std::vector<PhotonMap::Neighbour>& neighbours_;
    SpecularWalk& walk_;
    RayQueries& rays_;
    const Scene& scene_;
    PixelSample sample_;
};

PixelSample EyePass::sample(RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
    SpecularWalk walk(rays, sampler, settings_, rays.scene().camera_medium());
    EyePathVisitor visitor(*this, walk);
    walk.follow(eye, visitor);
    return visitor.sample();
}

}  // namespace gib
