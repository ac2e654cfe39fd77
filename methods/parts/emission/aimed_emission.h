#pragma once
// Emission aimed at targets: a distribution of the starts of light paths that holds every ray which can meet a target,
// and few others. The one there is, projection maps, is Jensen's (projection_map.h); light paths know this interface
// alone.

#include "common/lights/light.h"

#include <cstdint>
#include <memory>

namespace gib {

class Scene;

enum class TargetSurfaces {
    all,
    specular  ///< surfaces whose material has a specular lobe
};

class AimedEmission {
public:
    virtual ~AimedEmission() = default;

    /// The projection map of the scene's surfaces, of at most `most_bins` bins for all lights together.
    static std::unique_ptr<AimedEmission> at_surfaces(const Scene& scene, TargetSurfaces surfaces,
                                                      std::size_t most_bins);

    /// Whether no light can reach a target.
    virtual bool empty() const = 0;
    /// Whether some part of some light's emission is left out.
    virtual bool aims() const = 0;
    /// The share of all lights' power that is held, with untextured lights.
    virtual double kept_power() const = 0;

    /// Chooses a bin of rays with its probability. Bins of near numbers hold rays that are near. The distribution must
    /// not be empty.
    virtual std::uint32_t choose_bin(const Vec2& u) const = 0;
    /// The start of a light path in a chosen bin. Its power [W] is an unbiased estimate of the power that leaves
    /// through all bins.
    virtual EmissionSample sample_emission(const Scene& scene, std::uint32_t bin, const Vec2& u_position,
                                           const Vec2& u_direction) const = 0;
    /// The density of a start in the light's bins in direction w, as of emission_pdf(), with the choice of the light.
    virtual double density(const Scene& scene, std::size_t light, const Vec3& w, float cos_light) const = 0;
    /// Whether a ray of the light meets a target: one that starts at p in direction w, or for a light at infinity the
    /// whole line through p. The bins hold all such rays.
    virtual bool meets_target(const Scene& scene, std::size_t light, const Vec3& p, const Vec3& w) const = 0;
};

}  // namespace gib
