#pragma once
// Projection maps: photons are emitted only where they can reach surfaces that matter. Sources: Jensen 1996, "Global
// Illumination using Photon Maps", section 3.1; Jensen 2001, "Realistic Image Synthesis
// Using Photon Mapping", chapter 5.
//
// A light's emission is a map from numbers x, uniform in [0, 1)^4, to rays of power Phi(x) [W], whose mean is the
// light's power. The projection map of a light is a set of boxes in that space, its bins: those whose rays can reach
// a target. This is decided by bounds of the rays (emission_bounds.h) and of the targets (projection_targets.h),
// never by trying rays. Let V_l be the volume of the light's kept bins, P_l the probability of choosing the light and
// V_c the volume of a bin. A bin is chosen with probability P_l V_c / V_l, and x uniformly in it. So x has the
// density P_l / V_l, and
//
//     Phi(x) V_l / P_l
//
// is an unbiased estimate of the power that leaves through the kept bins, whatever they are. No light is lost if no
// ray of a dropped bin reaches a target. Jensen scales by the fraction of bins that are kept. Here bins differ in
// size, so their volume takes the place of their number: the share of the random numbers that lead to kept rays.

#include "methods/parts/emission/projection_targets.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace gib {

class ProjectionMap final : public AimedEmission {
public:
    /// Builds at most `most_bins` bins for all lights together; lights of more power get more of them.
    ProjectionMap(const Scene& scene, ProjectionTargets targets, std::size_t most_bins);
    /// The same for surfaces of the scene.
    ProjectionMap(const Scene& scene, TargetSurfaces surfaces, std::size_t most_bins = 1 << 16);

    bool empty() const override { return bins_.empty(); }
    bool aims() const override { return aims_; }
    double kept_power() const override;
    std::uint32_t choose_bin(const Vec2& u) const override;
    /// The power of the sample is Phi(x) V_l / P_l [W].
    EmissionSample sample_emission(const Scene& scene, std::uint32_t bin, const Vec2& u_position,
                                   const Vec2& u_direction) const override;
    double density(const Scene& scene, std::size_t light, const Vec3& w, float cos_light) const override;
    bool meets_target(const Scene& scene, std::size_t light, const Vec3& p, const Vec3& w) const override;

    struct Bin {
        EmissionBox box;
        std::uint32_t light;  ///< index among the scene's lights
    };
    const std::vector<Bin>& bins() const { return bins_; }
    /// V_l: the share of the light's random numbers that its bins hold. For an untextured light it is also the share
    /// of its power.
    double kept(std::size_t light) const { return lights_[light].kept; }

    /// The light as the bins cut it: one at infinity over the disc that covers the targets, if this is smaller than the scene's.
    const Light& light_of(const Scene& scene, std::size_t light) const;

private:
    struct OfLight {
        double power = 0;                                       ///< [W] mean of the channels, of the focused light
        double kept = 0;                                        ///< V_l
        float scale = 0.f;                                      ///< V_l / P_l
        std::uint32_t own_shape = ProjectionTargets::no_shape;  ///< shape that its rays cannot meet
        /// A light at infinity, over the disc that covers the targets rather than all of the scene.
        std::optional<Light> focused = {};
    };
    class Refinement;

    void prepare_choice();

    ProjectionTargets targets_;
    std::vector<OfLight> lights_;
    std::vector<Bin> bins_;
    bool aims_ = false;
    double all_power_ = 0;              ///< [W] of the scene's lights, mean of the channels
    std::vector<double> begin_;         ///< start of each bin's interval of [0, 1)
    std::vector<std::uint32_t> guide_;  ///< entry i: the bin at i / size, where the search for a bin starts
};

}  // namespace gib
