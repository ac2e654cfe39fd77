#pragma once
// The references of an experiment's scenes: made, taken from an image, or taken from another result folder. A
// finished reference is in the result folder.

#include "experiments/references/reference.h"
#include "experiments/results/result_folder.h"
#include "experiments/run/run_setup.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

class References {
public:
    /// Takes over what the folder has: scenes that this run does not reach keep the references of their stored cells.
    References(const RunSetup& setup, const ResultFolder& folder, RunLog& log);

    /// Takes over the reference that the folder has now, which may be the work of another share; none if it has no
    /// intact one.
    void read_stored(std::size_t scene);

    /// The identity of a scene's reference, by its place in RunSetup::scenes; empty: there is none.
    const std::string& identity(std::size_t scene) const { return entries_[scene].identity; }
    /// Remarks that tables have to make about it.
    const std::vector<std::string>& notes(std::size_t scene) const { return entries_[scene].notes; }
    /// Whether it could not be made, so that no cell of the scene has errors.
    bool has_failed(std::size_t scene) const { return entries_[scene].has_failed; }

    /// Brings a reference to its goal. Waits while another process makes it. A failure is kept in the log. Throws
    /// Interrupted.
    void make(std::size_t scene) { advance(scene, std::nullopt); }
    /// make() with at most so much work of this process (ReferenceWork::most_own_work). Returns the batches that other
    /// processes have to make first.
    std::vector<ReferenceBatch> advance(std::size_t scene, std::optional<double> most_own_work);
    /// Makes batches of a reference, unless they are there. Throws Interrupted.
    void make_batches(std::size_t scene, const std::vector<ReferenceBatch>& batches) const;
    /// Takes the reference of another result folder. Returns false if that is not intact or has another identity.
    bool take(std::size_t scene, const ResultFolder& from, const std::string& identity);

private:
    struct Entry {
        std::string identity = {};
        std::vector<std::string> notes = {};
        bool has_failed = false;
    };
    std::vector<ReferenceBatch> make(std::size_t scene, std::optional<double> most_own_work);
    /// Takes the image that the experiment gives.
    void take_given(std::size_t scene);
    ReferenceWork work_of(const RunScene& scene, const LoadedScene& loaded,
                          std::optional<double> most_own_work = std::nullopt) const;

    const RunSetup& setup_;
    const ResultFolder& folder_;
    RunLog& log_;
    std::vector<Entry> entries_;
};

/// The name of a scene's reference in failures.
inline std::string reference_name(const std::string& scene) { return "the reference of " + scene; }

/// Makes `to` a hard link to the file `from`, or a copy if the file system has no hard links; an existing `to` is
/// replaced at once. Throws RunError.
void link_file(const std::string& from, const std::string& to);

}  // namespace gib
