#pragma once
// Irradiance at a point with its gradients, from one stratified sample of the hemisphere.
//
// The hemisphere is divided into M x N strata with one ray each. Stratum (j, k) spans sin^2(theta) in
// [j / M, (j + 1) / M) and phi in 2 pi [k / N, (k + 1) / N). All strata thus have equal parts of cos(theta) d omega,
// and E = pi / (M N) sum L_jk. Source: Ward and Heckbert 1992, "Irradiance Gradients", which computes both gradients
// from the same rays (equations 1 and 2 there). The rotation gradient follows from the change of each ray's cosine as
// the surface turns, the translation gradient from the motion of the edges between strata as the point moves. An edge
// moves as the nearer of the two surfaces that are seen on its sides.

#include "common/core/math.h"

#include <array>
#include <span>
#include <vector>

namespace gib {

/// By channel: the derivatives of irradiance with respect to three coordinates.
using IrradianceGradient = std::array<Vec3, 3>;

/// g . v in each channel.
inline Color dot(const IrradianceGradient& g, const Vec3& v) { return {g[0].dot(v), g[1].dot(v), g[2].dot(v)}; }

struct HemisphereStrata {
    int rows;     ///< M, the divisions of sin^2(theta)
    int columns;  ///< N, the divisions of phi

    /// About `rays` strata which are about as high as wide: N = pi M.
    static HemisphereStrata of(int rays);
    int count() const { return rows * columns; }
    /// The direction of the point u in [0, 1)^2 of stratum number j N + k, in a frame around the normal.
    Vec3 direction_local(int stratum, const Vec2& u) const;
};

/// The result of the ray of one stratum.
struct HemisphereSample {
    Color radiance;  ///< [W/(sr m^2)]
    float distance;  ///< distance to the first surface [scene units]; infinite if there is none
};

struct IrradianceRecord {
    Vec3 p;
    Vec3 n;                       ///< unit, on the side that is lit
    Color irradiance;             ///< [W/m^2]
    IrradianceGradient rotation;  ///< E changes by rotation . (n x n') when the normal turns to n' [W/m^2 per radian]
    IrradianceGradient translation;  ///< E changes by translation . (p' - p) [W/m^2 per scene unit]
    /// Harmonic mean of the distances to the surfaces seen [scene units]; infinite if none is seen, 0 if
    /// one touches p.
    float distance;

    /// False if a ray returned a radiance that is not finite; such a record must not be used elsewhere.
    bool is_finite() const;
    /// The irradiance [W/m^2] at `position` with the normal `normal`, extrapolated to first order; it
    /// may be negative.
    Color at(const Vec3& position, const Vec3& normal) const;
};

/// The record at p with both gradients (Ward and Heckbert 1992, equations 1 and 2) from one sample of each stratum,
/// in the order of the strata's numbers. `frame` is the frame of the samples' directions; its normal is the record's.
IrradianceRecord irradiance_record(const Vec3& p, const Frame& frame, const HemisphereStrata& strata,
                                   std::span<const HemisphereSample> samples);

}  // namespace gib
