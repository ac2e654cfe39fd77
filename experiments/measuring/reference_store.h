#pragma once
// The groups of a reference in memory and in its file: what is added up round by round.

#include "experiments/metrics/reference_image.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gib {

/// Samples that were not finite.
struct DroppedSamples {
    std::uint64_t count = 0;
    std::string first;  ///< its seed, pass and pixel
};

/// The means of all groups so far, and how they came about.
class ReferenceGroups {
public:
    std::uint32_t rounds = 0;
    std::uint64_t passes = 0;  ///< of each group
    double seconds = 0;        ///< wall-clock, all rounds together
    DroppedSamples dropped;
    bool verified = true;  ///< false: read from a file without a digest

    /// Adds a round: for each group the image of a batch of `batch_passes`. Throws RunError if the batches' components
    /// differ.
    void add_round(const std::vector<ComponentImages>& batches, std::uint64_t batch_passes);
    /// Mean and standard error of everything; without metadata.
    Reference reference() const;

    /// From a file that reference_metadata() describes. Throws InputError that says what is wrong with the file.
    static ReferenceGroups read(const std::string& path, const std::string& key, int width, int height);

private:
    std::vector<ComponentImages> groups_;
};

}  // namespace gib
