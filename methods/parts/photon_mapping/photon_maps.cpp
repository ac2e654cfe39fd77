#include "methods/parts/photon_mapping/photon_maps.h"

#include "common/scene/scene.h"
#include "methods/parts/transport/delta_paths.h"

#include <fmt/format.h>
#include <algorithm>

namespace gib {

namespace {

constexpr std::string_view step_caustic_aim = "projection map of the caustic map";
constexpr std::string_view step_global_aim = "projection map of the global map";
/// Photons for each bin of a projection map: with fewer photons a coarser map pays, as it is built faster.
constexpr std::uint64_t photons_per_bin = 16;
constexpr std::uint64_t fewest_bins = 1 << 8, most_bins = 1 << 16;

void add_map(Plan& plan, std::string_view map, std::string why_not, std::uint64_t photons, int max_edges,
             int fewest_edges = 3) {
    if (why_not.empty() && photons == 0) why_not = "no photons are asked for";
    if (why_not.empty() && max_edges < fewest_edges)
        why_not = fmt::format("its paths have at least {} edges, more than max_depth allows",
                              fewest_edges == 3 ? "three" : "two");
    plan.add(map, std::move(why_not));
}

/// In a medium without an end a photon may be scattered although its ray meets no surface, so the photons of the global
/// map are not aimed there. Caustic photons end where a medium scatters them, so those are aimed.
void add_aim(Plan& plan, std::string_view aim, std::string_view map, bool is_bounded, bool projection) {
    std::string reason;
    if (!plan.runs(map)) reason = "its map is not run";
    else if (!projection) reason = "projection=off";
    else if (!is_bounded) reason = "light may be scattered in a medium without an end";
    plan.add(aim, std::move(reason));
}

/// The projection map; null if the plan does not run it, or if it drops no emission.
std::unique_ptr<AimedEmission> build_aim(const Plan& plan, std::string_view aim, const Scene& scene,
                                         TargetSurfaces surfaces, std::uint64_t photons) {
    if (!plan.runs(aim)) return nullptr;
    const std::uint64_t bins = std::clamp(photons / photons_per_bin, fewest_bins, most_bins);
    auto map = AimedEmission::at_surfaces(scene, surfaces, bins);
    return map->aims() ? std::move(map) : nullptr;
}

}  // namespace

Parameter disc_area_parameter() {
    return choice_parameter(
        "area", strings(disc_area_names),
        "photons that count and the area they are divided by: those on the surface, by the part of the disc on it "
        "(surface); those of agreeing normals, by the whole disc (rejected); all within the radius, by the whole disc "
        "(plain)");
}

Parameter volume_parameter() {
    return choice_parameter("volume", strings(volume_look_up_names),
                            "how light in media is found: photons around the end of a free flight, with light sampling "
                            "(points); all photons "
                            "around the eye's ray (ray); the flights of all photons around it (beams)");
}

Parameter projection_parameter() {
    return choice_parameter("projection", {"on", "off"},
                            "lights emit photons only where these can reach surfaces that matter");
}

void add_specular_paths(Plan& plan) {
    plan.add(step_specular, plan.called_for.has(Effect::specular_reflection) || plan.called_for.has(Effect::refraction),
             "no surface is specular");
}

void add_caustic_map(Plan& plan, const PhotonMapSettings& settings) {
    const bool called_for = plan.called_for.has(Effect::caustics);
    add_map(plan, step_caustic, called_for ? "" : "no light reaches a diffuse surface by way of a specular one",
            settings.caustic_photons, settings.max_edges);
}

void add_global_map(Plan& plan, const PhotonMapSettings& settings, const std::string& why_not) {
    const bool called_for = plan.called_for.has(Effect::diffuse_interreflection);
    add_map(plan, step_global, why_not.empty() && !called_for ? "no light passes between diffuse surfaces" : why_not,
            settings.photons, settings.max_edges);
}

void add_volume_map(Plan& plan, const Scene& scene, const PhotonMapSettings& settings) {
    const char* why_not = !scene.has_light()              ? "nothing emits light"
                          : !scene.has_scattering_media() ? "no medium scatters light"
                                                          : "";
    const bool has_straight_light = settings.volume_look_up != VolumeLookUp::points;
    add_map(plan, step_volume, why_not, settings.volume_photons, settings.max_edges, has_straight_light ? 2 : 3);
}

void leave_out_pencils(Plan& plan, const Scene& scene, const PhotonMapSettings& settings) {
    std::vector<Component> looked_for = {Component::direct};
    if (settings.volume_look_up == VolumeLookUp::points) looked_for.push_back(Component::volume);
    leave_out(plan, components_of_pencils(scene, plan.called_for, looked_for));
}

void add_aims(Plan& plan, const Scene& scene, const PhotonMapSettings& settings) {
    add_aim(plan, step_caustic_aim, step_caustic, true, settings.projection);
    add_aim(plan, step_global_aim, step_global, !scene.has_unbounded_medium(), settings.projection);
}

Aims build_aims(const Plan& plan, const Scene& scene, const PhotonMapSettings& settings, StageTimes& stages) {
    const auto timer = stages.time("projection map");
    return {build_aim(plan, step_caustic_aim, scene, TargetSurfaces::specular, settings.caustic_photons),
            build_aim(plan, step_global_aim, scene, TargetSurfaces::all, settings.photons)};
}

PhotonWalkResult PhotonTracing::trace(PhotonMapKind kind, std::uint64_t count, const AimedEmission* aim,
                                      std::uint64_t seed) {
    constexpr std::string_view stage = "photon tracing";
    const auto timer = stages_.time(stage);
    StageProgress progress(stages_, stage, count);
    PhotonWalkResult walk =
        trace_photons(scene_, kind, count, max_edges_, seed, aim, &progress, nullptr, policy_.get());
    rays_ += walk.rays;
    photons_ += walk.emitted;
    return walk;
}

PhotonMap PhotonTracing::map_of(const PhotonWalkResult& walk) {
    const auto timer = stages_.time("tree build");
    return PhotonMap(walk.photons, walk.unit);
}

LightAlongRays PhotonTracing::light_along_rays(const PhotonMapSettings& settings, const BlurRadii& radii,
                                               bool estimates_bias, const AimedEmission* aim, std::uint64_t seed) {
    const bool beams = settings.volume_look_up == VolumeLookUp::beams;
    PhotonWalkResult walk =
        trace(beams ? PhotonMapKind::beams : PhotonMapKind::media, settings.volume_photons, aim, seed);
    const auto timer = stages_.time("tree build");
    constexpr int resolution = 32;
    if (!regions_) regions_ = std::make_unique<FlatRegions>(scene_, resolution);
    return LightAlongRays(std::move(walk), settings.kernel, radii, *regions_, estimates_bias);
}

double PhotonTracing::radius_along_rays(const PhotonMapSettings& settings, const WalkSettings& walk, bool shrinks,
                                        const AimedEmission* aim, std::uint64_t seed) {
    if (settings.volume_radius > 0) return settings.volume_radius * double{scene_.diagonal()};
    PhotonMapSettings pilot = settings;
    pilot.volume_photons = pilot_paths(settings.volume_photons);
    const float longest = longest_radius_along_rays(settings.volume_look_up, pilot.volume_photons, scene_.diagonal());
    constexpr std::uint64_t pilot_key = 0x72;  // keeps these photons apart from those of the maps
    const LightAlongRays light = light_along_rays(pilot, {longest, longest}, false, aim, combine_keys(seed, pilot_key));
    const auto timer = stages_.time("volume radius");
    return gib::radius_along_rays(scene_, walk,
                                  {.light = light,
                                   .look_up = settings.volume_look_up,
                                   .longest = longest,
                                   .pilot = static_cast<double>(pilot.volume_photons),
                                   .paths = static_cast<double>(settings.volume_photons),
                                   .shrinks = shrinks},
                                  seed, rays_);
}

void store(StoredLight& light, std::string_view name, const PhotonMap& map, std::uint64_t emitted) {
    if (map.size() == 0) return;
    StoredPhotons stored{.map = name, .unit = map.unit(), .photons = {}, .emitted = emitted};
    stored.photons.reserve(map.size());
    for (std::size_t i = 0; i < map.size(); ++i)
        stored.photons.push_back(map[i]);
    light.photons.push_back(std::move(stored));
}

void store(StoredLight& light, const PhotonWalkResult& walk) {
    if (!walk.photons.empty())
        light.photons.push_back({.map = "volume", .unit = walk.unit, .photons = walk.photons, .emitted = walk.emitted});
    if (walk.beams.empty()) return;
    light.beams.emitted = walk.emitted;
    for (const PhotonBeam& beam : walk.beams)
        light.beams.beams.push_back({beam.p, beam.end(), static_cast<float>(walk.unit) * beam.power()});
}

}  // namespace gib
