#pragma once
// How paths of light start and scatter: plainly (Jensen 2001, section 5.2), or by a policy that knows where light is needed.
// As with pbrt-v4's LightSampler, paths know this interface alone. The policy there is follows importons from the camera
// (parts/guiding).

#include "methods/method.h"
#include "methods/parts/transport/path_walk.h"

#include <memory>

namespace gib {

class LightEmission;

inline constexpr std::string_view step_importons = "importons";

enum class Guiding { automatic, on, off };
inline constexpr std::array<std::string_view, 3> guiding_names = {"auto", "on", "off"};
/// The parameter `guide`.
inline Parameter guide_parameter() {
    return choice_parameter(
        "guide", strings(guiding_names),
        "light's paths follow the importance that walks from the camera find; auto: where most light "
        "would never be used");
}
inline Guiding guiding_of(const ParameterValues& values) {
    return chosen<Guiding>(guiding_names, values.choice("guide"));
}
/// Adds the step that finds the policy. It is skipped where `why_not` is not empty.
inline void add_importons(Plan& plan, Guiding guiding, std::string why_not) {
    plan.add(step_importons, guiding == Guiding::off ? "guide=off" : std::move(why_not));
}
/// The fact whether there is a policy.
inline std::pair<std::string, std::string> guide_fact(bool is_guided) {
    return {"guided", is_guided ? "yes" : "no (plain paths: most light is used, or guide=off)"};
}

/// How a method uses light.
struct LightUse {
    int max_edges;     ///< of its paths
    bool uses_direct;  ///< whether it uses light that comes straight from a light
};

class LightPolicy {
public:
    virtual ~LightPolicy() = default;

    /// The policy of a scene, if the plan runs importons and either guiding is on or a pilot shows that most light is never
    /// used; else null. Adds the rays traced to `rays`. Defined in parts/guiding/find_guide.cpp.
    static std::shared_ptr<const LightPolicy> find(const Scene& scene, Guiding guiding, const LightUse& use,
                                                   const Plan& plan, std::uint64_t seed, StageTimes& stages,
                                                   std::uint64_t& rays);

    /// How paths start, or those that count only after a specular surface (`focused`); null: as without a policy.
    virtual const LightEmission* start(bool focused) const = 0;

    /// Scatters a path at a surface and plays roulette, as scatter_light() does. `first_power` is the mean power of a path that
    /// starts, in the unit of the path's. Empty if the path ends.
    virtual std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo,
                                                const Vec3& wo_local, const VertexNumbers& u, float first_power,
                                                bool sees_lights) const = 0;
    /// The same at p in a medium, for a path that weighs no lights. `before` is the largest channel of the power at the start of
    /// the free flight.
    virtual std::optional<Vec3> scatter(PathWalk& walk, const Vec3& p, float before, const VertexNumbers& u,
                                        float first_power) const = 0;
};

/// Scatters a path of light at a surface without a policy. It survives with the probability P_r = max_c (d_c + s_c), with the
/// diffuse and specular coefficients d and s of channel c, and its power is scaled by (d_c + s_c) / P_r in each channel (Jensen
/// 2001, section 5.2). Where it might have gone straight on, P_r makes up for the factor that its power has got there. Empty if
/// the path ends.
inline std::optional<ScatteredRay> scatter_plainly(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                                   const VertexNumbers& u, bool sees_lights) {
    PathState& path = walk.at;
    const ScatteringCoefficients c = hit.bsdf->coefficients_local(wo_local);
    const float most = is_black(c.diffuse) ? most_specular_survival(path.vertex) : most_survival(path.vertex);
    const float survival = std::min(path.kept * Color(c.diffuse + c.specular).maxCoeff(), most);
    if (!survives(path.beta, survival, u.roulette())) return std::nullopt;
    return walk.scatter(hit, wo_local, u, Transport::power, sees_lights);
}
/// The same in a medium, for a path that weighs no lights: the roulette compensates for the weight of the flight, before which
/// the largest channel of the power was `before` (Jensen and Christensen 1998).
inline std::optional<Vec3> scatter_plainly(PathWalk& walk, float before, const VertexNumbers& u) {
    PathState& path = walk.at;
    const float survival = std::min(path.beta.maxCoeff() / before, most_survival(path.vertex));
    if (!survives(path.beta, survival, u.roulette())) return std::nullopt;
    return walk.scatter_in_medium(u, false);
}

/// Scatters a path of light at a surface by the policy, or plainly if it is null. See LightPolicy::scatter().
inline std::optional<ScatteredRay> scatter_light(const LightPolicy* policy, PathWalk& walk, const SurfaceHit& hit,
                                                 const Vec3& wo, const Vec3& wo_local, const VertexNumbers& u,
                                                 float first_power, bool sees_lights) {
    return policy ? policy->scatter(walk, hit, wo, wo_local, u, first_power, sees_lights)
                  : scatter_plainly(walk, hit, wo_local, u, sees_lights);
}
/// The same at p in a medium.
inline std::optional<Vec3> scatter_light(const LightPolicy* policy, PathWalk& walk, const Vec3& p, float before,
                                         const VertexNumbers& u, float first_power) {
    return policy ? policy->scatter(walk, p, before, u, first_power) : scatter_plainly(walk, before, u);
}

}  // namespace gib
