#pragma once
// Irradiance at a point with its gradients, from one stratified sample of the hemisphere.
//
// M x N rays: stratum (j, k) holds sin^2(theta) in [j / M, (j + 1) / M) and phi in 2 pi [k / N, (k + 1) / N), which is
// equal parts of cos(theta) d omega, so E = pi / (M N) sum L_jk. Source: Ward and Heckbert 1992, "Irradiance
// Gradients", which gives both gradients from the same rays (equations 1 and 2 there): how E changes when the surface
// turns follows from the cosine of each ray, how it changes when the point moves from the motion of the edges between
// strata, which is that of the nearer of the two surfaces seen.

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
    int rows;     ///< M, of sin^2(theta)
    int columns;  ///< N, of phi

    /// About `rays` strata that are about as high as wide: N = pi M.
    static HemisphereStrata of(int rays);
    int count() const { return rows * columns; }
    /// The direction of point u of the stratum with this number, j N + k, in a frame around the normal.
    Vec3 direction_local(int stratum, const Vec2& u) const;
};

/// What a ray of one stratum has found.
struct HemisphereSample {
    Color radiance;  ///< [W/(sr m^2)]
    float distance;  ///< of the first surface [scene units]; infinite: none
};

struct IrradianceRecord {
    Vec3 p;
    Vec3 n;                       ///< unit, on the side that is lit
    Color irradiance;             ///< [W/m^2]
    IrradianceGradient rotation;  ///< E changes by rotation . (n x n') when the normal turns to n' [W/m^2 per radian]
    IrradianceGradient translation;  ///< E changes by translation . (p' - p) [W/m^2 per scene unit]
    float distance;  ///< harmonic mean of the distances of what is seen [scene units]; infinite: nothing is; 0: it
                     ///< touches

    /// False: a ray has found what is no radiance, and the record must not be used elsewhere.
    bool is_finite() const;
    /// What the irradiance at p' with the normal n' is, to first order, which may be less than 0.
    Color at(const Vec3& position, const Vec3& normal) const;
};

/// `samples` by number of the stratum; `frame` is that of the directions, its normal the record's.
IrradianceRecord irradiance_record(const Vec3& p, const Frame& frame, const HemisphereStrata& strata,
                                   std::span<const HemisphereSample> samples);

}  // namespace gib
