#pragma once
// Makes references. A reference consists of groups; each round adds to every group one batch of passes with a seed of
// its own, until the standard error, which is estimated from the groups, is small enough. An existing file is topped
// up rather than made again.
//
// Where a target ends it, nothing depends on time: the methods' shares and the passes of every round follow from the
// images and from counts of rays, so that the reference is the same bit for bit on every machine of one processor type,
// with any number of threads, and whoever made its batches. Time decides only where a time limit comes into sight.

#include "common/reader/scene_file.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/plan/experiment_file.h"
#include "experiments/references/store.h"
#include "experiments/system/progress.h"
#include "methods/method.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The methods of a reference of this label (reference_methods()); for `auto` without methods that equal another one in
/// this scene.
std::vector<const MethodDescription*> methods_for(const LoadedScene& scene, const MethodLabel& label);

struct ReferenceWork {
    const LoadedScene& scene;
    std::vector<const MethodDescription*> methods;  ///< methods that make it together (methods_for())
    MethodLabel label;                              ///< label of the reference, without spp
    ReferenceGoal goal;
    std::optional<double> epsilon;  ///< [radiance^2] of the relative error that `goal` bounds; none: the default
    std::string path;               ///< path of the file, which is read if it exists and written when it has improved
    std::uint64_t seed = 1;         ///< references of different seeds are independent
    /// The most work (MadeBatch::work) that this process may do itself; none: all that the goal takes. More is left to
    /// others: make_reference() then returns with FinishedReference::missing.
    std::optional<double> most_own_work = std::nullopt;
};

struct FinishedReference {
    Reference reference;
    double relative_error = 0;          ///< relative standard error of the total
    double epsilon = 0;                 ///< epsilon of this error [radiance^2]
    std::string identity;               ///< key and passes of each group; changes when the file is topped up
    std::vector<std::string> warnings;  ///< target missed, heavy tails, components not sampled, a file made again
    std::uint32_t rounds_added = 0;
    /// Batches to be made by others before the reference can go on; empty: it has reached its goal.
    std::vector<ReferenceBatch> missing = {};
};

/// SHA-1 of everything that decides the reference's image: the scene's content hash, the method's label,
/// `glossy_roughness` and the seed. 40 hexadecimal digits.
std::string reference_key(const std::string& content_hash, const MethodLabel& label, std::uint64_t seed = 1);

/// The path at which `gibench run` keeps a reference, relative to the folder in which the program was started.
std::string cached_reference_path(const std::string& key);

/// Adds rounds until the goal is met, and stores the file; every round adds one batch of equal length to each group.
/// Batches that lie in the reference's folder of batches are taken from there.
/// `progress` shows how far it has come. The caller must hold lock_reference() and call it inside with_threads().
/// Throws Interrupted on Ctrl-C, after the complete rounds are stored, and RunError if the image is not finite.
FinishedReference make_reference(const ReferenceWork& work, ProgressLine& progress);

/// Makes a batch of a reference, unless it is there, and leaves it in the reference's folder of batches. The caller
/// must call it inside with_threads(). Throws Interrupted on Ctrl-C.
void make_batch(const ReferenceWork& work, const ReferenceBatch& batch);

/// FinishedReference::identity of a stored file; empty if there is none or if it cannot be read.
std::string stored_reference_identity(const std::string& path);

}  // namespace gib
