#pragma once
// The run of paths from both ends: every path from the camera is joined with a path from a light in all ways, and, if
// asked for, takes the light of the vertices of many other light paths by merging. It serves bidirectional and vcm.

#include "methods/parts/density/kernel.h"
#include "methods/parts/vertices/light_paths.h"
#include "methods/parts/vertices/technique_sums.h"

#include "common/sampling/sampler.h"

#include <optional>

namespace gib {

/// Vertices that are merged with one in the mean, if the radius of the first pass is found from its paths.
inline constexpr double most_merged = 2.5;

/// How vertices are merged over the passes.
struct MergingSettings {
    double alpha;  ///< parts/density/shrinking_radius.h
    Kernel kernel;
    double radius;           ///< radius of the first pass [scene diagonals]; 0: found from its light paths
    double radius_in_media;  ///< the same
    std::uint64_t first_pass;
};

struct JoinedPathsSettings {
    PointSet points;
    int max_edges;
    Techniques used;  ///< without its numbers of merging, which follow from the radius
    bool shows_techniques = false;
    std::optional<MergingSettings> merging = {};
};

/// Adds the steps of light paths, eye paths, light sampling and connections.
void add_joined_paths(Plan& plan, const Scene& scene, const JoinedPathsSettings& settings);

inline constexpr std::string_view pass_merging = "merging";

/// Starts the run. Only the passes that `plan` runs are made.
std::unique_ptr<Run> start_joined_paths(const Scene& scene, const JoinedPathsSettings& settings, const Plan& plan,
                                        const ShownComponents& shown, std::uint64_t seed, StageTimes& stages);

}  // namespace gib
