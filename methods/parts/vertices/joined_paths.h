#pragma once
// The run of paths from both ends: every path from the camera is joined with a path from a light in all ways, and, if
// asked for, takes the light of the vertices of many other light paths by merging. It serves bidirectional and vcm.

#include "methods/parts/vertices/merged_vertices.h"

#include <optional>

namespace gib {

struct JoinedPathsSettings {
    PointSet points;
    int max_edges;
    Techniques used;
    bool shows_techniques = false;
    std::optional<MergingSettings> merging = {};
};

/// Adds the steps of light paths, eye paths, light sampling and connections.
void add_joined_paths(Plan& plan, const Scene& scene, const JoinedPathsSettings& settings);

/// Starts the run. Only the steps that `plan` runs are made.
std::unique_ptr<Run> start_joined_paths(const Scene& scene, const JoinedPathsSettings& settings, const Plan& plan,
                                        const ShownComponents& shown, std::uint64_t seed, StageTimes& stages);

}  // namespace gib
