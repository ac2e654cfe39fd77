#pragma once
// Making references: groups of independently seeded batches, in rounds, until the standard error is small enough. A
// file is topped up rather than made again.

#include "common/reader/scene_file.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/plan/experiment_file.h"
#include "experiments/system/progress.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gib {

struct ReferenceWork {
    const LoadedScene& scene;
    const MethodDescription& method;
    MethodLabel label;  ///< of that method, without spp
    ReferenceGoal goal;
    double epsilon;    ///< of the relative error that the goal speaks of
    std::string path;  ///< of the file: read if it is there, written when better
};

struct FinishedReference {
    Reference reference;
    double relative_error = 0;  ///< standard error of the total, relative
    std::string identity;       ///< key and number of samples: changes when the file is topped up
    std::vector<std::string>
        warnings;  ///< target not met, heavy tails, unresolved components, a file that was made again
    std::uint32_t rounds_added = 0;
};

/// Of all that the reference's image converges to: the scene's content and the method's label. 40 hexadecimal digits.
std::string reference_key(const std::string& content_hash, const MethodLabel& label);

/// Where `gibench run` keeps a reference, under the folder that it was started in.
std::string cached_reference_path(const std::string& key);

/// Brings the file to the goal: every round adds one batch of equal length to each group. Progress to `progress`. Call
/// it inside with_threads and under lock_reference(). Throws Interrupted on Ctrl-C, after the complete rounds were
/// stored, and RunError if the image is not finite.
FinishedReference make_reference(const ReferenceWork& work, ProgressLine& progress);

/// The identity of a finished file; empty if there is none or it cannot be read.
std::string stored_reference_identity(const std::string& path);

/// The seed of a batch. Its top bit is set: a cell's seeds, which count from 1, cannot meet it.
std::uint64_t batch_seed(const std::string& key, std::uint32_t batch);

/// The share of the groups' scatter that the most deviant group of each pixel carries: about 0.27 for Gaussian noise of
/// 16 groups, near 1 where rare bright samples make the image. 0 where nothing scatters.
double dominance_of_one_group(const std::vector<Image>& groups);

}  // namespace gib
