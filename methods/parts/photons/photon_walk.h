#pragma once
// The photon mapper's first pass: photons leave the lights, are scattered or absorbed by Russian roulette, and are
// stored at every diffuse hit, or wherever a medium scatters them, before the roulette. Source: Jensen 2001, "Realistic
// Image Synthesis Using Photon Mapping", chapters 5 and 10.

#include "common/core/math.h"
#include "methods/parts/photons/photon.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gib {

class ProjectionMap;
class Scene;
class StageProgress;

/// Which photons are stored.
enum class PhotonMapKind {
    global,   ///< on diffuse surfaces: those that a diffuse surface or a medium (V) has scattered,
              ///< L (S|D|V)* (D|V) S* D; direct light and caustics are found otherwise
    caustic,  ///< L S+ D; the walk ends at the first diffuse surface or event in a medium
    volume,   ///< in media: L (S|D|V)+ V; light that comes straight from its source is found otherwise
    full      ///< on diffuse surfaces, all: L (S|D|V)* D; for gather rays, which see all light that leaves a surface
};

/// Where the emitted power of a walk went [W]. Absorption is counted as its expectation at every hit, power (1 -
/// albedo), so that the sum is the emitted power only if the roulette and its rescaling are right.
struct PowerBalance {
    Colord emitted = Colord::Zero();  ///< with a projection map only what leaves through its bins
    Colord absorbed = Colord::Zero();
    Colord escaped = Colord::Zero();
    /// What the weights of flights through media took, as it came out: also light that a medium scatters and does not
    /// absorb adds to it, with a mean of zero.
    Colord lost_in_media = Colord::Zero();
    /// Sum over photons of (emitted - absorbed - escaped - lost)^2, from which the standard error of the balance
    /// follows.
    Colord squared_residuals = Colord::Zero();

    PowerBalance& operator+=(const PowerBalance& other);
    PowerBalance& operator*=(double factor);
};

struct PhotonWalkResult {
    double unit = 1;              ///< of the photons' power [W]
    std::vector<Photon> photons;  ///< in the order of emission, aimed ones within a block in that of their bins
    std::uint64_t emitted = 0;    ///< number of photons
    std::uint64_t rays = 0;
    PowerBalance balance;  ///< [W], each photon of power / emitted
};

/// In a medium a photon is stored with its power over the scattering coefficient there [unit x scene unit]: flights end
/// in proportion to sigma_s times the fluence, so that the sum of stored values in a volume is the integral of fluence
/// over it [unit x scene unit], also where the medium thins out (a collision estimator: Spanier and Gelbard 1969,
/// section 2.7).
///
/// Emits exactly `count` photons, each with 1 / count of the power that its light's sample stands for, and returns
/// those stored, the same for any number of threads. `max_edges`: photons whose path to an eye one edge away would be
/// longer are not stored. Photons are independent random numbers, not a low-discrepancy set: the density estimate (k -
/// 1) / (pi r_k^2) is unbiased for a Poisson process, and off by up to 1 / (2 k) for points that keep apart. `aim`:
/// null, or where to emit; its targets must hold the surfaces that photons of this kind meet first. Nothing is traced
/// if it is empty.
PhotonWalkResult trace_photons(const Scene& scene, PhotonMapKind kind, std::uint64_t count, int max_edges,
                               std::uint64_t seed, const ProjectionMap* aim = nullptr,
                               StageProgress* progress = nullptr);

}  // namespace gib
