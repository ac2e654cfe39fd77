#pragma once
// Participating media, which fill the space between surfaces, absorb light and scatter it.

#include "common/media/grid_volume.h"
#include "common/media/phase.h"
#include "common/sampling/sampler.h"

#include <optional>

namespace gib {

/// Extinction sigma_t [1/scene unit] and albedo sigma_s / sigma_t by channel, constant or on a grid. A medium whose
/// extinction has a cube ends there.
///
/// Estimators, for a stretch of length d along a ray with transmittance T(t) = exp(-integral of sigma_t from 0 to t):
/// - Constant extinction: a channel c is chosen with probability q_c, so that a flight t has the density sum over c
///   of q_c sigma_t,c exp(-sigma_t,c t). The weight is sigma_s T(t) / density where light is scattered, and T(d) /
///   (sum of q_c exp(-sigma_t,c d)) where it passes (the balance heuristic over channels, Veach 1997, section 9.2).
///   q_c is proportional to the throughput: without absorption the weights then keep the sum of its channels, however
///   often a path is scattered (Kutz et al. 2017, "Spectral and Decomposition Tracking for Rendering Heterogeneous
///   Volumes", section 5).
/// - Extinction on a grid: delta tracking (Woodcock et al. 1965) with a majorant M of all channels. A collision is
///   real with a probability P in proportion to the light that is scattered there. The weight is sigma_s / (M P) for
///   a real collision and (M - sigma_t) / (M (1 - P)) for a null one (Galtier et al. 2013, "Integral formulation of
///   null-collision Monte Carlo algorithms").
/// - Transmittance on a grid: ratio tracking (Novak et al. 2014), the product of 1 - sigma_t / M
///   over tentative collisions.
///
/// A medium that scatters nothing is not sampled: light that passes is weighted by T(d).
class Medium {
public:
    /// `scale` multiplies the extinction and is at least 0; the values of the albedo lie between 0 and 1.
    Medium(GridVolume extinction, float scale, GridVolume albedo, const PhaseFunction& phase);

    /// Follows light from a point along the unit vector w for `length` [scene units], which may be infinite. Returns
    /// the distance at which it is scattered [scene units], or nothing if it passes. `throughput` is multiplied by
    /// the weight; the mean of the weight over both outcomes is unbiased.
    std::optional<float> sample_flight(const Vec3& from, const Vec3& w, float length, NumberStream& u,
                                       Color& throughput) const;
    /// An unbiased estimate of the transmittance over `length` along w, by channel; exact for a constant extinction.
    Color transmittance(const Vec3& from, const Vec3& w, float length, NumberStream& u) const;

    bool scatters() const { return scatters_; }
    /// sigma_s [1/scene unit] at a point.
    Color scattering_at(const Vec3& p) const;
    /// The mean free path 1 / sigma_t [scene units] at a point, the shortest of the channels; infinite in vacuum.
    float mean_free_path_at(const Vec3& p) const;
    const PhaseFunction& phase() const { return phase_; }

private:
    std::optional<float> sample_constant(const Vec3& from, const Vec3& w, float begin, float end, NumberStream& u,
                                         Color& throughput) const;
    std::optional<float> track_collisions(const Vec3& from, const Vec3& w, float begin, float end, NumberStream& u,
                                          Color& throughput) const;
    /// The extinction, limited because interpolation may round to above the highest value of the grid.
    Color extinction_at(const Vec3& p) const;

    GridVolume extinction_, albedo_;
    float scale_;
    PhaseFunction phase_;
    float majorant_;  ///< [1/scene unit], of all channels
    bool scatters_;
};

}  // namespace gib
