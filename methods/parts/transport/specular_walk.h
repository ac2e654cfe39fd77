#pragma once
// Paths, from the eye or along a gather ray, that go on by specular lobes and show a visitor the diffuse surfaces and
// media that they meet. The photon mapper's eye pass consists of them. Source: Jensen 2001, section 9.4.

#include "methods/parts/transport/path_walk.h"

namespace gib {

struct WalkSettings {
    int max_edges;          ///< edges of the longest path, including those that a visitor adds
    bool samples_lights;    ///< false where no light can be sampled from anywhere
    bool follows_specular;  ///< false where no surface is specular
};

/// A place on an eye path that a visitor is shown, with the path up to it. At least one more edge is allowed.
struct EyeVertex {
    PathWalk& walk;  ///< walk whose ray ends here
    Vec3 wo;         ///< unit, towards where the path came from
    int edges_left;  ///< number of edges that the limit on the length of paths leaves
    float length;    ///< length of the path up to here [scene units]

    const Color& throughput() const { return walk.at.beta; }
};

/// One path, or a tree of paths: at its first smooth interfaces between dielectrics and its first thin sheets, together
/// as many as the visitor's `splits`, both the reflected and the transmitted path are followed. If one of them were
/// chosen at random, the reflection of a lamp in glass, 25 times brighter than its mean, would be the noisiest part of an
/// image. The visitor is called for:
///  - emitted(radiance): light at the end of the specular path [W/(sr m^2)], times its throughput;
///  - diffuse(vertex, hit, u): a surface with diffuse lobes; the path goes on by the specular lobes, if there are any;
///  - scattered(vertex, p): a scattering event at p in a medium, where the path ends;
///  - crossed(vertex, stretch), if it has this function and crosses_media() holds: a whole stretch through a medium, instead
///    of an event. The path goes on beyond it with the share of light that passes.
/// For a visitor whose `wants_emission` is false emission is not computed, and emitted() is called only with a
/// throughput that is not finite.
template <typename Visitor>
class SpecularWalk {
public:
    /// `walk` is at the start of the path. All arguments must outlive this.
    SpecularWalk(PathWalk& walk, const WalkSettings& settings, Visitor& visitor)
        : walk_(walk), at_(walk.at), settings_(settings), visitor_(visitor) {}

    void follow() { follow(Visitor::splits); }

private:
    /// Russian roulette starts at this vertex. The path tracer's starts earlier, since its paths go on after diffuse
    /// surfaces, where a throughput near 1 is rare.
    static constexpr int first_roulette_vertex = 8;

    /// Follows the path until it ends; it may split as often as `splits` says.
    void follow(int splits) {
        while (at_.vertex < settings_.max_edges) {
            const bool is_last = at_.vertex + 1 >= settings_.max_edges;
            const Flight flight = fly(is_last);
            if (flight.scattering_at && !is_last) visitor_.scattered(vertex(), *flight.scattering_at);
            if (flight.is_black || flight.scattering_at) return;
            auto hit = walk_.surface_hit();
            if constexpr (Visitor::wants_emission) visitor_.emitted(walk_.emitted(hit));
            if (!hit) return;
            if (splits > 0 && split_at_sheet(*hit, is_last, splits)) return;
            if (walk_.passes_through(*hit)) continue;
            if (is_last) return;

            length_ += (hit->p - at_.previous).norm();
            walk_.disperse(*hit, dimension::stratum);
            if (splits > 0 && split(*hit, splits)) return;
            const VertexNumbers u = walk_.vertex_numbers;
            const Vec3 wo_local = hit->shading.to_local(walk_.wo());
            if (!hit->delta_only && hit->bsdf->traits_at(wo_local.z()).diffuse) visitor_.diffuse(vertex(), *hit, u);
            const auto wi = scatter_specularly(*hit, wo_local, u);
            if (!wi) return;
            walk_.go_on(*hit, *wi);
        }
    }

    /// The flight to the end of the ray, or a scattering event before it.
    Flight fly(bool is_last) {
        if constexpr (requires { visitor_.crosses_media(); }) {
            if (at_.medium && visitor_.crosses_media()) {
                const MediumStretch stretch = walk_.stretch();
                if (!is_last && stretch.medium.scatters()) visitor_.crossed(vertex(), stretch);
                at_.beta *= stretch.transmittance.at(stretch.length);
                return {.is_black = is_black(at_.beta)};
            }
        }
        return walk_.fly();
    }

    /// Follows both the way straight on through a thin sheet, which is no vertex, and, unless this vertex is the last,
    /// the reflected one. Returns false, and does nothing, if the hit is no such sheet.
    bool split_at_sheet(const SurfaceHit& hit, bool is_last, int splits) {
        if (!settings_.follows_specular || !hit.bsdf->is_sheet()) return false;
        const PathState here = at_;
        const float length = length_;
        const Vec3 wo = walk_.wo();
        at_.beta *= hit.straight_on(wo);
        if (!is_black(at_.beta)) {
            walk_.go_straight_on(hit);
            follow(splits - 1);
        }
        if (is_last) return true;
        at_ = here;
        length_ = length + (hit.p - at_.previous).norm();
        const auto wi = scatter_specularly(hit, hit.shading.to_local(wo), walk_.sampler.at_vertex(at_.vertex));
        if (!wi || is_black(at_.beta)) return true;
        walk_.go_on(hit, *wi);
        follow(splits - 1);
        return true;
    }

    /// Follows both ways on from a smooth interface. Returns false, and does nothing, if the hit is no such interface
    /// or only one way carries light.
    bool split(const SurfaceHit& hit, int splits) {
        if (!settings_.follows_specular) return false;
        const auto ways = both_ways(hit, hit.shading.to_local(walk_.wo()));
        if (!ways) return false;
        const PathState here = at_;
        const float length = length_;
        for (const ScatteredRay& way : *ways) {
            at_ = here;
            length_ = length;
            walk_.take(way, false);
            if (is_black(at_.beta)) continue;
            walk_.go_on(hit, way.wi);
            follow(splits - 1);
        }
        return true;
    }

    /// Samples a direction by the specular lobes, and shows the visitor the light that glossy ones scatter straight
    /// from the lights. Empty if the path ends here.
    std::optional<Vec3> scatter_specularly(const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u) {
        const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
        if (!settings_.follows_specular || !lobes.specular()) return std::nullopt;
        const bool sees_lights = settings_.samples_lights && lobes.glossy;
        if constexpr (Visitor::wants_emission) {
            if (sees_lights)
                visitor_.emitted(at_.beta * sample_direct_light(walk_.rays, hit, wo_local, u, walk_.surroundings(),
                                                                LightTechniques::light_and_bsdf_sampling,
                                                                Lobes::specular)
                                                .specular);
        }
        const auto next = walk_.scatter(hit, wo_local, u, Transport::radiance, sees_lights, Lobes::specular);
        if (!next) return std::nullopt;
        const float most = next->delta ? most_specular_survival(at_.vertex) : most_survival(at_.vertex);
        if (at_.vertex < first_roulette_vertex) return next->wi;
        Color lost = Color::Zero();
        if (walk_.survives(most, u.roulette(), lost)) return next->wi;
        if (!lost.isFinite().all()) visitor_.emitted(lost);
        return std::nullopt;
    }

    EyeVertex vertex() { return {walk_, walk_.wo(), settings_.max_edges - (at_.vertex + 1), length_}; }

    PathWalk& walk_;
    PathState& at_;
    const WalkSettings& settings_;
    Visitor& visitor_;
    float length_ = 0.f;  ///< length of the path so far [scene units]
};

/// Follows the path that starts in `medium` (null: vacuum) along `first`, which has been traced, and shows `visitor`
/// what it meets.
template <typename Visitor>
void follow_specular_path(RayQueries& rays, const Sampler& sampler, const TracedRay& first, const Medium* medium,
                          const WalkSettings& settings, Visitor& visitor) {
    PathWalk walk(rays, sampler, first, medium);
    SpecularWalk(walk, settings, visitor).follow();
}

}  // namespace gib
