#pragma once
// Shadow photons: which of the lights shine straight at which surfaces.
// Source: Jensen and Christensen 1995, "Efficiently Rendering Shadows using the Photon Map"; Jensen 2001, section 7.6.
//
// A photon leaves a light and goes straight on through everything. Each diffuse surface on its way keeps it, with the
// share that comes this far: 1 on the first surface (a direct photon), 0 behind a surface (a shadow photon), between
// the two behind holes that let a part through. So on every surface the photons of a light lie as if nothing stood in
// its way, and those around a point say how much of the light is seen from there. The paper gives shadow photons
// negative flux, so that all photons of a light sum to what arrives; kept apart, they also say what would arrive.

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

/// What shadow photons are used for.
enum class Shadows {
    guide,  ///< lights are chosen by what they add near by; every choice is tested by a ray
    skip,   ///< lights are chosen by their power; no shadow ray where all photons near by agree
    both,   ///< chosen as by `guide`, and tested only where photons near by do not agree
    rays    ///< nothing
};
inline constexpr std::array<std::string_view, 4> shadows_names = {"guide", "skip", "both", "rays"};

struct ShadowPhotonSettings {
    std::uint64_t photons = 0;  ///< emitted
    Shadows use = Shadows::guide;
    std::uint32_t agreeing = 32;  ///< photons of a light that must agree before they are believed

    bool skips() const { return use == Shadows::skip || use == Shadows::both; }
    bool guides() const { return use == Shadows::guide || use == Shadows::both; }
};

/// shadow_photons, shadows and shadow_k.
std::vector<Parameter> shadow_photon_parameters();

inline constexpr std::string_view pass_shadow_map = "shadow photon map";
/// Adds its step; skipped where shadow photons are not asked for or cannot say what a shadow ray would.
void add_shadow_map(Plan& plan, const Scene& scene, const ShadowPhotonSettings& settings);

struct ShadowPhoton {
    Vec3 p;
    float power;            ///< in the result's unit, mean of the channels, as if nothing stood in its way
    float visibility;       ///< the share of it that comes here, in [0, 1]
    std::uint32_t light;    ///< index among the scene's lights
    std::uint64_t surface;  ///< SurfaceSide::key() of where it arrived
};

/// Surfaces of different shapes, and those that face differently, see different lights however close they are.
struct SurfaceSide {
    std::uint32_t shape, instance;  ///< as of SurfaceHit
    std::uint32_t side;             ///< the direction along an axis next to the normal: x, -x, y, -y, z, -z

    /// The side of `hit` from which wo looks at it.
    SurfaceSide(const SurfaceHit& hit, const Vec3& wo);
    std::uint64_t key() const { return std::uint64_t{instance} << 32 | shape << 3 | side; }  ///< for 2^29 shapes
    static std::uint32_t side_of_key(std::uint64_t key) { return static_cast<std::uint32_t>(key & 7); }
};
inline constexpr std::uint32_t side_count = 6;

struct ShadowPhotonResult {
    double unit = 1;                    ///< of the photons' power [W]; only ratios count for LightVisibility
    std::vector<ShadowPhoton> photons;  ///< by light, in the order of emission
    std::uint64_t emitted = 0;
    std::uint64_t rays = 0;
};

/// Emits `count` photons, of each light in proportion to light_choice() (to a whole number), from Sobol' points of its
/// own. For a scene without media.
ShadowPhotonResult trace_shadow_photons(const Scene& scene, std::uint64_t count, std::uint64_t seed,
                                        StageProgress* progress = nullptr);

}  // namespace gib
