#pragma once
// Participating media: what fills the space between surfaces, absorbs light and scatters it.

#include "common/media/grid_volume.h"
#include "common/media/phase.h"
#include "common/sampling/sampler.h"

#include <optional>

namespace gib {

/// Extinction sigma_t [1/scene unit] and albedo sigma_s / sigma_t by channel, constant or on a grid. A medium whose
/// extinction lies on a grid ends at the grid's cube.
///
/// Estimators, for a stretch of length d along a ray with transmittance T(t) = exp(-integral of sigma_t from 0 to t):
/// - constant extinction: a flight t with the density sum over channels c of q_c sigma_t,c exp(-sigma_t,c t), by
/// choosing a channel
///   with probability q_c; weight sigma_s T(t) / density where light is scattered, T(d) / (sum of q_c exp(-sigma_t,c
///   d)) where it passes (the balance heuristic over channels, Veach 1997, section 9.2). q_c goes by the throughput:
///   where nothing is absorbed the weights leave its sum as it is, however often a path is scattered (Kutz et al. 2017,
///   "Spectral and Decomposition Tracking for Rendering Heterogeneous Volumes", section 5);
/// - on a grid: delta tracking (Woodcock et al. 1965) with a majorant M of all channels. A collision is real with a
///   probability P in proportion to the light that is scattered there; weight sigma_s / (M P), or (M - sigma_t) / (M (1
///   - P)) where it is null (Galtier et al. 2013, "Integral formulation of null-collision Monte Carlo algorithms");
/// - transmittance on a grid: ratio tracking (Novak et al. 2014), the product of 1 - sigma_t / M over tentative
/// collisions. A medium that scatters nothing is not sampled: light that passes is weighted by T(d).
class Medium {
public:
    /// Values on grids are those of extinction before `scale`, which is at least 0, and of albedo, 0 to 1.
    Medium(GridVolume extinction, float scale, GridVolume albedo, const PhaseFunction& phase);

    /// Follows light from a point along the unit vector w for `length`, which may be infinite. Where it is scattered:
    /// the distance; nothing if it passes. `throughput` is multiplied by the weight: its mean over both outcomes is
    /// unbiased.
    std::optional<float> sample_flight(const Vec3& from, const Vec3& w, float length, NumberStream& u,
                                       Color& throughput) const;
    /// An unbiased estimate of the transmittance of that stretch, by channel; exact for a constant extinction.
    Color transmittance(const Vec3& from, const Vec3& w, float length, NumberStream& u) const;

    bool scatters() const { return scatters_; }
    /// sigma_s [1/scene unit] at a point.
    Color scattering_at(const Vec3& p) const { return albedo_.at(p) * extinction_at(p); }
    const PhaseFunction& phase() const { return phase_; }

private:
    std::optional<float> sample_constant(const Vec3& from, const Vec3& w, float length, NumberStream& u,
                                         Color& throughput) const;
    std::optional<float> track_collisions(const Vec3& from, const Vec3& w, float begin, float end, NumberStream& u,
                                          Color& throughput) const;
    /// Interpolation may round to above the highest value of the grid.
    Color extinction_at(const Vec3& p) const { return (scale_ * extinction_.at(p)).min(majorant_); }

    GridVolume extinction_, albedo_;
    float scale_;
    PhaseFunction phase_;
    float majorant_;  ///< [1/scene unit], of all channels
    bool scatters_;
};

}  // namespace gib
