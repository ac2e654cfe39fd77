#pragma once
// Projection maps: photons are emitted only where they can reach surfaces that matter. Sources: Jensen 1996, "Global
// Illumination using Photon Maps", section 3.1; Jensen 2001, "Realistic Image Synthesis Using Photon Mapping",
// section 5.3.
//
// A light's emission is a map from numbers x uniform in [0, 1)^4 to rays of power Phi(x) [W], whose mean is the light's
// power. The map of a light is a set of boxes in that space, its cells: those whose rays can reach a target, by bounds
// of the rays (emission_bounds.h) and of the targets (projection_targets.h), never by trying rays. With V_l the volume
// of the light's kept cells, P_l the probability of choosing the light and V_c that of a cell, a cell is chosen with
// probability P_l V_c / V_l and x uniformly in it: density P_l / V_l, so that
//
//     Phi(x) V_l / P_l
//
// is an unbiased estimate of the power that leaves through the kept cells, whatever they are. Nothing is lost as long
// as no ray of a dropped cell reaches a target. Jensen scales by the fraction of cells that are kept; here cells differ
// in size, and it is the emission's own density that counts: that is volume.

#include "methods/parts/photons/projection_targets.h"

#include <cstdint>
#include <vector>

namespace gib {

class Scene;

class ProjectionMap {
public:
    /// `most_cells` of all lights together; they are spent by power.
    ProjectionMap(const Scene& scene, TargetSurfaces surfaces, std::size_t most_cells = 1 << 16);

    /// No light can reach a target.
    bool empty() const { return cells_.empty(); }
    /// Some cell of some light was dropped.
    bool aims() const { return aims_; }

    /// The index of a cell, with its probability. Not if empty.
    std::uint32_t choose_cell(const Vec2& u) const;
    /// The start of a light path in a chosen cell, with its share of the power that leaves through all cells.
    EmissionSample sample_emission(const Scene& scene, std::uint32_t cell, const Vec2& u_position,
                                   const Vec2& u_direction) const;

    struct Cell {
        EmissionBox box;
        std::uint32_t light;  ///< index into the scene's
    };
    const std::vector<Cell>& cells() const { return cells_; }
    /// The share of the light's numbers, and of an untextured light's power, that its cells hold.
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
    std::vector<Cell> cells_;
    bool aims_ = false;
    std::vector<double> begin_;         ///< of the cells' intervals of [0, 1)
    std::vector<std::uint32_t> guide_;  ///< the cell at i / size
};

}  // namespace gib
