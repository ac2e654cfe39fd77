#pragma once
// A path through the scene, from the eye or from a light, and the steps that all paths are made of: the flight through
// a medium, holes and surfaces that do not change light, emission, scattering, and Russian roulette. The path tracer,
// the specular walk and the photon walk are loops over these steps.

#include "methods/parts/transport/direct_light.h"
#include "methods/parts/transport/dispersed_path.h"
#include "methods/parts/transport/roulette.h"
#include "methods/parts/transport/scattered_ray.h"

#include <algorithm>

namespace gib {

/// The state of a path between two of its vertices.
struct PathState {
    /// Throughput of an eye path, the product of f cos / pdf over its vertices; the power of a photon.
    Color beta = Color::Ones();
    float eta_scale = 1.f;  ///< product of eta^2 by which refractions have divided the throughput
    /// Density [1/sr] of the last direction; infinite if light sampling could not have found it.
    float pdf_w = infinity;
    Vec3 previous;                      ///< the last vertex, or the start of the path
    Vec3 previous_side = Vec3::Zero();  ///< LitPoint::side there
    const Medium* medium = nullptr;     ///< medium that the path is in; null: vacuum
    std::optional<int> stratum = {};    ///< stratum of wavelengths, once the path has met dispersion
    int vertex = 0;                     ///< number of vertices so far that have scattered the path: edges - 1
    std::uint32_t holes = 0;            ///< decisions so far whether the path goes straight on
    float kept = 1.f;  ///< factor of the throughput at the last surface where it might have gone straight on
    PathClass path_class = {};
};

/// The end of a flight through a medium, before the next surface.
struct Flight {
    bool is_black = false;                ///< the medium has absorbed everything: the path ends
    std::optional<Vec3> scattering_at{};  ///< empty if the path reaches the surface
};

/// A stretch of a path in a medium, up to the next surface.
struct MediumStretch {
    const Medium& medium;
    Vec3 from;
    Vec3 w;        ///< unit, away from where the path came from
    float length;  ///< [scene units]; may be infinite
    TransmittanceAlong transmittance;
};

/// The path and all it needs to go on. `ray` is its last edge, which has been traced.
class PathWalk {
public:
    /// Starts along `first`, which has been traced, in `medium`. `queries` and `numbers` must outlive this.
    PathWalk(RayQueries& queries, const Sampler& numbers, const TracedRay& first, const Medium* medium)
        : rays(queries), sampler(numbers), vertex_numbers(numbers.at_vertex(0)), flights(numbers), ray(first) {
        at.previous = first.ray.o;
        at.medium = medium;
    }

    /// Attenuates a light's path, before its first flight, by what lies before its start. Light from infinity comes to
    /// a start outside of all surfaces, where a medium has no boundary, and has crossed this medium.
    void come_from(const Light& light) {
        if (at.medium && is_at_infinity(light))
            at.beta *= at.medium->transmittance(ray.ray.o, -ray.ray.d, infinity, flights);
    }

    RayQueries& rays;
    const Sampler& sampler;
    /// Random numbers of the next vertex. They are computed before the ray is traced, as the processor overlaps the two.
    VertexNumbers vertex_numbers;
    NumberStream flights;  ///< random numbers of flights through media
    TracedRay ray;
    PathState at;

    const Scene& scene() const { return rays.scene(); }
    std::optional<SurfaceHit> surface_hit() const { return rays.surface_hit(ray); }
    /// The direction at the end of the ray, towards where it came from.
    [[gnu::always_inline]] Vec3 wo() const { return -ray.ray.d; }
    /// The last vertex as lights light it.
    LitPoint lit_previous() const { return {at.previous, at.previous_side}; }
    Surroundings surroundings() { return {at.medium, flights}; }

    /// The flight along the ray through the medium that the path is in; multiplies beta by the weight of its outcome.
    Flight fly() {
        if (!at.medium) return {};
        const auto distance = at.medium->sample_flight(flight_start(), ray.ray.d, flight_length(), flights, at.beta);
        if (is_black(at.beta)) return {.is_black = true};
        return distance ? Flight{.scattering_at = flight_start() + *distance * ray.ray.d} : Flight{};
    }

    /// The stretch along the ray through the medium that the path is in, which must not be vacuum.
    MediumStretch stretch() {
        const Vec3 from = flight_start();
        const float length = flight_length();
        return {*at.medium, from, ray.ray.d, length, at.medium->transmittance_along(from, ray.ray.d, length, flights)};
    }

    /// Radiance [W/(sr m^2)] that the path finds at the end of its ray, emitted by the surface there or, without a
    /// surface, by the environment: Le, weighted against light sampling from the previous vertex. Times beta.
    Color emitted(const std::optional<SurfaceHit>& hit) const {
        if (ray.hides_emitters) return Color::Zero();
        if (!hit) {
            if (!scene().environment()) return Color::Zero();
            return at.beta * escaped_radiance(scene(), lit_previous(), at.pdf_w, ray.ray.d);
        }
        const Color Le = hit->Le(wo());
        if (is_black(Le)) return Color::Zero();
        return at.beta * Le * bsdf_sampling_weight(scene(), lit_previous(), at.pdf_w, *hit);
    }

    /// Decides whether the path goes straight on: through a hole of a mask, a thin sheet, or the boundary of a medium
    /// that does not refract. It then gains no vertex. With the share s of light that goes straight on and the largest of
    /// its channels as the probability q, the throughput is multiplied by s / q if the path does so, and else by (1 - p)
    /// / (1 - q), where p is the probability that there is no surface: f and the samples of a Bsdf are those of a surface
    /// that exists. A path that sees no emitters passes through lamps.
    bool passes_through(const SurfaceHit& hit) {
        at.kept = 1.f;
        if (ray.hides_emitters && hit.emitter) {
            go_straight_on(hit);
            return true;
        }
        if (!scene().has_holes()) return false;
        const Color straight = hit.straight_on(ray.ray.d);
        const float q = straight.maxCoeff();
        if (!(q > 0.f)) return false;
        if (sampler.get_1d(dimension::first_hole + at.holes++) < q) {
            at.beta *= straight / q;
            go_straight_on(hit);
            return true;
        }
        at.kept = (1.f - hit.bsdf->pass_through()) / (1.f - q);
        at.beta *= at.kept;
        return false;
    }
    /// Traces the way straight on from the hit.
    void go_straight_on(const SurfaceHit& hit) { trace_from(hit, ray.ray.d); }

    /// Splits the path by wavelength if the surface does (dispersed_path.h). `dimension` of the sampler chooses.
    void disperse(SurfaceHit& hit, std::uint32_t dimension) {
        if (scene().has_dispersion()) gib::disperse(scene(), sampler.get_1d(dimension), hit, at.stratum, at.beta);
    }

    /// Samples a direction by the lobes `which`, and multiplies beta by its weight. `sees_lights`: whether light
    /// sampling at this vertex could have found the direction too. Empty if nothing is scattered.
    std::optional<ScatteredRay> scatter(const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                                        Transport transport, bool sees_lights, Lobes which = Lobes::all) {
        const auto next = sample_scattering(hit, wo_local, u.bsdf_lobe(), u.bsdf_direction(), transport, which);
        if (next) take(*next, sees_lights);
        return next;
    }

    /// Multiplies beta by the weight of a scattered ray.
    void take(const ScatteredRay& next, bool sees_lights) {
        at.beta *= next.weight;
        at.eta_scale *= sqr(next.eta);
        at.pdf_w = next.delta || !sees_lights ? infinity : next.pdf_w;
        at.path_class.scatter(next.lobe);
    }

    /// Samples a direction by the phase function of the medium, whose value is its density: the weight is 1.
    Vec3 scatter_in_medium(const VertexNumbers& u, bool sees_lights) {
        const PhaseFunction& phase = at.medium->phase();
        const Vec3 wi = phase.sample(wo(), u.bsdf_direction());
        at.pdf_w = sees_lights ? phase.value(wo(), wi) : infinity;
        return wi;
    }

    /// Russian roulette of an eye path, whose survival probability is its throughput, so that all survivors have equal
    /// weight, but at most `most`. The factors 1 / eta^2 of refractions are taken out, because a path that leaves the
    /// glass again regains them. A throughput that is not finite would be dropped without notice, so it is added to
    /// `lost`, for the film to count it. Returns false if the path ends.
    bool survives(float most, float u, Color& lost) {
        if (!at.beta.isFinite().all()) {
            lost += at.beta;
            return false;
        }
        return gib::survives(at.beta, std::min(at.beta.maxCoeff() * at.eta_scale, most), u);
    }

    /// Adds the hit as a vertex and traces the next edge.
    void go_on(const SurfaceHit& hit, const Vec3& wi) {
        at.previous = hit.p;
        at.previous_side = scene().lit(hit, wo()).side;
        leave_vertex();
        trace_from(hit, wi);
    }
    /// The same from a scattering event at p in the medium.
    void go_on(const Vec3& p, const Vec3& wi) {
        at.previous = p;
        at.previous_side = Vec3::Zero();
        leave_vertex();
        ray.ray = {p, wi};
        rays.trace(ray);
    }

private:
    // The ray's d is a unit vector; t_min and t_max clip a camera's rays.
    Vec3 flight_start() const { return ray.ray.o + ray.ray.t_min * ray.ray.d; }
    float flight_length() const { return (ray.found ? ray.found->t : ray.ray.t_max) - ray.ray.t_min; }

    void leave_vertex() {
        vertex_numbers = sampler.at_vertex(++at.vertex);
        ray.hides_emitters = false;
    }
    void trace_from(const SurfaceHit& hit, const Vec3& wi) {
        if (scene().has_media()) at.medium = scene().medium_beyond(hit, wi, at.medium);
        ray.ray = hit.spawn_ray(wi);
        rays.trace(ray);
    }
};

}  // namespace gib
