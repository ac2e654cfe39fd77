#pragma once
// Paths, from the eye or along a gather ray, that go on by specular lobes and show a visitor the diffuse surfaces and
// media that they meet. The photon mapper's eye pass consists of them. Source: Jensen 2001, section 9.4.

#include "methods/parts/transport/direct_light.h"
#include "methods/parts/transport/dispersed_path.h"
#include "methods/parts/transport/roulette.h"
#include "methods/parts/transport/scattered_ray.h"

#include <algorithm>

namespace gib {

struct WalkSettings {
    int max_edges;          ///< edges of the longest path, including those that a visitor adds
    bool samples_lights;    ///< false where no light can be sampled from anywhere
    bool follows_specular;  ///< false where no surface is specular
};

/// One path, or a tree of paths: at its first smooth interfaces between dielectrics, as many as the visitor's
/// `splits`, both the reflected and the transmitted path are followed. If one of them were chosen at random, the
/// reflection of a lamp in glass, 25 times brighter than its mean, would be the noisiest part of an image. The
/// visitor is called for:
///  - emitted(radiance): light at the end of the specular path [W/(sr m^2)], times its throughput;
///  - diffuse(hit, wo, u): a surface with diffuse lobes; the path goes on by the specular lobes, if there are any;
///  - scattered(p, wo): a scattering event in a medium, where the path ends.
/// In the last two cases at least one more edge is allowed. For a visitor whose `wants_emission` is false emission is
/// not computed, and emitted() is called only with a throughput that is not finite.
class SpecularWalk {
public:
    /// Starts in `medium`; null stands for vacuum. All arguments must outlive this.
    SpecularWalk(RayQueries& rays, const Sampler& sampler, const WalkSettings& settings, const Medium* medium)
        : rays_(rays), scene_(rays.scene()), sampler_(sampler), settings_(settings), flights_(sampler) {
        at_.medium = medium;
    }

    /// Follows the path along a ray that was traced.
    template <typename Visitor>
    void follow(const TracedRay& traced, Visitor& visitor) {
        at_.splits_left = Visitor::splits;
        follow_from(traced.ray.o, traced, visitor);
    }

    // The state of the path where a visitor is called:

    RayQueries& rays() const { return rays_; }
    const Sampler& sampler() const { return sampler_; }
    const WalkSettings& settings() const { return settings_; }
    const Color& throughput() const { return at_.beta; }  ///< product of f cos / pdf over the vertices before
    int vertex() const { return at_.vertex; }             ///< number of specular vertices before: edges - 1
    int edges_left() const { return settings_.max_edges - (at_.vertex + 1); }
    /// Stratum of wavelengths, if the path has met a surface that splits light.
    std::optional<int> stratum() const { return at_.stratum; }
    const Medium* medium() const { return at_.medium; }  ///< that the path is in
    NumberStream& flights() { return flights_; }
    float length() const { return at_.length; }  ///< [scene units] from surface to surface

private:
    /// Russian roulette starts at this vertex. The path tracer's starts earlier, since its paths go on after diffuse
    /// surfaces, where a throughput near 1 is rare.
    static constexpr int first_roulette_vertex = 8;

    /// Follows the path from `previous` along a ray that was traced, until the path ends.
    template <typename Visitor>
    void follow_from(Vec3 previous, TracedRay traced, Visitor& visitor) {
        while (at_.vertex < settings_.max_edges) {
            if (at_.medium && ends_in_medium(traced, visitor)) return;
            auto hit = rays_.surface_hit(traced);
            const Vec3 wo = -traced.ray.d;
            if constexpr (Visitor::wants_emission) show_emission(traced, hit, previous, visitor);
            if (!hit) return;
            const float pass_through = hit->bsdf->pass_through();
            if (pass_through > 0.f && sampler_.get_1d(dimension::first_hole + at_.holes++) < pass_through) {
                go_on(*hit, traced.ray.d, traced);
                continue;
            }
            if (at_.vertex + 1 >= settings_.max_edges) return;

            at_.length += (hit->p - previous).norm();
            if (scene_.has_dispersion())
                disperse(scene_, sampler_.get_1d(dimension::stratum), *hit, at_.stratum, at_.beta);
            if (at_.splits_left > 0 && split(*hit, wo, traced, visitor)) return;
            const VertexNumbers u = sampler_.at_vertex(at_.vertex);
            if (!hit->delta_only && hit->bsdf->traits_at(hit->shading.to_local(wo).z()).diffuse)
                visitor.diffuse(*hit, wo, u);
            const auto wi = scatter_specularly(*hit, wo, u, visitor);
            if (!wi) return;
            previous = hit->p;
            go_on(*hit, *wi, traced);
            ++at_.vertex;
        }
    }

    /// Follows both ways on from a smooth interface. Returns false, and does nothing, if the hit is no such interface
    /// or only one way carries light.
    template <typename Visitor>
    bool split(const SurfaceHit& hit, const Vec3& wo, TracedRay& traced, Visitor& visitor) {
        if (!settings_.follows_specular) return false;
        const auto ways = both_ways(hit, hit.shading.to_local(wo), Transport::radiance);
        if (!ways) return false;
        --at_.splits_left;
        const State here = at_;
        for (const ScatteredRay& way : *ways) {
            at_ = here;
            take(way, infinity);
            if (is_black(at_.beta)) continue;
            go_on(hit, way.wi, traced);
            ++at_.vertex;
            follow_from(hit.p, traced, visitor);
        }
        return true;
    }

    /// Adds a scattered ray to the throughput. `pdf_w` is its density [1/sr] for the weight against light sampling.
    void take(const ScatteredRay& way, float pdf_w) {
        at_.beta *= way.weight;
        at_.eta_scale *= sqr(way.eta);
        at_.pdf_w = pdf_w;
    }

    /// Traces the ray from the hit along wi.
    void go_on(const SurfaceHit& hit, const Vec3& wi, TracedRay& traced) {
        if (scene_.has_media()) at_.medium = scene_.medium_beyond(hit, wi, at_.medium);
        traced.ray = hit.spawn_ray(wi);
        rays_.trace(traced);
    }

    /// Shows the visitor the light at the end of the ray, weighted against light sampling from `previous`.
    template <typename Visitor>
    void show_emission(const TracedRay& traced, const std::optional<SurfaceHit>& hit, const Vec3& previous,
                       Visitor& visitor) {
        if (!hit) {
            visitor.emitted(at_.beta * escaped_radiance(scene_, previous, at_.pdf_w, traced.ray.d));
            return;
        }
        const Color Le = hit->Le(-traced.ray.d);
        if (!is_black(Le)) visitor.emitted(at_.beta * Le * bsdf_sampling_weight(scene_, previous, at_.pdf_w, *hit));
    }

    /// Samples a free flight through the medium before the next surface. Returns true if the path ends in the medium.
    template <typename Visitor>
    bool ends_in_medium(const TracedRay& traced, Visitor& visitor) {
        const Ray& ray = traced.ray;  // d is a unit vector; t_min and t_max clip a camera's rays
        const Vec3 from = ray.o + ray.t_min * ray.d;
        const float length = (traced.found ? traced.found->t : ray.t_max) - ray.t_min;
        const auto flight = at_.medium->sample_flight(from, ray.d, length, flights_, at_.beta);
        if (is_black(at_.beta)) return true;
        if (!flight) return false;
        if (at_.vertex + 1 < settings_.max_edges) visitor.scattered(from + *flight * ray.d, -ray.d);
        return true;
    }

    /// Samples a direction by the specular lobes, and shows the visitor the light that glossy ones scatter straight
    /// from the lights. Empty if the path ends here.
    template <typename Visitor>
    std::optional<Vec3> scatter_specularly(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u,
                                           Visitor& visitor) {
        const Vec3 wo_local = hit.shading.to_local(wo);
        const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
        if (!settings_.follows_specular || !lobes.specular()) return std::nullopt;
        const bool sees_lights = settings_.samples_lights && lobes.glossy;
        if constexpr (Visitor::wants_emission) {
            if (sees_lights) visitor.emitted(at_.beta * direct_light_by_gloss(hit, wo_local, u));
        }
        const auto next =
            sample_scattering(hit, wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::radiance, Lobes::specular);
        if (!next) return std::nullopt;
        take(*next, next->delta || !sees_lights ? infinity : next->pdf_w);
        const float most = next->delta ? most_specular_survival(at_.vertex) : most_survival(at_.vertex);
        if (at_.vertex >= first_roulette_vertex && !survives(most, u.roulette(), visitor)) return std::nullopt;
        return next->wi;
    }

    Color direct_light_by_gloss(const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u) {
        constexpr auto both = LightTechniques::light_and_bsdf_sampling;
        return scene_.has_media()
                   ? sample_direct_light(rays_, hit, wo_local, u, {at_.medium, flights_}, both, Lobes::specular)
                         .specular
                   : sample_direct_light(rays_, hit, wo_local, u, both, Lobes::specular).specular;
    }

    /// Russian roulette; false if the path ends.
    template <typename Visitor>
    bool survives(float most, float u, Visitor& visitor) {
        if (!at_.beta.isFinite().all()) {
            // Roulette would drop this throughput without notice; the film counts it.
            visitor.emitted(at_.beta);
            return false;
        }
        const float survival = std::min(at_.beta.maxCoeff() * at_.eta_scale, most);
        if (!(u < survival)) return false;
        at_.beta /= survival;
        return true;
    }

    RayQueries& rays_;
    const Scene& scene_;
    const Sampler& sampler_;
    const WalkSettings& settings_;
    NumberStream flights_;

    /// The state of a path at its current vertex.
    struct State {
        Color beta = Color::Ones();
        float eta_scale = 1.f;  ///< the product of eta^2 by which refractions have divided beta
        /// Density [1/sr] of the last direction; infinite if light sampling could not find it.
        float pdf_w = infinity;
        const Medium* medium = nullptr;   ///< that the path is in
        std::optional<int> stratum = {};  ///< of wavelengths, once the path has met dispersion
        int vertex = 0;
        std::uint32_t holes = 0;  ///< holes passed so far
        float length = 0.f;       ///< [scene units]
        int splits_left = 0;
    };
    State at_;
};

}  // namespace gib
