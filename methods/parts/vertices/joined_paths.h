#pragma once
// The run of paths from both ends: every path from the camera is joined with a path from a light in all ways, and, if
// asked for, takes the light of the vertices of many other light paths by merging. It serves bidirectional and vcm.

#include "common/images/splat_film.h"
#include "methods/parts/transport/pixel_samples.h"
#include "methods/parts/vertices/connections.h"
#include "methods/parts/vertices/merged_vertices.h"
#include "methods/parts/vertices/shared_vertices.h"
#include "methods/parts/vertices/technique_pyramid.h"

#include <optional>
#include <utility>
#include <vector>

namespace gib {

struct JoinedPathsSettings {
    PointSet points;
    int max_edges;
    Techniques used;
    bool shows_techniques = false;
    std::optional<MergingSettings> merging = {};
    std::size_t shared_paths = 1;  ///< pixels of a group, which share their light paths (shared_vertices.h)
};

/// The data of one pass, which the estimates of all pixels share.
struct PassOfPaths {
    const LightPaths& paths;
    PathRules rules;
    SplatFilm& splats;
    PointSet points = PointSet::sobol;  ///< of the random numbers, and `seed`: for light paths of a group of pixels
    std::uint64_t seed = 0;
    std::uint32_t pass = 0;
    std::size_t shared_paths = 1;            ///< JoinedPathsSettings::shared_paths
    TechniquePyramid* pyramid = nullptr;     ///< null: no images of techniques are kept
    const MergedVertices* merged = nullptr;  ///< null: nothing is merged
};

/// The estimate of the samples of some pixels, in groups if they share their light paths.
class JoinedPathsEstimate {
public:
    explicit JoinedPathsEstimate(const PassOfPaths& pass) : pass_(pass), used_(pass.rules.used) {}

    /// Follows the light paths of the pixels that share theirs, before their samples, which come in this order.
    void start_group(RayQueries& rays, std::span<const PixelPlace> places);

    /// The light of the paths from the camera that end in this pixel. That of light paths which reach the camera, in any pixel,
    /// goes to the film of splats, or is appended to `kept` if this is not null.
    BiasedSample operator()(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, std::size_t pixel,
                            std::vector<std::pair<std::size_t, PixelSample>>* kept = nullptr);

private:
    void follow_light(RayQueries& rays, const Sampler& sampler);
    void splat(const std::optional<Splat>& splat, int s);

    const PassOfPaths& pass_;
    const Techniques& used_;
    std::vector<std::pair<std::size_t, PixelSample>>* kept_ = nullptr;
    SharedVertices<PathVertex> light_vertices_;
    std::size_t next_ = 0;  ///< the group's pixel whose sample comes next
};

/// Whether vertices of both walks are connected with each other.
inline bool connects_paths(const Techniques& used) { return used.connections && !used.only_merging(); }

/// Pixels whose paths from the camera share their light paths.
inline constexpr std::string_view shared_paths_name = "shared_paths";
Parameter shared_paths_parameter();
std::size_t shared_paths_of(const ParameterValues& values);

/// Adds the steps of light paths, eye paths, light sampling and connections.
void add_joined_paths(Plan& plan, const Scene& scene, const JoinedPathsSettings& settings);

/// Starts the run, with light sampling, eye paths, aim and merging where `plan` runs them.
std::unique_ptr<Run> start_joined_paths(const Scene& scene, const JoinedPathsSettings& settings, const Plan& plan,
                                        const ShownComponents& shown, std::uint64_t seed, StageTimes& stages);

}  // namespace gib
