#include "methods/parts/photon_mapping/eye_pass.h"

#include "methods/parts/transport/direct_light.h"
#include "methods/parts/transport/pixel_samples.h"

#include <memory>

namespace gib {

namespace {

/// Dimensions of the random numbers that probe the disc of a look-up: they lie beyond all dimensions of
/// a path of 2^16 vertices.
constexpr std::uint32_t caustic_disc = dimension::at_vertex(1 << 16, 0);
constexpr std::uint32_t global_disc = caustic_disc + 1;

/// The tag of the split that gives eye paths for direct light numbers of their own.
constexpr std::uint64_t direct_tag = 0xd17ec7;

/// Which light an eye path adds up.
enum class EyeLight {
    all,
    straight,  ///< emission and direct light, which no map holds
    stored     ///< all other light
};

/// Adds up the light that one eye path meets, as a sample of its pixel.
template <EyeLight light>
class EyePathVisitor {
public:
    static constexpr bool wants_emission = light != EyeLight::stored;
    static constexpr int splits = 2;

    /// Adds to `sample`. All arguments must outlive this.
    EyePathVisitor(const PhotonMaps& maps, const WalkSettings& settings, PixelBlock& block, BiasedSample& sample)
        : maps_(maps), settings_(settings), block_(block), sample_(sample) {}

    void emitted(const Color& radiance) { sample_.light[Component::emission] += radiance; }

    /// Adds the light that a scattering event at p in a medium sends towards wo: straight from a light, by light
    /// sampling, and all other from the volume map (Jensen and Christensen 1998; Jensen 2001, chapter 10).
    void scattered(const EyeVertex& vertex, const Vec3& p) {
        if constexpr (light == EyeLight::straight) return;
        PathWalk& walk = vertex.walk;
        Color radiance = Color::Zero();
        if (settings_.samples_lights)
            radiance += sample_direct_light(walk.rays, p, vertex.wo, walk.vertex_numbers, walk.surroundings(),
                                            LightTechniques::light_sampling_only);
        if (maps_.volume.size() > 0) {
            const Medium& medium = *walk.at.medium;
            const Scattered found = maps_.volume_estimator.within(medium.mean_free_path_at(p))
                                        .scattered_radiance(maps_.volume, walk.rays, p, medium.phase(), vertex.wo,
                                                            eye_path(vertex), walk.flights);
            radiance += found.radiance;
            sample_.bias[Component::volume] += vertex.throughput() * found.bias;
        }
        sample_.light[Component::volume] += vertex.throughput() * radiance;
    }

    bool crosses_media() const { return maps_.along_rays.has_value(); }
    /// Adds the light that a stretch in a medium scatters towards its start, straight from a light or not.
    void crossed(const EyeVertex& vertex, const MediumStretch& stretch) {
        if constexpr (light == EyeLight::straight) return;
        const Scattered found =
            maps_.along_rays->radiance(stretch, eye_path(vertex), vertex.walk.rays, block_.near_ray);
        sample_.light[Component::volume] += vertex.throughput() * found.radiance;
        sample_.bias[Component::volume] += vertex.throughput() * found.bias;
    }

    /// Adds the light that a diffuse surface reflects towards wo. Its integral is split by how light arrives (Jensen
    /// 2001, section 9.2): straight from a light, by way of specular surfaces only (caustic), or
    /// after a diffuse reflection (indirect).
    void diffuse(const EyeVertex& vertex, const SurfaceHit& hit, const VertexNumbers& u) {
        if (light != EyeLight::stored && settings_.samples_lights)
            sample_.light[Component::direct] += vertex.throughput() * direct_light(vertex, hit, u);
        if constexpr (light == EyeLight::straight) return;
        look_up(maps_.caustic, maps_.caustic_estimator, vertex, hit, Component::caustic, caustic_disc, block_.caustic);
        if (const auto other = maps_.at_diffuse ? maps_.at_diffuse->indirect(vertex, hit, block_.pixel) : std::nullopt)
            sample_.light[Component::indirect] += vertex.throughput() * *other;
        else
            look_up(maps_.global, maps_.global_estimator, vertex, hit, Component::indirect, global_disc, block_.global);
    }

private:
    /// Adds the radiance that the density of photons around the hit gives (Jensen 2001, chapter 7).
    void look_up(const PhotonMap& map, const DensityEstimator& estimator, const EyeVertex& vertex,
                 const SurfaceHit& hit, Component component, std::uint32_t disc, LastLookUp& last) {
        if (map.size() == 0) return;
        const Reflected found = estimator.reflected_radiance(map, vertex.walk.rays, hit, vertex.wo, eye_path(vertex),
                                                             vertex.walk.sampler, disc, &last);
        sample_.light[component] += vertex.throughput() * found.between_surfaces;
        if (!is_black(found.through_media))
            sample_.light[Component::volume] += vertex.throughput() * found.through_media;
        if (!estimator.estimates_bias) return;
        sample_.bias[component] += vertex.throughput() * found.bias_between_surfaces;
        sample_.bias[Component::volume] += vertex.throughput() * found.bias_through_media;
    }

    /// Direct light at the diffuse lobes of `hit`, by light sampling; rough lobes also follow a sample of the bsdf.
    Color direct_light(const EyeVertex& vertex, const SurfaceHit& hit, const VertexNumbers& u) {
        RayQueries& rays = vertex.walk.rays;
        if (const auto other = maps_.at_diffuse ? maps_.at_diffuse->direct(rays, hit, vertex.wo, u) : std::nullopt)
            return *other;
        const Vec3 wo_local = hit.shading.to_local(vertex.wo);
        // A rough lobe has a preferred direction, which light sampling would hit by chance only.
        const bool follows = hit.bsdf->traits_at(wo_local.z()).rough && !rays.scene().has_media();
        const auto techniques =
            follows ? LightTechniques::light_and_bsdf_sampling : LightTechniques::light_sampling_only;
        const Color sampled =
            sample_direct_light(rays, hit, wo_local, u, vertex.walk.surroundings(), techniques, Lobes::diffuse).diffuse;
        return follows ? Color(sampled + follow_to_light(rays, hit, wo_local, u, Lobes::diffuse).diffuse) : sampled;
    }

    static EyePath eye_path(const EyeVertex& vertex) { return {vertex.edges_left, vertex.walk.at.stratum}; }

    const PhotonMaps& maps_;
    const WalkSettings& settings_;
    PixelBlock& block_;
    BiasedSample& sample_;
};

/// Adds the light of one eye path to `sample`.
template <EyeLight light>
void follow_eye_path(const PhotonMaps& maps, const WalkSettings& settings, RayQueries& rays, const TracedRay& eye,
                     const Sampler& sampler, PixelBlock& block, BiasedSample& sample) {
    EyePathVisitor<light> visitor(maps, settings, block, sample);
    follow_specular_path(rays, sampler, eye, rays.scene().camera_medium(), settings, visitor);
}

}  // namespace

const BiasedSample& EyePass::sample(RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
    std::construct_at(&sample_);  // in place, since an assignment would wait for the parts of what it copies
    follow_eye_path<EyeLight::all>(maps_, settings_, rays, eye, sampler, block_, sample_);
    return sample_;
}

const PixelSample& EyePass::sample_split(RayQueries& rays, const TracedRay& eye, const Sampler& sampler,
                                         std::size_t pixel, int direct_samples) {
    block_.pixel = pixel;
    if (direct_samples == 1) return sample(rays, eye, sampler).light;
    std::construct_at(&sample_);
    follow_eye_path<EyeLight::stored>(maps_, settings_, rays, eye, sampler, block_, sample_);
    PixelSample& light = sample_.light;
    const Sensor& sensor = rays.scene().sensor();
    const auto width = static_cast<std::size_t>(sensor.width());
    const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
    const auto paths = static_cast<std::uint32_t>(direct_samples);
    const float share = 1.f / static_cast<float>(direct_samples);
    const auto sampler_of = [&](std::size_t i) {
        return sampler.split(static_cast<std::uint32_t>(i), paths, direct_tag);
    };
    const auto ray_of = [&](std::size_t i) { return sensor.sample_ray(x, y, sampler_of(i)); };
    for_each_camera_ray(rays, paths, ray_of, [&](std::size_t i, const TracedRay& ray) {
        BiasedSample straight;
        follow_eye_path<EyeLight::straight>(maps_, settings_, rays, ray, sampler_of(i), block_, straight);
        for (const Component c : {Component::emission, Component::direct})
            light[c] += share * straight.light[c];
    });
    return light;
}

}  // namespace gib
