#pragma once
// Participating media, which fill the space between surfaces, absorb light and scatter it.

#include "common/media/grid_volume.h"
#include "common/media/phase.h"
#include "common/sampling/sampler.h"

#include <optional>
#include <utility>
#include <vector>

namespace gib {

/// An estimate of the transmittance T(t) from the start of a ray up to t, for all t at once: unbiased for each t, and exact
/// where the extinction is constant.
class TransmittanceAlong {
public:
    Color at(float t) const;

private:
    friend class Medium;
    float begin_ = 0.f, end_ = 0.f;     ///< the part of the ray that lies in the medium
    Color extinction_ = Color::Zero();  ///< constant along the ray; 0 where the steps hold T
    std::vector<std::pair<float, Color>> steps_;
};

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
/// - Beams: the power that a beam still has at t is 0 beyond an end sampled by analogue tracking of one channel, chosen with
///   the probability q_c in proportion to the power (Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011, "A Comprehensive Theory
///   of Volumetric Radiance Estimation using Photon Points and Beams", section 5.2: short beams, whose transmittance has the
///   values 0 and 1). With a constant extinction the power is weighted by T(t) / (sum of q_c exp(-sigma_t,c t)), which is 1
///   without colour; on a coloured grid the beam has the power of the chosen channel alone, divided by q_c.
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

    /// An estimate of the transmittance up to every point of the stretch. `u` is used on a grid only.
    TransmittanceAlong transmittance_along(const Vec3& from, const Vec3& w, float length, NumberStream& u) const;

    /// The stretch, in distances from the start of a ray, that a beam of light fills.
    struct Reach {
        float begin, end;
    };
    /// Samples the reach of a beam of light from a point along w, at most `length`; empty if it misses the medium. The
    /// mean of power_along(power, t - begin) over reaches that hold t is the power given times T(t).
    std::optional<Reach> sample_reach(const Vec3& from, const Vec3& w, float length, NumberStream& u,
                                      Color& power) const;
    /// The power of a beam at the distance t from the beginning of its reach; sample_reach() has set `power`.
    Color power_along(const Color& power, float t) const;

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
    /// Ratio tracking on [begin, end) along w: calls passed(t, T) after every tentative collision and returns T(end).
    template <typename Passed>
    Color track_ratio(const Vec3& from, const Vec3& w, float begin, float end, NumberStream& u, Passed&& passed) const;
    /// The extinction, limited because interpolation may round to above the highest value of the grid.
    Color extinction_at(const Vec3& p) const;

    GridVolume extinction_, albedo_;
    float scale_;
    PhaseFunction phase_;
    float majorant_;  ///< [1/scene unit], of all channels
    bool scatters_;
};

}  // namespace gib
