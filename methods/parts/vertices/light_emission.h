#pragma once
// How the light's walks of a scene start.
//
// Where most light can reach no specular surface, half of the walks are aimed at those surfaces by a projection map
// (methods/parts/photons/projection_map.h), because caustics need them. The two kinds of starts share the rays: a ray that
// meets a target of the map belongs to the aimed starts, any other to the ordinary ones. A start of the other kind is
// dropped, so the density of a start is known from its ray alone, as the weights of all techniques need it:
//
//     q(light) p / 2          if the ray meets no target,
//     P_l / V_l p / 2         if it does,
//
// with the density p of the light's own emission, the probability q of the light's choice without a map, and the map's P_l
// and V_l. No light is lost, since the map holds all rays that meet a target.

#include "common/sampling/sampler.h"
#include "methods/parts/photons/projection_map.h"

#include <memory>

namespace gib {

class LightEmission {
public:
    /// `aims`: whether walks are aimed, if most emission cannot reach a specular surface.
    LightEmission(const Scene& scene, bool aims);

    struct Start {
        EmissionSample sample;  ///< sample whose power has been divided by the density [W]
        float cos_light;        ///< cosine between the direction and the light's normal; 1 without a surface
        double density;         ///< density as of emission_pdf(), with the light's choice
    };
    /// Empty where the start belongs to the other kind.
    std::optional<Start> sample(const Sampler& sampler) const;

    /// The density of starts of a light at p, or for a light at infinity on the line through p, in direction w.
    double density(std::uint32_t light, const Vec3& p, const Vec3& w, float cos_light) const;

private:
    const Scene& scene_;
    std::shared_ptr<const ProjectionMap> map_;  ///< null: all starts are ordinary
};

}  // namespace gib
