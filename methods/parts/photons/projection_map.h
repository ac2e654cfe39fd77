#pragma once
// Projection maps: photons are emitted only where they can reach surfaces that matter. Sources: Jensen 1996, "Global
// Illumination using Photon Maps", section 3.1; Jensen 2001, "Realistic Image Synthesis Using Photon Mapping",
// section 5.3.
//
// A light's emission is a map from numbers x uniform in [0, 1)^4 to rays of power Phi(x) [W], whose mean is the light's
// power. The map of a light is a set of boxes in that space, its bins: those whose rays can reach a target, by bounds
// of the rays (emission_bounds.h) and of the targets (projection_targets.h), never by trying rays. With V_l the volume
// of the light's kept bins, P_l the probability of choosing the light and V_c that of a bin, a bin is chosen with
// probability P_l V_c / V_l and x uniformly in it: density P_l / V_l, so that
//
//     Phi(x) V_l / P_l
//
// is an unbiased estimate of the power that leaves through the kept bins, whatever they are. Nothing is lost as long
// as no ray of a dropped bin reaches a target. Jensen scales by the fraction of bins that are kept; here bins differ
// in size, and it is the emission's own density that counts: that is volume.

#include "methods/parts/photons/projection_targets.h"

#include <cstdint>
#include <vector>

namespace gib {

class Scene;

class ProjectionMap {
public:
    /// `most_bins` of all lights together; they are spent by power.
    ProjectionMap(const Scene& scene, TargetSurfaces surfaces, std::size_t most_bins = 1 << 16);

    /// No light can reach a target.
    bool empty() const { return bins_.empty(); }
    /// Some bin of some light was dropped.
    bool aims() const { return aims_; }

    /// The index of a bin, with its probability. Not if empty.
    std::uint32_t choose_bin(const Vec2& u) const;
    /// The start of a light path in a chosen bin, with its share of the power that leaves through all bins.
    EmissionSample sample_emission(const Scene& scene, std::uint32_t bin, const Vec2& u_position,
                                   const Vec2& u_direction) const;

    struct Bin {
        EmissionBox box;
        std::uint32_t light;  ///< index into the scene's
    };
    const std::vector<Bin>& bins() const { return bins_; }
    /// The share of the light's numbers, and of an untextured light's power, that its bins hold.
    double kept(std::size_t light) const { return lights_[light].kept; }

private:
    struct OfLight {
        double power = 0;   ///< [W] mean of the channels
        double kept = 0;    ///< V_l
        float scale = 0.f;  ///< V_l / P_l
    };
    class Refinement;

    void prepare_choice();

    std::vector<OfLight> lights_;
    std::vector<Bin> bins_;
    bool aims_ = false;
    std::vector<double> begin_;         ///< of the bins' intervals of [0, 1)
    std::vector<std::uint32_t> guide_;  ///< the bin at i / size
};

}  // namespace gib
