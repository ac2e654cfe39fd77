#pragma once
// Batches of a reference as files. A batch is what one maker makes from one seed; a round adds one or more of them to
// each group. Batches depend on nothing but their own numbers, so that any process, on any machine, may make them and
// leave them in the folder of the reference, where the process that adds up the rounds finds them. The sum is the same
// bit for bit as if that process had made them all itself.

#include "common/images/image.h"
#include "experiments/measuring/reference_store.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gib {

struct ReferenceBatch {
    std::uint32_t maker = 0;          ///< its place among the makers of the reference
    std::uint32_t number = 0;         ///< decides the seed (batch_seed())
    std::uint32_t passes = 1;         ///< passes that it makes
    std::uint64_t passes_before = 0;  ///< passes of this maker in the group before; merging methods go on from there
};

/// The seed of a maker's batch. Its top bit is set, so that it differs from all seeds of cells, which count from 1.
std::uint64_t batch_seed(const std::string& key, std::uint32_t batch, std::uint32_t maker = 0);

/// The mean image of a batch and what it took to make it.
struct MadeBatch {
    ComponentImages images;
    DroppedSamples dropped = {};
    double work = 0;     ///< rays and camera samples; the same on every machine, which seconds are not
    double seconds = 0;  ///< wall-clock
};

class BatchFolder {
public:
    explicit BatchFolder(std::string path) : path_(std::move(path)) {}

    bool has(const ReferenceBatch& batch) const;
    /// Empty if there is no such batch, or if its file is damaged.
    std::optional<MadeBatch> read(const ReferenceBatch& batch) const;
    /// The file appears whole or not at all.
    void write(const ReferenceBatch& batch, const MadeBatch& made) const;
    void remove(const ReferenceBatch& batch) const;
    /// Removes the folder with all batches.
    void remove_all() const;

private:
    std::string file_of(const ReferenceBatch& batch) const;

    std::string path_;
};

}  // namespace gib
