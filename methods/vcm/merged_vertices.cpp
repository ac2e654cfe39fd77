#include "methods/vcm/merged_vertices.h"

#include "methods/parts/density/radius.h"

namespace gib {

MergedVertices::MergedVertices(const Scene& scene, const LightPaths& paths, const PathRules& rules,
                               const MergingSettings& settings, bool follows_specular, std::uint64_t seed)
    : scene_(scene),
      paths_(paths),
      rules_(rules),
      settings_(settings),
      rule_{settings.merges},
      shrinking_(settings.alpha),
      follows_specular_(follows_specular),
      seed_(seed),
      first_radius_(settings.radius * double{scene.diagonal()}),
      first_radius_in_media_(settings.radius_in_media * double{scene.diagonal()}) {}

void MergedVertices::start_pass(std::uint32_t pass, StageTimes& stages, std::uint64_t& rays) {
    const auto timer = stages.time(step_merging);
    const std::uint64_t key = combine_keys(seed_, pass);
    const bool is_given = settings_.radius > 0;
    const double count = is_given ? paths_.count : std::max(paths_.count, fewest_merged_paths);
    rule_.radii = {count, 1, 1};  // for the pilot: any radius, so that walks know of merging
    if (pass == 0 && !(first_radius_ > 0 && first_radius_in_media_ > 0)) find_first_radii(key, rays);
    const std::uint64_t passes_before = settings_.first_pass + pass;
    const double r = first_radius_ * shrinking_.on_surfaces(passes_before);
    const double in_media = first_radius_in_media_ * shrinking_.in_media(passes_before);
    rule_.radii = {count, r, in_media, is_given ? 0.f : static_cast<float>(first_radius_)};
    map_ = LightVertexMap();  // gives its memory back
    map_ = LightVertexMap(scene_, paths_, rules_, rule_, key, rays);
    light_paths_ += static_cast<std::uint64_t>(count);
}

/// Finds the radii that are not given from the paths of a pilot.
void MergedVertices::find_first_radii(std::uint64_t seed, std::uint64_t& rays) {
    const std::uint64_t passes = pilot_passes(rule_.radii.light_paths);
    std::vector<Photon> on_surfaces, in_media;
    for (std::uint64_t pass = 0; pass < passes; ++pass) {
        const LightVertexMap map(scene_, paths_, rules_, rule_, combine_keys(seed, pass), rays);
        for (std::size_t i = 0; i < map.vertices().size(); ++i) {
            const LightVertex vertex = map.vertices()[i];
            (vertex.on_surface ? on_surfaces : in_media).emplace_back(vertex.p, vertex);
        }
    }
    const SeenPlaces seen = seen_places(scene_, {rules_.max_edges, false, follows_specular_}, seed_, rays);
    const auto radius = [&](const std::vector<Photon>& photons, const std::vector<Vec3>& places, int dimensions) {
        return first_radius(photons, static_cast<double>(passes), places, most_merged, dimensions, scene_.diagonal());
    };
    if (!(first_radius_ > 0)) first_radius_ = radius(on_surfaces, seen.on_surfaces, 2);
    if (!(first_radius_in_media_ > 0)) first_radius_in_media_ = radius(in_media, seen.in_media, 3);
}

std::vector<std::pair<std::string, std::string>> MergedVertices::facts() const {
    return {radius_fact("radius", first_radius_, scene_), radius_fact("volume_radius", first_radius_in_media_, scene_)};
}

}  // namespace gib
