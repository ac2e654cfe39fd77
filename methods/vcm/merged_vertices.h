#pragma once
// Merging over the passes of a run: the vertices of the light paths of the present pass, and the radii, which shrink from
// pass to pass.

#include "methods/parts/density/radius.h"
#include "methods/vcm/light_vertex_map.h"

namespace gib {

/// Light paths in a pass at least, however few pixels there are, unless the radius is given: a small body has to be found in
/// the first passes, and the density of merging has to exceed that of connections there.
inline constexpr double fewest_merged_paths = 1024;
/// Vertices that are merged with one in the mean, if the radius of the first pass is found from its paths.
inline constexpr double most_merged = 2.5;

inline constexpr std::string_view step_merging = "merging";

struct MergingSettings {
    Merges merges;
    double alpha;  ///< parts/density/radius.h
    Kernel kernel;
    double radius;           ///< radius of the first pass [scene diagonals]; 0: found from its light paths
    double radius_in_media;  ///< the same
    std::uint64_t first_pass;
};

/// Merging is the technique that vcm adds to bidirectional path tracing. NoMerging has the meaning of the members.
class MergedVertices {
public:
    using Sample = BiasedSample;
    using Film = BiasedFilm;

    /// `follows_specular`: false where no surface is specular. The scene and the paths must outlive this.
    MergedVertices(const Scene& scene, const LightPaths& paths, const PathRules& rules, const MergingSettings& settings,
                   bool follows_specular, std::uint64_t seed);

    const MergeRule& rule() const { return rule_; }
    bool is_alone() const { return rule_.is_alone(); }
    static BiasedFilm film(const Sensor& sensor, const ShownComponents& shown) {
        return {sensor.width(), sensor.height(), shown.accumulated, shown.black, shown.accumulated};
    }
    static PixelSample& light_of(BiasedSample& sample) { return sample.light; }

    /// Follows the light paths of a pass, whose radii are then those of the rule; adds the rays traced to `rays`.
    void start_pass(std::uint32_t pass, StageTimes& stages, std::uint64_t& rays);

    /// Adds the light that the vertex of a camera's walk takes from the vertices around it.
    void merge(const PathVertex& eye, MergeRule::AlongCamera& along, RayQueries& rays, NumberStream& u,
               BiasedSample& sample) const {
        map_.merge(eye, along, rules_, rule_.radii, settings_.kernel, rays, u, sample);
    }

    std::uint64_t light_paths() const { return light_paths_; }  ///< followed in the passes so far
    /// The radii of the first pass [scene diagonals].
    std::vector<std::pair<std::string, std::string>> facts() const;

private:
    void find_first_radii(std::uint64_t seed, std::uint64_t& rays);

    const Scene& scene_;
    const LightPaths& paths_;
    PathRules rules_;
    MergingSettings settings_;
    MergeRule rule_;
    ShrinkingRadius shrinking_;
    bool follows_specular_;
    std::uint64_t seed_;
    double first_radius_, first_radius_in_media_;  ///< [scene units]; 0: not found yet
    LightVertexMap map_;
    std::uint64_t light_paths_ = 0;
};

}  // namespace gib
