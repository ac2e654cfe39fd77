#pragma once
// Importance for light's paths: where photons and light vertices are needed, as walks from the camera ("importons") have
// found it, and the choices of a light's path that follow it. Sources: Peter and Pietrek 1998, "Importance Driven
// Construction of Photon Maps"; Vorba et al. 2014, "On-line Learning of Parametric Mixture Models for Light Transport
// Simulation"; Vorba and Krivanek 2016, "Adjoint-Driven Russian Roulette and Splitting in Light Transport Simulation".
//
// Light's paths are used at the first diffuse surface or event in a medium that the eye sees (with final gathering, at the
// second). An importon that goes on from there shows, at each place that it comes to, a direction in which light is to be
// sent. A radiance field stores these directions, and
//
//  - paths start towards the places where importons have come by, if most others would miss them (LightEmission);
//  - directions of scattering have the density a q + (1 - a) p, with the field's q and the bsdf's or phase function's p;
//  - a path survives with the probability of its power over that of a path that is to be used, `wanted_power`. So paths that
//    the field sends, of little power, are many, and where they are used their powers are about equal.

#include "methods/parts/emission/light_emission.h"
#include "methods/parts/guiding/guided_scattering.h"
#include "methods/parts/guiding/importons.h"
#include "methods/parts/transport/path_walk.h"

#include <optional>

namespace gib {

class LightGuide {
public:
    /// Follows importons.
    LightGuide(const Scene& scene, const LightUse& use, std::uint64_t seed);

    /// Sets the wanted power, where light of this power is used, over that which leaves the lights. With the power 1 all paths
    /// that are used would be as powerful as without a guide; with `used` itself about all paths are used, many of them of little
    /// power. In halls the exponent 0.65 gives ten times the paths, and four times the information for the rays.
    void want(double used) { wanted_power_ = static_cast<float>(std::pow(std::min(used, 1.), 0.65)); }

    /// How paths start, and those that count only after a specular surface; null: as without a guide.
    const LightEmission* emission() const { return emission_ ? &*emission_ : nullptr; }
    const LightEmission* caustic_emission() const { return caustic_emission_ ? &*caustic_emission_ : nullptr; }

    /// The field's knowledge where the path has come to a surface, or to p in a medium; empty where it knows nothing, or no lobe
    /// can follow it.
    std::optional<RadianceField::Distribution> at_surface(const SurfaceHit& hit, const Vec3& wo,
                                                          const Vec3& wo_local) const;
    std::optional<RadianceField::Distribution> in_medium(const Vec3& p) const;

    /// Scatters the path at a surface and plays roulette, like PathWalk::scatter(). `first_power` is the mean power of a path that
    /// starts, in the unit of the path's. Empty if the path ends.
    std::optional<ScatteredRay> scatter(const RadianceField::Distribution& known, PathWalk& walk, const SurfaceHit& hit,
                                        const Vec3& wo_local, const VertexNumbers& u, float first_power,
                                        bool sees_lights) const;
    /// The same in a medium, for a path that weighs no lights.
    std::optional<Vec3> scatter_in_medium(const RadianceField::Distribution& known, PathWalk& walk,
                                          const VertexNumbers& u, float first_power) const;

    std::uint64_t rays() const { return rays_; }

private:
    float selection(const PathWalk& walk, float first_power) const;
    bool survives(PathWalk& walk, float first_power, float most, float u) const;

    RadianceField field_;
    std::optional<LightEmission> emission_, caustic_emission_;
    float wanted_power_ = 1.f;  ///< over the mean power of a path that starts
    std::uint64_t rays_ = 0;
};

/// Scatters a path of light at a surface. Where the guide, which may be null, knows the place, it chooses and plays roulette.
/// Elsewhere the path survives with the probability P_r = max_c (d_c + s_c), with the diffuse and specular coefficients d and s of
/// channel c, and its power is scaled by (d_c + s_c) / P_r in each channel (Jensen 2001, section 5.2). Where it might have gone
/// straight on, P_r makes up for the factor that its power has got there. `first_power` is as of LightGuide::scatter(). Empty if the
/// path ends.
inline std::optional<ScatteredRay> scatter_light(const LightGuide* guide, PathWalk& walk, const SurfaceHit& hit,
                                                 const Vec3& wo, const Vec3& wo_local, const VertexNumbers& u,
                                                 float first_power, bool sees_lights) {
    if (const auto known = guide ? guide->at_surface(hit, wo, wo_local) : std::nullopt)
        return guide->scatter(*known, walk, hit, wo_local, u, first_power, sees_lights);
    PathState& path = walk.at;
    const ScatteringCoefficients c = hit.bsdf->coefficients_local(wo_local);
    const float most = is_black(c.diffuse) ? most_specular_survival(path.vertex) : most_survival(path.vertex);
    const float survival = std::min(path.kept * Color(c.diffuse + c.specular).maxCoeff(), most);
    if (!survives(path.beta, survival, u.roulette())) return std::nullopt;
    return walk.scatter(hit, wo_local, u, Transport::power, sees_lights);
}

}  // namespace gib
