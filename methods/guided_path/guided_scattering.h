#pragma once
// Scattering at a surface by a field of light or importance beside the bsdf: one-sample multiple importance sampling
// (Veach and Guibas 1995; Mueller et al. 2017, section 3).

#include "methods/guided_path/radiance_field.h"
#include "methods/parts/transport/scattered_ray.h"

namespace gib {

/// A ray whose weight is over the density of the mixture, and whose pdf_w is that of the bsdf alone.
struct MixtureRay : ScatteredRay {
    float mixture_pdf_w;  ///< [1/sr]; the bsdf's for a delta lobe
    float unguided;  ///< largest channel of the weight that it would have had, had the bsdf alone chosen the direction
};

/// Whether a field can choose directions here: some lobe is diffuse, since glossy ones are narrower than a field knows, and a
/// photon (power) does not choose between two normals, see scattered_ray.h.
inline bool has_guidable_lobe(const SurfaceHit& hit, const Vec3& wo_local, Transport transport) {
    if (hit.delta_only || !hit.bsdf->traits_at(wo_local.z()).diffuse) return false;
    return transport == Transport::radiance || hit.is_flat() || !hit.bsdf->traits().delta;
}

/// A direction of the density a q + (1 - a) p, where q is what `known` tells and p that of the bsdf. The bsdf keeps its delta
/// lobes, so q is no part of theirs. With a = 0 this is sample_scattering(). Empty if nothing is scattered.
std::optional<MixtureRay> scatter_by_mixture(const RadianceField::Distribution& known, float a, const SurfaceHit& hit,
                                             const Vec3& wo_local, const VertexNumbers& u, Transport transport);

/// The same in a medium, by its phase function.
struct MixtureDirection {
    Vec3 wi;
    float phase_pdf_w, mixture_pdf_w;  ///< [1/sr]
};
MixtureDirection scatter_by_mixture(const RadianceField::Distribution& known, float a, const PhaseFunction& phase,
                                    const Vec3& wo, const VertexNumbers& u);

}  // namespace gib
