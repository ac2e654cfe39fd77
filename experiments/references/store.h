#pragma once
// The files of references: the groups that rounds add to, the batches that a round is made of, and images that were
// made elsewhere.

#include "common/images/image.h"
#include "experiments/metrics/reference_image.h"

#include <cstdint>
#include <functional>
#include <optional>
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
    std::uint64_t units = 0;  ///< in each group, of work as MethodShare has it; the attribute `passes`
    double seconds = 0;       ///< wall-clock, all rounds and the pilot together
    double work = 0;          ///< work of all rounds together (MadeBatch::work); 0 in files of older versions
    DroppedSamples dropped;

    /// Adds a round: `batches` has for each group the image of a batch of `batch_units` units. Throws RunError if
    /// the components of the batches differ.
    void add_round(const std::vector<ComponentImages>& batches, std::uint64_t batch_units);
    /// Forgets the images and what it took to make them; `rounds`, which decide seeds, and the rest are kept.
    void restart() {
        groups_.clear();
        units = 0;
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

struct ReferenceBatch {
    std::uint32_t method = 0;         ///< place of its method among those of the reference
    std::uint32_t number = 0;         ///< decides the seed (batch_seed())
    std::uint32_t passes = 1;         ///< passes that it makes
    std::uint64_t passes_before = 0;  ///< earlier passes of this method in the group; merging methods go on from there

    friend bool operator==(const ReferenceBatch&, const ReferenceBatch&) = default;
};

/// The seed of a method's batch. Its top bit is set, so that it differs from all seeds of cells, which count from 1.
std::uint64_t batch_seed(const std::string& key, std::uint32_t batch, std::uint32_t method = 0);

/// The mean image of a batch and what it took to make it.
struct MadeBatch {
    ComponentImages images;
    DroppedSamples dropped = {};
    double work = 0;     ///< rays and camera samples, times ray_cost; the same on every machine, which seconds are not
    double seconds = 0;  ///< wall-clock
};

/// Makes a batch, or takes it from where it is stored.
using MakeBatch = std::function<MadeBatch(const ReferenceBatch&)>;

/// The folder of the batches of the reference at `path`, where other processes may leave them.
class BatchFolder {
public:
    explicit BatchFolder(const std::string& path) : path_(path + ".batches") {}

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

/// Reads an image as the reference of a scene whose images have this size [pixels]; `scene`: its scene_attributes().
/// Throws InputError if it is missing or damaged, has another size, or says that it shows another scene.
Reference read_reference_of(const std::string& path, int width, int height,
                            const std::map<std::string, std::string>& scene);

struct GivenReference {
    Reference reference;
    std::string identity;            ///< as stored_reference_identity() returns it once the reference is written
    std::vector<std::string> notes;  ///< remarks that tables have to make about it
};

/// A reference for a run, from one image or from several replicates, whose scatter gives the standard error. A note
/// says if the standard error is unknown (no layer `stderr`, no groups). Throws InputError also if the image is black
/// or has values that are not finite.
GivenReference given_reference(const std::vector<std::string>& paths, int width, int height,
                               const std::map<std::string, std::string>& scene);

/// Throws InputError unless memory can hold what is alive while the file of a reference of this size [pixels] is
/// written.
void require_memory_for_reference(int width, int height);

}  // namespace gib
