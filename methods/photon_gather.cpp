#include "methods/photon_gather.h"

#include "methods/direct_light.h"
#include "methods/dispersed_path.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// Eye paths among specular surfaces end by roulette from this vertex on; the path tracer's earlier, since its paths go
/// on after diffuse surfaces, where a throughput near 1 is rare.
constexpr int first_roulette_vertex = 8;

/// Where the disc or ball of a look-up is probed: past all dimensions of a path of 2^16 vertices.
constexpr std::uint32_t caustic_disc = dimension::at_vertex(1 << 16, 0);
constexpr std::uint32_t global_disc = caustic_disc + 1;
constexpr std::uint32_t volume_ball = caustic_disc + 2;

}  // namespace

class PhotonGather::Path {
public:
    Path(PhotonGather& gather, RayQueries& rays, const Sampler& sampler)
        : maps_(gather.maps_),
          settings_(gather.settings_),
          found_(gather.found_),
          rays_(rays),
          scene_(rays.scene()),
          sampler_(sampler),
          flights_(sampler),
          medium_(scene_.camera_medium()) {}

    PixelSample follow(TracedRay traced) {
        Vec3 previous = traced.ray.o;
        std::uint32_t holes = 0;
        while (vertex_ < settings_.max_edges) {
            if (medium_ && ends_in_medium(traced)) break;
            auto hit = rays_.surface_hit(traced);
            if (!hit) {
                sample_[Component::emission] += beta_ * escaped_radiance(scene_, previous, pdf_w_, traced.ray.d);
                break;
            }
            const Vec3 wo = -traced.ray.d;
            const Color Le = hit->Le(wo);
            if (!is_black(Le))
                sample_[Component::emission] += beta_ * Le * bsdf_sampling_weight(scene_, previous, pdf_w_, *hit);
            const float pass_through = hit->bsdf->pass_through();
            if (pass_through > 0.f && sampler_.get_1d(dimension::first_hole + holes++) < pass_through) {
                go_on(*hit, traced.ray.d, traced);
                continue;
            }
            if (vertex_ + 1 >= settings_.max_edges) break;

            if (scene_.has_dispersion()) disperse(scene_, sampler_.get_1d(dimension::stratum), *hit, stratum_, beta_);
            const VertexNumbers u = sampler_.at_vertex(vertex_);
            if (hit->bsdf->traits_at(hit->shading.to_local(wo).z()).diffuse) add_diffuse(*hit, wo, u);
            const auto wi = scatter_specularly(*hit, wo, u);
            if (!wi) break;
            previous = hit->p;
            go_on(*hit, *wi, traced);
            ++vertex_;
        }
        return sample_;
    }

private:
    void go_on(const SurfaceHit& hit, const Vec3& wi, TracedRay& traced) {
        if (scene_.has_media()) medium_ = scene_.medium_beyond(hit, wi, medium_);
        traced.ray = hit.spawn_ray(wi);
        rays_.trace(traced);
    }

    /// What the medium does to the path before it comes to a surface: true if it ends in the medium.
    bool ends_in_medium(const TracedRay& traced) {
        const Ray& ray = traced.ray;  // of unit direction; clip distances are the camera's
        const Vec3 from = ray.o + ray.t_min * ray.d;
        const float length = (traced.found ? traced.found->t : ray.t_max) - ray.t_min;
        const auto flight = medium_->sample_flight(from, ray.d, length, flights_, beta_);
        if (is_black(beta_)) return true;
        if (!flight) return false;
        if (vertex_ + 1 < settings_.max_edges) add_scattered(from + *flight * ray.d, -ray.d);
        return true;
    }

    /// The two ways in which light reaches a scattering event.
    void add_scattered(const Vec3& p, const Vec3& wo) {
        Color radiance = Color::Zero();
        if (settings_.samples_lights)
            radiance += sample_direct_light(rays_, p, wo, sampler_.at_vertex(vertex_), {medium_, flights_},
                                            LightTechniques::light_sampling_only);
        if (maps_.volume.size() > 0)
            radiance += maps_.volume_estimator.scattered_radiance(maps_.volume, rays_, p, medium_->phase(), wo, eye(),
                                                                  sampler_, volume_ball, found_);
        sample_[Component::volume] += beta_ * radiance;
    }

    /// The three ways in which light reaches the first diffuse surface.
    void add_diffuse(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) {
        if (settings_.samples_lights) sample_[Component::direct] += beta_ * direct_light(hit, wo, u);
        const auto look_up = [&](const PhotonMap& map, const DensityEstimator& estimator, Component component,
                                 std::uint32_t disc) {
            if (map.size() == 0) return;
            const Reflected light = estimator.reflected_radiance(map, rays_, hit, wo, eye(), sampler_, disc, found_);
            sample_[component] += beta_ * light.between_surfaces;
            if (!is_black(light.through_media)) sample_[Component::volume] += beta_ * light.through_media;
        };
        look_up(maps_.caustic, maps_.caustic_estimator, Component::caustic, caustic_disc);
        look_up(maps_.global, maps_.global_estimator, Component::indirect, global_disc);
    }

    Color direct_light(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) {
        const Vec3 wo_local = hit.shading.to_local(wo);
        if (scene_.has_media())
            return sample_direct_light(rays_, hit, wo_local, u, {medium_, flights_},
                                       LightTechniques::light_sampling_only, Lobes::diffuse)
                .diffuse;
        const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
        if (maps_.light_visibility && !lobes.rough && !hit.bsdf->traits().transmission)
            return maps_.light_visibility->sample_direct_light(rays_, hit, wo, u);
        // A lobe with a preferred direction is better followed than hit by chance.
        if (!lobes.rough)
            return sample_direct_light(rays_, hit, wo_local, u, LightTechniques::light_sampling_only, Lobes::diffuse)
                .diffuse;
        return sample_direct_light(rays_, hit, wo_local, u, LightTechniques::light_and_bsdf_sampling, Lobes::diffuse)
                   .diffuse +
               follow_to_light(rays_, hit, wo_local, u, Lobes::diffuse).diffuse;
    }

    /// The way on by a specular lobe, and what it shows of the lights; empty: the path ends here.
    std::optional<Vec3> scatter_specularly(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) {
        const Vec3 wo_local = hit.shading.to_local(wo);
        const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
        if (!settings_.follows_specular || !lobes.specular()) return std::nullopt;
        const bool sees_lights = settings_.samples_lights && lobes.glossy;
        if (sees_lights) {
            constexpr auto both = LightTechniques::light_and_bsdf_sampling;
            const LobeValues direct =
                scene_.has_media()
                    ? sample_direct_light(rays_, hit, wo_local, u, {medium_, flights_}, both, Lobes::specular)
                    : sample_direct_light(rays_, hit, wo_local, u, both, Lobes::specular);
            sample_[Component::emission] += beta_ * direct.specular;
        }
        const auto next =
            hit.bsdf->sample_local(wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::radiance, Lobes::specular);
        if (!next) return std::nullopt;
        beta_ *= next->f * (std::abs(next->wi.z()) / next->pdf_w);
        eta_scale_ *= sqr(next->eta);
        pdf_w_ = next->delta || !sees_lights ? infinity : next->pdf_w;
        if (vertex_ >= first_roulette_vertex && !survives(u.roulette())) return std::nullopt;
        return hit.shading.to_world(next->wi);
    }

    bool survives(float u) {
        if (!beta_.isFinite().all()) {
            sample_[Component::emission] += beta_;  // roulette would end the path in silence; the film counts it
            return false;
        }
        const float survival = std::min(beta_.maxCoeff() * eta_scale_, 0.95f);
        if (!(u < survival)) return false;
        beta_ /= survival;
        return true;
    }

    EyePath eye() const { return {settings_.max_edges - (vertex_ + 1), stratum_}; }

    const PhotonMaps& maps_;
    const GatherSettings& settings_;
    std::vector<PhotonMap::Neighbour>& found_;
    RayQueries& rays_;
    const Scene& scene_;
    const Sampler& sampler_;
    NumberStream flights_;

    PixelSample sample_;
    Color beta_ = Color::Ones();
    float eta_scale_ = 1.f;       // product of eta^2 that beta was divided by at refractions
    float pdf_w_ = infinity;      // density of the last direction; infinite: nothing else could have sampled it
    const Medium* medium_;        // that the path is in
    std::optional<int> stratum_;  // of wavelengths, once the path has met a surface that splits light
    int vertex_ = 0;
};

PixelSample PhotonGather::sample(RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
    return Path(*this, rays, sampler).follow(eye);
}

}  // namespace gib
