#pragma once
// Holds the groups of a reference, to which each round adds, and reads them from its file.

#include "experiments/metrics/reference_image.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gib {

/// Samples that were dropped because they were not finite.
struct DroppedSamples {
    std::uint64_t count = 0;
    std::string first;  ///< seed, pass and pixel of the first one

    void add(const DroppedSamples& other) {
        if (count == 0) first = other.first;
        count += other.count;
    }
};

/// The mean image of each group so far, and the work that went into it.
class ReferenceGroups {
public:
    std::uint32_t rounds = 0;
    std::uint64_t passes = 0;  ///< number of passes in each group
    double seconds = 0;        ///< wall-clock, all rounds and the pilot together
    double work = 0;           ///< work of all rounds together (MadeBatch::work); 0 in files of older versions
    DroppedSamples dropped;

    /// Adds a round: `batches` has for each group the image of a batch of `batch_passes` passes. Throws RunError if
    /// the components of the batches differ.
    void add_round(const std::vector<ComponentImages>& batches, std::uint64_t batch_passes);
    /// Forgets the images and what it took to make them; `rounds`, which decide seeds, and the rest are kept.
    void restart() {
        groups_.clear();
        passes = 0;
        work = 0;
    }
    const std::vector<ComponentImages>& groups() const { return groups_; }
    /// The reference so far: mean, standard error and groups of the total and of every component, without metadata.
    Reference reference() const;

    /// Reads the groups from a reference's file. Throws InputError, with the reason, if it is not the reference of
    /// `key`, has another size, or is not verified by a digest.
    static ReferenceGroups read(const std::string& path, const std::string& key, int width, int height);

private:
    std::vector<ComponentImages> groups_;
};

}  // namespace gib
