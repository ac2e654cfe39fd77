#pragma once
// How the light's walks of a scene start.
//
// Starts may be aimed by projection maps (methods/parts/emission/projection_map.h): at specular surfaces where most light can
// reach none, because caustics need them; or at the places that a guide has found (methods/parts/guiding/light_guide.h), by
// several maps, each with all targets of the one before. The kinds of starts share the rays: a ray belongs to the first map
// that has a target on the ray, or else to the ordinary starts. A start whose ray belongs to another kind than the one
// that made it is dropped, so its density follows from its ray alone, as the weights of all techniques need it. With n
// maps, it is
//
//     q(light) p / (n + 1)         if the ray meets no target,
//     P_l / V_l p / (n + 1)        if it belongs to a map,
//
// with the density p of the light's own emission, the probability q of the light's choice without a map, and the map's P_l
// and V_l. No light is lost, since a map holds all rays that meet a target.

#include "common/sampling/sampler.h"
#include "methods/parts/emission/aimed_emission.h"

#include <memory>
#include <optional>
#include <vector>

namespace gib {

class LightEmission {
public:
    using Maps = std::vector<std::shared_ptr<const AimedEmission>>;
    /// Without maps all starts are ordinary.
    explicit LightEmission(const Scene& scene, Maps maps = {}) : scene_(&scene), maps_(std::move(maps)) {}
    /// The map that aims at specular surfaces, if most emission cannot reach any.
    static Maps towards_specular(const Scene& scene);

    struct Start {
        EmissionSample sample;  ///< sample whose power has been divided by the density [W]
        float cos_light;        ///< cosine between the direction and the light's normal; 1 without a surface
        double density;         ///< density as of emission_pdf(), with the light's choice
    };
    /// Empty where the ray belongs to another kind of start than the one that made it.
    std::optional<Start> sample(const Sampler& sampler) const;

    /// The power of ordinary starts over the mean of all.
    float ordinary_power() const { return static_cast<float>(maps_.size() + 1); }
    /// The density of starts of a light at p, or for a light at infinity on the line through p, in direction w.
    double density(std::uint32_t light, const Vec3& p, const Vec3& w, float cos_light) const {
        return density_of(kind_of(light, p, w), light, w, cos_light);
    }

private:
    double density_of(std::size_t kind, std::uint32_t light, const Vec3& w, float cos_light) const;
    /// The number of the map to which the ray belongs, or of maps.
    std::size_t kind_of(std::uint32_t light, const Vec3& p, const Vec3& w) const;

    const Scene* scene_;
    Maps maps_;
};

}  // namespace gib
