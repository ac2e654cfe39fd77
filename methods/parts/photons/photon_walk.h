#pragma once
// Photon tracing, the photon mapper's first pass: photons leave the lights and are scattered or absorbed by Russian
// roulette. Each is stored at every diffuse surface that it hits, or wherever a medium scatters it, before the
// roulette. Source: Jensen 2001, "Realistic Image Synthesis Using Photon Mapping", chapter 5, section
// 9.3 and (media) chapter 10.

#include "common/core/math.h"
#include "methods/parts/photons/photon_beam.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gib {

class LightPolicy;
class AimedEmission;
struct RayLog;
class Scene;
class StageProgress;

/// The photons that a walk stores, by the history of their paths: S specular, D diffuse, V in a medium.
enum class PhotonMapKind {
    global,   ///< on diffuse surfaces, L (S|D|V)* (D|V) S* D: scattered by a diffuse surface or a medium
    caustic,  ///< on diffuse surfaces, L S+ D; the walk ends at the first diffuse surface or event in a medium
    volume,   ///< in media, L (S|D|V)+ V: all but photons straight from a light
    full,     ///< on diffuse surfaces, L (S|D|V)* D: all, for gather rays, which see all light that leaves a surface
    media,    ///< in media, L (S|D|V)* V: all
    beams     ///< the flights of the same paths through media, as beams
};

struct PhotonWalkResult {
    double unit = 1;                ///< unit of the photons' power [W]
    std::vector<Photon> photons;    ///< in the order of emission; aimed ones within a block in the order of their bins
    std::vector<PhotonBeam> beams;  ///< instead of photons, if these are asked for
    std::uint64_t emitted = 0;      ///< number of photons emitted
    std::uint64_t rays = 0;
};

/// Tries `count` starts of photons, and returns those that are stored; the result is the same for any number of
/// threads. Each photon starts with 1 / count of the power that its sample of the emission stands for (Jensen 2001,
/// section 5.1). Throws InputError if the photons would need more memory than there is.
///
/// A photon is stored only if its path and one edge to the eye have at most `max_edges` edges. `aim` is null or a
/// projection map whose targets include the surfaces that photons of this kind meet first; nothing is
/// traced if it is empty. If `policy` is not null, photons start and scatter by it, and follow `aim` only where it has no
/// starts of its own. If `log` is not null, the rays are recorded there, which needs with_threads(1, ...).
///
/// Photons are independent random numbers, not a low-discrepancy set: the density estimate (k - 1) / (pi r_k^2) is
/// unbiased for a Poisson process, but off by up to 1 / (2 k) for points that keep apart.
///
/// In a medium a photon is stored with its power divided by the scattering coefficient sigma_s there [unit x scene
/// unit]. Flights end in proportion to sigma_s times the fluence, so the sum of the stored values in a volume is the
/// integral of the fluence over it [unit x scene unit], also where the medium thins out (a collision estimator:
/// Spanier and Gelbard 1969, section 2.7).
PhotonWalkResult trace_photons(const Scene& scene, PhotonMapKind kind, std::uint64_t count, int max_edges,
                               std::uint64_t seed, const AimedEmission* aim = nullptr,
                               StageProgress* progress = nullptr, RayLog* log = nullptr,
                               const LightPolicy* policy = nullptr);

}  // namespace gib
