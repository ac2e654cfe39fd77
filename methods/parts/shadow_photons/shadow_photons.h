#pragma once
// Shadow photons: which lights shine straight at which surfaces.
// Source: Jensen and Christensen 1995, "Efficiently Rendering Shadows using the Photon Map"; Jensen 2001, chapter 11.
//
// A photon leaves a light and flies straight on through everything. Each diffuse surface on its way stores it with
// the share of its power that arrives there: 1 on the first surface (a direct photon), 0 behind a surface (a shadow
// photon), and a value between behind surfaces with holes that let a part through. So the photons of a light lie on
// every surface as if nothing stood in their way. The mean share of the photons around a point estimates how much of
// the light the point sees. In the paper shadow photons have negative flux, so that all photons of a light sum to the
// flux that arrives. Here power and share are kept apart, so that the photons also hold the flux that would arrive
// without obstacles.

#include "common/core/math.h"
#include "methods/parameters.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace gib {

class Scene;
struct SurfaceHit;
class StageProgress;
struct Plan;

/// The parameter shadow_photons.
Parameter shadow_photons_parameter();

inline constexpr std::string_view step_shadow_map = "shadow photon map";
/// Adds the step of the shadow photon map. It is skipped where shadow photons are not asked for, where lights are not
/// sampled, and where media dim light, since only a ray can find by how much.
void add_shadow_map(Plan& plan, const Scene& scene, std::uint64_t photons);

struct ShadowPhoton {
    Vec3 p;
    float power;            ///< power in the result's unit; mean of the channels, as if nothing stood in the way
    float visibility;       ///< share of the power that arrives here, in [0, 1]
    std::uint32_t light;    ///< index among the scene's lights
    std::uint64_t surface;  ///< SurfaceSide::key() of the surface that stores the photon
};

/// One side of a surface. Shadow photons are kept apart by side, since surfaces of different shapes or orientations may
/// see different lights however close they are.
struct SurfaceSide {
    std::uint32_t shape, instance;  ///< as in SurfaceHit
    std::uint32_t side;             ///< the axis nearest to the normal: 0 to 5 for x, -x, y, -y, z, -z

    /// The side of `hit` that faces wo.
    SurfaceSide(const SurfaceHit& hit, const Vec3& wo);
    /// Unique for up to 2^29 shapes.
    std::uint64_t key() const { return std::uint64_t{instance} << 32 | shape << 3 | side; }
    static std::uint32_t side_of_key(std::uint64_t key) { return static_cast<std::uint32_t>(key & 7); }
};
inline constexpr std::uint32_t side_count = 6;

struct ShadowPhotonResult {
    double unit = 1;                    ///< unit of the photons' power [W]; LightVisibility uses ratios only
    std::vector<ShadowPhoton> photons;  ///< sorted by light, then in the order of emission
    std::uint64_t emitted = 0;
    std::uint64_t rays = 0;
};

/// Emits `count` photons from Sobol' points, one sequence for each light. A light gets its number of photons in
/// proportion to light_choice(), rounded to a whole number. For scenes without media. Throws InputError if the
/// photons would need more memory than there is.
ShadowPhotonResult trace_shadow_photons(const Scene& scene, std::uint64_t count, std::uint64_t seed,
                                        StageProgress* progress = nullptr);

}  // namespace gib
