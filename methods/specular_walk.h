#pragma once
// Paths that end at diffuse surfaces and in media, and go on by specular lobes: from the eye, or along a gather ray. The photon
// mapper's second pass is made of them. Source: Jensen 2001, chapter 9.

#include "methods/direct_light.h"
#include "methods/dispersed_path.h"

#include <algorithm>

namespace gib {

struct WalkSettings {
    int max_edges;          ///< edges of the longest path, whatever a visitor adds to it included
    bool samples_lights;    ///< off where no light can be sampled from anywhere
    bool follows_specular;  ///< off where no surface is specular
};

/// One path. A visitor is shown what it meets:
///  - emitted(radiance): light at the end of the specular path [W/(sr m^2)], times its throughput;
///  - diffuse(hit, wo, u): a surface with diffuse lobes; the path goes on by the specular ones, if there are any;
///  - scattered(p, wo): an event in a medium, where the path ends.
/// At the last two at least one more edge is allowed. A visitor whose `wants_emission` is false pays nothing for it,
/// and is told a throughput that is not finite only.
class SpecularWalk {
public:
    /// Starts in `medium` (null: nothing); all must outlive this.
    SpecularWalk(RayQueries& rays, const Sampler& sampler, const WalkSettings& settings, const Medium* medium)
        : rays_(rays),
          scene_(rays.scene()),
          sampler_(sampler),
          settings_(settings),
          flights_(sampler),
          medium_(medium) {}

    template <typename Visitor>
    void follow(TracedRay traced, Visitor& visitor) {
        Vec3 previous = traced.ray.o;
        std::uint32_t holes = 0;
        while (vertex_ < settings_.max_edges) {
            if (medium_ && ends_in_medium(traced, visitor)) return;
            auto hit = rays_.surface_hit(traced);
            const Vec3 wo = -traced.ray.d;
            if constexpr (Visitor::wants_emission) show_emission(traced, hit, previous, visitor);
            if (!hit) return;
            const float pass_through = hit->bsdf->pass_through();
            if (pass_through > 0.f && sampler_.get_1d(dimension::first_hole + holes++) < pass_through) {
                go_on(*hit, traced.ray.d, traced);
                continue;
            }
            if (vertex_ + 1 >= settings_.max_edges) return;

            length_ += (hit->p - previous).norm();
            if (scene_.has_dispersion()) disperse(scene_, sampler_.get_1d(dimension::stratum), *hit, stratum_, beta_);
            const VertexNumbers u = sampler_.at_vertex(vertex_);
            if (hit->bsdf->traits_at(hit->shading.to_local(wo).z()).diffuse) visitor.diffuse(*hit, wo, u);
            const auto wi = scatter_specularly(*hit, wo, u, visitor);
            if (!wi) return;
            previous = hit->p;
            go_on(*hit, *wi, traced);
            ++vertex_;
        }
    }

    // The path up to where a visitor is called:

    RayQueries& rays() const { return rays_; }
    const Sampler& sampler() const { return sampler_; }
    const WalkSettings& settings() const { return settings_; }
    const Color& throughput() const { return beta_; }  ///< f cos / pdf of all vertices before
    int vertex() const { return vertex_; }             ///< specular vertices before, which is edges - 1
    int edges_left() const { return settings_.max_edges - (vertex_ + 1); }
    std::optional<int> stratum() const {
        return stratum_;
    }                                                 ///< of wavelengths, if it has met a surface that splits light
    const Medium* medium() const { return medium_; }  ///< that it is in
    NumberStream& flights() { return flights_; }
    float length() const { return length_; }  ///< of its edges from surface to surface [scene units]

private:
    /// Paths among specular surfaces end by roulette from this vertex on; the path tracer's earlier, since its paths go
    /// on after diffuse surfaces, where a throughput near 1 is rare.
    static constexpr int first_roulette_vertex = 8;

    void go_on(const SurfaceHit& hit, const Vec3& wi, TracedRay& traced) {
        if (scene_.has_media()) medium_ = scene_.medium_beyond(hit, wi, medium_);
        traced.ray = hit.spawn_ray(wi);
        rays_.trace(traced);
    }

    template <typename Visitor>
    void show_emission(const TracedRay& traced, const std::optional<SurfaceHit>& hit, const Vec3& previous,
                       Visitor& visitor) {
        if (!hit) {
            visitor.emitted(beta_ * escaped_radiance(scene_, previous, pdf_w_, traced.ray.d));
            return;
        }
        const Color Le = hit->Le(-traced.ray.d);
        if (!is_black(Le)) visitor.emitted(beta_ * Le * bsdf_sampling_weight(scene_, previous, pdf_w_, *hit));
    }

    /// What the medium does to the path before it comes to a surface: true if it ends in the medium.
    template <typename Visitor>
    bool ends_in_medium(const TracedRay& traced, Visitor& visitor) {
        const Ray& ray = traced.ray;  // of unit direction; clip distances are the camera's
        const Vec3 from = ray.o + ray.t_min * ray.d;
        const float length = (traced.found ? traced.found->t : ray.t_max) - ray.t_min;
        const auto flight = medium_->sample_flight(from, ray.d, length, flights_, beta_);
        if (is_black(beta_)) return true;
        if (!flight) return false;
        if (vertex_ + 1 < settings_.max_edges) visitor.scattered(from + *flight * ray.d, -ray.d);
        return true;
    }

    /// The way on by a specular lobe, and what it shows of the lights; empty: the path ends here.
    template <typename Visitor>
    std::optional<Vec3> scatter_specularly(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u,
                                           Visitor& visitor) {
        const Vec3 wo_local = hit.shading.to_local(wo);
        const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
        if (!settings_.follows_specular || !lobes.specular()) return std::nullopt;
        const bool sees_lights = settings_.samples_lights && lobes.glossy;
        if constexpr (Visitor::wants_emission) {
            if (sees_lights) visitor.emitted(beta_ * direct_light_by_gloss(hit, wo_local, u));
        }
        const auto next =
            hit.bsdf->sample_local(wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::radiance, Lobes::specular);
        if (!next) return std::nullopt;
        beta_ *= next->f * (std::abs(next->wi.z()) / next->pdf_w);
        eta_scale_ *= sqr(next->eta);
        pdf_w_ = next->delta || !sees_lights ? infinity : next->pdf_w;
        if (vertex_ >= first_roulette_vertex && !survives(u.roulette(), visitor)) return std::nullopt;
        return hit.shading.to_world(next->wi);
    }

    Color direct_light_by_gloss(const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u) {
        constexpr auto both = LightTechniques::light_and_bsdf_sampling;
        return scene_.has_media()
                   ? sample_direct_light(rays_, hit, wo_local, u, {medium_, flights_}, both, Lobes::specular).specular
                   : sample_direct_light(rays_, hit, wo_local, u, both, Lobes::specular).specular;
    }

    template <typename Visitor>
    bool survives(float u, Visitor& visitor) {
        if (!beta_.isFinite().all()) {
            // Roulette would end the path in silence; the film counts it.
            visitor.emitted(beta_);
            return false;
        }
        const float survival = std::min(beta_.maxCoeff() * eta_scale_, 0.95f);
        if (!(u < survival)) return false;
        beta_ /= survival;
        return true;
    }

    RayQueries& rays_;
    const Scene& scene_;
    const Sampler& sampler_;
    const WalkSettings& settings_;
    NumberStream flights_;
    Color beta_ = Color::Ones();
    float eta_scale_ = 1.f;       ///< product of eta^2 that beta was divided by at refractions
    float pdf_w_ = infinity;      ///< density of the last direction; infinite: nothing else could have sampled it
    const Medium* medium_;        ///< that the path is in
    std::optional<int> stratum_;  ///< of wavelengths, once the path has met a surface that splits light
    int vertex_ = 0;
    float length_ = 0.f;
};

}  // namespace gib
