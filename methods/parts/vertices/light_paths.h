#pragma once
// The paths from the lights: how many there are in a pass, how they start, the units of their light, and the walk along
// one, whose vertices are connected to the camera and to vertices of the camera's walk.

#include "methods/method.h"
#include "methods/parts/emission/light_emission.h"
#include "methods/parts/transport/light_policy.h"
#include "methods/parts/vertices/path_vertex.h"

#include <algorithm>

namespace gib {

inline constexpr std::string_view step_light_paths = "light paths";
inline constexpr std::string_view step_light_aim = "projection map of the light paths";
inline constexpr std::string_view step_connections = "connections";

/// The light paths of a scene's pass: as many as pixels.
struct LightPaths {
    /// Builds the projection map if the plan runs it and there is no policy that has starts of its own.
    LightPaths(const Scene& scene, const Plan& plan, StageTimes& stages,
               std::shared_ptr<const LightPolicy> by = nullptr);

    double count;                               ///< number of light paths in a pass
    double power;                               ///< emitted by the scene [W], the unit of the paths' power
    bool camera_on_surface;                     ///< RayQueries::camera_lies_on_surface()
    std::shared_ptr<const LightPolicy> policy;  ///< null without one
    LightEmission emission;
    /// A power of 2 near 1000 times the radiance [W/(sr m^2)] that this power makes in the whole scene: the unit of sums
    /// over pixels, times `count`. Most additions are smaller, and leave the sums' whole numbers alone.
    double sum_unit;
};

/// Adds the steps of the light paths, which are skipped where they cannot be seen: nothing emits, or paths of two edges
/// are longer than allowed.
void add_light_paths(Plan& plan, const Scene& scene, int max_edges);

/// Follows a path from a light and calls visit(vertex, numbers, flights) at every vertex where another walk could end,
/// before the path is scattered there. The powers are in units of the scene's emitted power, so that they keep to the
/// range of float. The path and one more edge have at most as many edges as the rules allow.
///
/// The walk survives a scattering event with a probability of the albedo, as photons do, so that all its vertices have
/// similar power (Jensen 2001, section 5.2). It scatters by the policy of the paths, if there is one; only walks whose
/// vertices are connected to the camera alone may have one, since other techniques would have to weigh its directions.
template <typename Rule, typename Visit>
class LightWalk {
public:
    LightWalk(RayQueries& rays, const Sampler& sampler, const LightPaths& paths, const PathRules& rules,
              const Rule& added, const LightEmission::Start& start, Visit visit)
        : scene_(rays.scene()),
          rules_(rules),
          policy_(paths.policy.get()),
          visit_(std::move(visit)),
          start_(start),
          light_(scene_.lights()[start.sample.light]),
          along_(added, is_delta(light_)),
          walk_(rays, sampler, TracedRay{start.sample.ray},
                scene_.has_media() ? rays.medium_at(start.sample.ray.o) : nullptr),
          sums_(at_light(0)) {
        walk_.at.beta = (start.sample.power / paths.power).template cast<float>();
        walk_.come_from(light_);
    }

    void follow() {
        // A light sends nothing along its surface, where the density is 0.
        bool goes_on = rules_.max_edges >= 2 && !is_black(walk_.at.beta) && start_.density > 0;
        if (goes_on) walk_.rays.trace(walk_.ray);
        while (goes_on && walk_.at.vertex + 1 < rules_.max_edges) {
            const float before = walk_.at.beta.maxCoeff();
            const Flight flight = walk_.fly();
            if (flight.is_black) return;
            const VertexNumbers u = walk_.vertex_numbers;
            goes_on = flight.scattering_at ? scatters_in_medium(*flight.scattering_at, before, u) : leaves_surface(u);
        }
    }

private:
    /// The event at p in the medium, on arrival at which the power has fallen from `before`. Returns whether the path
    /// goes on.
    bool scatters_in_medium(const Vec3& p, float before, const VertexNumbers& u) {
        PathState& path = walk_.at;
        arrive(p, 1);
        along_.arrive(walk_, p, sums_);
        if (along_.ends(sums_)) return false;
        PathVertex vertex(walk_, p, path_class_, sums_);
        visit(vertex, u);
        const float survival = std::min(path.beta.maxCoeff() / before, most_survival(path.vertex));
        if (!survives(path.beta, survival, u.roulette())) return false;
        along_.scatters(false);
        const Vec3 to = scatter_in_medium(walk_, sums_, u).first;
        path_class_.in_medium = true;
        walk_.go_on(p, to);
        return true;
    }

    /// The surface at the end of the ray. Returns whether the path goes on.
    bool leaves_surface(const VertexNumbers& u) {
        auto hit = walk_.surface_hit();
        if (!hit) return false;
        if (walk_.passes_through(*hit)) return true;
        arrive(scene_.lit(*hit, walk_.wo()), double{std::abs(walk_.wo().dot(hit->ng))});
        along_.arrive(walk_, *hit, sums_);
        walk_.disperse(*hit, dimension::photon_stratum);
        PathVertex vertex(walk_, std::move(*hit), path_class_, sums_);
        if (vertex.can_be_joined()) {
            if (along_.ends(sums_)) return false;
            visit(vertex, u);
        }

        const auto next =
            scatter_light(policy_, walk_, *vertex.hit, vertex.from, vertex.from_local, u, first_power, true);
        if (!next) return false;
        along_.scatters(next->delta);
        step(sums_, vertex, *next, Transport::radiance);
        path_class_ = path_class_.preceded_by(next->lobe);
        walk_.go_on(*vertex.hit, next->wi);
        return true;
    }

    void visit(PathVertex& vertex, const VertexNumbers& u) {
        vertex.has_first_samples = vertex.edges > 1 || is_delta(light_);
        visit_(vertex, u, walk_.flights);
    }
    TechniqueSums at_light(double sampling) const {
        return TechniqueSums::at_light(start_.density, sampling, double{start_.cos_light}, is_delta(light_), rules_);
    }
    /// Arrival at a point, whose normal has this cosine with the path.
    void arrive(const LitPoint& at, double cosine) {
        if (!sums_.has_others()) return;
        const PathState& path = walk_.at;
        const double distance2 = double{(at.p - path.previous).squaredNorm()};
        if (path.vertex > 0) return sums_.arrive(distance2, cosine, rules_.connects ? 1 : 0);
        const EmissionSample& start = start_.sample;
        const SurfacePoint origin{start.ray.o, start.normal, 0.f};
        const double sampling = double{scene_.light_pdf_w(at, start.light, origin, start.ray.d)};
        sums_ = at_light(is_point(light_) ? sampling * distance2 : sampling);
        sums_.arrive(1, cosine, 1);
    }

    /// The mean power of a path that starts, in the unit LightPaths::power.
    static constexpr float first_power = 1.f;

    const Scene& scene_;
    const PathRules& rules_;
    const LightPolicy* policy_;
    Visit visit_;
    const LightEmission::Start& start_;
    const Light& light_;
    typename Rule::AlongLight along_;
    PathWalk walk_;
    TechniqueSums sums_;
    PathClass path_class_;  ///< class of the vertices so far, read towards the light
};

}  // namespace gib
