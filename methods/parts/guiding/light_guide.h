#pragma once
// Importance for light's paths: where photons and light vertices are needed, as walks from the camera ("importons") have
// found it, and the choices of a light's path that follow it. Sources: Peter and Pietrek 1998, "Importance Driven
// Construction of Photon Maps"; Vorba et al. 2014, "On-line Learning of Parametric Mixture Models for Light Transport
// Simulation"; Vorba and Krivanek 2016, "Adjoint-Driven Russian Roulette and Splitting in Light Transport Simulation".
//
// Light's paths are used at the first diffuse surface or event in a medium that the eye sees. An importon that goes on from there shows, at each place that it comes to, a direction in which light is to be
// sent. A radiance field stores these directions, and
//
//  - paths start towards the places where importons have come by, if most others would miss them (LightEmission);
//  - directions of scattering have the density a q + (1 - a) p, with the field's q and the bsdf's or phase function's p;
//  - a path survives with the probability of its power over that of a path that is to be used, `wanted_power`. So paths that
//    the field sends, of little power, are many, and where they are used their powers are about equal.

#include "methods/guided_path/guided_scattering.h"
#include "methods/parts/emission/light_emission.h"
#include "methods/parts/guiding/importons.h"
#include "methods/parts/transport/light_policy.h"

#include <optional>

namespace gib {

class LightGuide final : public LightPolicy {
public:
    /// Follows importons.
    LightGuide(const Scene& scene, const LightUse& use, std::uint64_t seed);

    /// Sets the wanted power, where light of this power is used, over that which leaves the lights. With the power 1 all paths
    /// that are used would be as powerful as without a guide; with `used` itself about all paths are used, many of them of little
    /// power. In halls the exponent 0.65 gives ten times the paths, and four times the information for the rays.
    void want(double used) { wanted_power_ = static_cast<float>(std::pow(std::min(used, 1.), 0.65)); }

    const LightEmission* start(bool focused) const override {
        const auto& emission = focused ? caustic_emission_ : emission_;
        return emission ? &*emission : nullptr;
    }
    /// Where the field knows nothing, or no lobe can follow it, both scatter plainly.
    std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo, const Vec3& wo_local,
                                        const VertexNumbers& u, float first_power, bool sees_lights) const override;
    std::optional<Vec3> scatter(PathWalk& walk, const Vec3& p, float before, const VertexNumbers& u,
                                float first_power) const override;

    std::uint64_t rays() const { return rays_; }

private:
    /// The field's knowledge of a place; empty where it knows nothing.
    std::optional<RadianceField::Distribution> known_at(const Vec3& p, const Vec3& normal) const;
    float selection(const PathWalk& walk, float first_power) const;
    bool survives(PathWalk& walk, float first_power, float most, float u) const;

    RadianceField field_;
    std::optional<LightEmission> emission_, caustic_emission_;
    float wanted_power_ = 1.f;  ///< over the mean power of a path that starts
    std::uint64_t rays_ = 0;
};

}  // namespace gib
