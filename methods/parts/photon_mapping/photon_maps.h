#pragma once
// The photon maps that the eye pass looks up: their settings, the steps of a plan that make them, the projection maps that
// aim their photons, and how they are filled. Source: Jensen 2001, section 9.3.

#include "methods/method.h"
#include "methods/parts/density/radius_along_rays.h"
#include "methods/parts/emission/aimed_emission.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/photons/photon_walk.h"
#include "methods/parts/stored_light/stored_light.h"

#include <memory>

namespace gib {

struct PhotonMapSettings {
    std::uint64_t photons;          ///< emitted for the global map
    std::uint64_t caustic_photons;  ///< emitted for the caustic map
    std::uint64_t volume_photons;   ///< emitted for the volume map
    std::size_t k;                  ///< photons in an estimate of the global map, or all_photons
    std::size_t caustic_k;          ///< photons in an estimate of the caustic map, or all_photons
    std::size_t volume_k;           ///< photons in an estimate of the volume map, or all_photons
    double radius;                  ///< largest look-up radius in the global map [scene diagonals]
    double caustic_radius;          ///< largest look-up radius in the caustic map [scene diagonals]
    double volume_radius;           ///< largest look-up radius in the volume map [scene diagonals]; 0: is found
    VolumeLookUp volume_look_up = VolumeLookUp::points;
    Kernel kernel;
    DiscArea area;
    int max_edges;    ///< edges of the longest path
    bool projection;  ///< lights emit photons only where these can reach surfaces that matter
};

/// The parameters `area`, `volume` and `projection`.
Parameter disc_area_parameter();
Parameter volume_parameter();
Parameter projection_parameter();

inline constexpr std::string_view step_specular = "specular paths";
inline constexpr std::string_view step_caustic = "caustic map";
inline constexpr std::string_view step_global = "global map";
inline constexpr std::string_view step_volume = "volume map";

/// Each adds a step, which is skipped where its light is not called for, where its number of photons is 0, or where
/// paths of three edges (light to surface, to another surface, to the eye) are not allowed. `why_not` says why the method
/// does not need the global map; empty if it does.
void add_specular_paths(Plan& plan);
void add_caustic_map(Plan& plan, const PhotonMapSettings& settings);
void add_global_map(Plan& plan, const PhotonMapSettings& settings, const std::string& why_not = "");
void add_volume_map(Plan& plan, const Scene& scene, const PhotonMapSettings& settings);
/// Has the plan leave out the light of pencils that paths from the camera look for: direct light, and with volume=points light
/// that a medium scatters once.
void leave_out_pencils(Plan& plan, const Scene& scene, const PhotonMapSettings& settings);
/// Adds the steps of the projection maps that aim the photons of these maps. A projection map that runs is built at the
/// start of the run. Only then is it known whether it drops any emission; otherwise photons leave the lights in all directions.
void add_aims(Plan& plan, const Scene& scene, const PhotonMapSettings& settings);

/// The projection maps that aim the photons of each map; null where photons leave the lights in all directions.
struct Aims {
    std::unique_ptr<AimedEmission> caustic, global;
};
/// Builds the projection maps that the plan runs and keeps those that drop emission.
Aims build_aims(const Plan& plan, const Scene& scene, const PhotonMapSettings& settings, StageTimes& stages);

/// The first pass (Jensen 2001, section 9.3): emits photons and makes maps of them. It counts the photons and their rays.
class PhotonTracing {
public:
    PhotonTracing(const Scene& scene, int max_edges, StageTimes& stages)
        : scene_(scene), max_edges_(max_edges), stages_(stages) {}

    /// Has later photons start and scatter by this policy; null: plainly.
    void follow(std::shared_ptr<const LightPolicy> policy) { policy_ = std::move(policy); }

    /// Emits `count` photons for a map of this kind. `aim` may be null.
    PhotonWalkResult trace(PhotonMapKind kind, std::uint64_t count, const AimedEmission* aim, std::uint64_t seed);
    PhotonMap map_of(const PhotonWalkResult& walk);
    PhotonMap traced_map(PhotonMapKind kind, std::uint64_t count, const AimedEmission* aim, std::uint64_t seed) {
        return map_of(trace(kind, count, aim, seed));
    }
    /// The light in media of `settings.volume_photons` photons, for look-ups along rays with these radii.
    LightAlongRays light_along_rays(const PhotonMapSettings& settings, const BlurRadii& radii, bool estimates_bias,
                                    const AimedEmission* aim, std::uint64_t seed);
    /// The radius of these look-ups [scene units]: that of the settings, or else the one that radius_along_rays() finds for
    /// one map, or for the first of many whose radius `shrinks`.
    double radius_along_rays(const PhotonMapSettings& settings, const WalkSettings& walk, bool shrinks,
                             const AimedEmission* aim, std::uint64_t seed);

    std::uint64_t photons() const { return photons_; }
    std::uint64_t rays() const { return rays_; }
    bool has_policy() const { return policy_ != nullptr; }

private:
    const Scene& scene_;
    int max_edges_;
    StageTimes& stages_;
    std::shared_ptr<const LightPolicy> policy_;  ///< of photons, null: none
    std::unique_ptr<FlatRegions> regions_;       ///< for look-ups along rays
    std::uint64_t photons_ = 0, rays_ = 0;
};

/// Adds the photons of a map, unless it is empty, to the light that a run stores; `emitted` were emitted for it.
void store(StoredLight& light, std::string_view name, const PhotonMap& map, std::uint64_t emitted);
/// The same for the photons of a walk in media, or its beams.
void store(StoredLight& light, const PhotonWalkResult& walk);

}  // namespace gib
