#include "methods/photon_mapper/plan.h"

#include <fmt/format.h>
#include <algorithm>

namespace gib {

namespace {

/// Photons for each bin of a projection map: with fewer photons a coarser map pays, as it is built faster.
constexpr std::uint64_t photons_per_bin = 16;
constexpr std::uint64_t fewest_bins = 1 << 8, most_bins = 1 << 16;

/// Adds the step of a photon map. It runs if its light is called for, its number of photons is not 0, and paths of
/// three edges (light to surface, to another surface, to the eye) are allowed.
void add_map(Plan& plan, std::string_view pass, bool called_for, std::uint64_t photons, int max_edges,
             const std::string& why_not_called_for) {
    std::string reason;
    if (!called_for) reason = why_not_called_for;
    else if (photons == 0) reason = "no photons are asked for";
    else if (max_edges < 3) reason = "its paths have at least three edges, more than max_depth allows";
    plan.add(pass, reason);
}

/// Adds the step of the projection map that aims the photons of `map`. In a medium without an end a photon may be
/// scattered although its ray meets no surface, so the photons of the global map are not aimed there. Caustic photons
/// end where a medium scatters them, so those are aimed.
void add_aim(Plan& plan, std::string_view pass, std::string_view map, bool is_bounded, bool projection) {
    std::string reason;
    if (!plan.runs(map)) reason = "its map is not run";
    else if (!projection) reason = "projection=off";
    else if (!is_bounded) reason = "light may be scattered in a medium without an end";
    plan.add(pass, reason);
}

/// The projection map; null if the plan does not run it, or if it drops no emission.
std::unique_ptr<ProjectionMap> build_aim(const Plan& plan, std::string_view pass, const Scene& scene,
                                         TargetSurfaces surfaces, std::uint64_t photons) {
    if (!plan.runs(pass)) return nullptr;
    const std::uint64_t bins = std::clamp(photons / photons_per_bin, fewest_bins, most_bins);
    auto aim = std::make_unique<ProjectionMap>(scene, surfaces, bins);
    return aim->aims() ? std::move(aim) : nullptr;
}

/// Adds the steps of final gathering, precomputed irradiance and the irradiance cache.
void add_gathering(Plan& plan, const Scene& scene, const PhotonMapperSettings& settings) {
    std::string reason;
    if (!plan.called_for.has(Effect::diffuse_interreflection)) reason = "no light passes between diffuse surfaces";
    else if (settings.gather == 0) reason = "gather=0: indirect light comes from the global map";
    else if (scene.has_media()) reason = "a medium lies between surfaces: indirect light comes from the global map";
    else if (scene.has_dispersion()) reason = "light is split by wavelength: indirect light comes from the global map";
    else if (settings.source != GatherSource::paths && settings.photons == 0) reason = "no photons are asked for";
    else if (settings.max_edges < 3) reason = "its paths have at least three edges, more than max_depth allows";
    plan.add(pass_gather, reason);
    const bool gathers = plan.runs(pass_gather);
    const std::string no_rays = "nothing is gathered";
    plan.add(pass_irradiance,
             !gathers ? no_rays
             : settings.source != GatherSource::irradiance
                 ? fmt::format("source={}", gather_source_names[static_cast<std::size_t>(settings.source)])
                 : "");
    plan.add(pass_cache, !gathers ? no_rays : !settings.cache ? "cache=off" : "");
}

}  // namespace

Parameter disc_area_parameter() {
    return choice_parameter(
        "area", strings(disc_area_names),
        "photons that count and the area they are divided by: those on the surface, by the part of the disc on it "
        "(surface); those of agreeing normals, by the whole disc (rejected); all within the radius, by the whole disc "
        "(plain)");
}

Parameter projection_parameter() {
    return choice_parameter("projection", {"on", "off"},
                            "lights emit photons only where these can reach surfaces that matter");
}

Plan photon_mapper_plan(const Scene& scene, const Effects& effects, const PhotonMapperSettings& settings) {
    Plan plan = described_plan(scene, find_method("photon_mapper"));
    plan.called_for = effects;
    add_eye_paths(plan, scene, settings.max_edges);
    add_light_sampling(plan, settings.max_edges);
    plan.add(pass_specular, effects.has(Effect::specular_reflection) || effects.has(Effect::refraction),
             "no surface is specular");
    add_map(plan, pass_caustic, effects.has(Effect::caustics), settings.caustic_photons, settings.max_edges,
            "no light reaches a diffuse surface by way of a specular one");
    add_gathering(plan, scene, settings);
    const bool needs_photons = !plan.runs(pass_gather) || settings.source != GatherSource::paths;
    add_map(plan, pass_global, needs_photons && effects.has(Effect::diffuse_interreflection), settings.photons,
            settings.max_edges,
            needs_photons ? "no light passes between diffuse surfaces" : "gather rays are followed by path tracing");
    add_map(plan, pass_volume, scene.has_light() && scene.has_scattering_media(), settings.volume_photons,
            settings.max_edges, scene.has_light() ? "no medium scatters light" : "nothing emits light");
    add_aim(plan, pass_caustic_aim, pass_caustic, true, settings.projection);
    add_aim(plan, pass_global_aim, pass_global, !scene.has_unbounded_medium(), settings.projection);
    add_shadow_map(plan, scene, settings.shadows);
    return plan;
}

Aims build_aims(const Plan& plan, const Scene& scene, const PhotonMapperSettings& settings) {
    return {build_aim(plan, pass_caustic_aim, scene, TargetSurfaces::specular, settings.caustic_photons),
            build_aim(plan, pass_global_aim, scene, TargetSurfaces::all, settings.photons)};
}

}  // namespace gib
