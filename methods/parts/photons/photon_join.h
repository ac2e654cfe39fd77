#pragma once
// The rule by which photons are joined with an eye path, the weight of the joined path, and the photon's direction where
// interpolated normals or curved surfaces disagree with the geometry.

#include "methods/parts/photons/photon.h"
#include "methods/parts/transport/dispersed_path.h"

namespace gib {

/// The part of a path between the eye and the point where photons are looked up.
struct EyePath {
    int max_photon_edges;             ///< largest number of edges of a photon's path, as whole paths are limited
    std::optional<int> stratum = {};  ///< stratum of wavelengths, if the eye path was split

    /// Whether the photon's path may be joined with this one.
    bool accepts(const PhotonPayload& photon) const {
        return photon.edges <= max_photon_edges && can_join(stratum, photon.stratum());
    }
    /// Factor for the photon's power, by channel: see joint_weight().
    Color weight(const PhotonPayload& photon) const { return joint_weight(stratum, photon.stratum()); }
};

/// wi_local, moved to just above the horizon if it lies below it. A photon that passed the test of its normal arrived
/// on wo's side of its own surface. On a curved surface its direction may still lie below the horizon of the
/// look-up's point, and dropping such photons would darken every curved surface.
inline Vec3 lifted_above_horizon(const Vec3& wo_local, Vec3 wi_local) {
    constexpr float horizon = 1e-4f;
    if (wi_local.z() * wo_local.z() <= 0.f) wi_local.z() = std::copysign(horizon, wo_local.z());
    return wi_local;
}

/// |wi.ns| / |wi.ng|, at most 100. The density of photons measures irradiance on the geometric surface, which is in
/// proportion to |wi.ng|; reflection at an interpolated normal is in proportion to |wi.ns|.
inline float shading_normal_factor(const SurfaceHit& hit, const Vec3& wi) {
    if (hit.ns == hit.ng) return 1.f;
    const float towards = std::abs(wi.dot(hit.ns));
    const float of_surface = std::max(std::abs(wi.dot(hit.ng)), 0.01f * towards);
    return of_surface > 0.f ? towards / of_surface : 1.f;
}

}  // namespace gib
