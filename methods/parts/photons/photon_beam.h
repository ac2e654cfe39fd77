#pragma once
// The photon beam: a flight of a photon through a medium, from a light, a surface or a scattering event to an end that is
// sampled by the medium's transmittance. Source: Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011, "A Comprehensive Theory of
// Volumetric Radiance Estimation using Photon Points and Beams", section 5.

#include "methods/parts/photons/photon.h"

namespace gib {

class Medium;

/// A beam of light. Its path and its power at its beginning are those of a photon; `edges` counts up to an event on the beam.
struct PhotonBeam : PhotonPayload {
    Vec3 p;        ///< its beginning
    Vec3 w;        ///< unit, the way of the light
    float length;  ///< [scene units]
    float place;   ///< of a random point on it, uniform in [0, 1): its distance from the beginning over the length
    const Medium* medium;  ///< which it crosses

    PhotonBeam(const PhotonPayload& light, const Vec3& from, const Vec3& direction, float reach, float point_place,
               const Medium& crossed)
        : PhotonPayload(light), p(from), w(direction), length(reach), place(point_place), medium(&crossed) {}
    Vec3 end() const { return p + length * w; }
    Vec3 point() const { return p + place * length * w; }
};

}  // namespace gib
