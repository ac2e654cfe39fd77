#pragma once
// Where the batches of a reference come from: from its folder of batches, where other processes may have left them, or
// from the reference methods.

#include "experiments/references/makers.h"
#include "experiments/references/store.h"

#include <string>
#include <vector>

namespace gib {

class Batches {
public:
    /// `path` is that of the reference, `key` decides the seeds. `keeps_all`: batches that are made go into the folder,
    /// so that other processes find them; else only batches that have taken long, for Ctrl-C.
    Batches(const std::vector<ReferenceMaker>& makers, std::string key, const std::string& path, bool keeps_all);

    bool has(const ReferenceBatch& batch) const { return folder_.has(batch); }
    /// Throws Interrupted on Ctrl-C.
    MadeBatch made(const ReferenceBatch& batch);
    /// Removes the batches that made() has returned so far; the reference's file holds their rounds.
    void remove_used();
    void remove_all() const { folder_.remove_all(); }

private:
    const std::vector<ReferenceMaker>& makers_;
    std::string key_;
    BatchFolder folder_;
    bool keeps_all_;
    std::vector<ReferenceBatch> used_;
};

/// The folder of the batches of the reference at this path.
BatchFolder batch_folder_of(const std::string& path);
/// Makes a batch of the reference of this key. Throws Interrupted on Ctrl-C.
MadeBatch made_batch(const ReferenceMaker& maker, const std::string& key, const ReferenceBatch& batch);

}  // namespace gib
