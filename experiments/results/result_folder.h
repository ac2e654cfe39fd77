#pragma once
// What a result folder holds besides tables: the index of the experiment and one record for each complete cell. Tables
// and the report are made from these alone.

#include "experiments/measuring/measure.h"
#include "experiments/metrics/statistics.h"
#include "experiments/plan/epsilon.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The name of the sum of all components among the rows of tables.
inline constexpr const char* total_name = "total";

/// What makes two cells the same work; anything else is done again.
struct CellIdentity {
    std::string scene;   ///< name
    std::string method;  ///< label
    std::uint64_t seed = 1;
    std::string scene_hash;  ///< of its whole content, the resolution included
    std::uint32_t spp = 0;   ///< the last pass: part of the work where neither label nor content say it
    Budget budget;
    double epsilon = default_epsilon;
    int threads = 0;        ///< that computed it: seconds depend on them
    std::string reference;  ///< identity of the reference, its number of samples included

    /// 40 hexadecimal digits.
    std::string key() const;
    /// The name of its folder: readable, and different for different labels.
    std::string folder_name() const;
};

struct CellCheckpoint {
    Checkpoint checkpoint;
    std::map<std::string, ImageError> errors;  ///< by component, `total` included; those that are judged
};

/// One complete cell.
struct Cell {
    std::string scene, method;
    std::uint64_t seed = 1;
    std::string key;
    std::string build;        ///< of the program that measured it
    std::string image;        ///< digest of the final image's pixels (image_digest.h)
    std::string image_file;   ///< SHA-1 of its file; empty in records of earlier versions
    double load_seconds = 0;  ///< scene file and tree; shown, not charged
    double prepare_seconds = 0;
    bool converged = false;
    std::vector<CellCheckpoint> checkpoints;
    std::vector<StageTimes::Stage> stages;

    const Checkpoint& last() const { return checkpoints.back().checkpoint; }
};

struct IndexScene {
    std::string name;
    std::string path;
    std::string content_hash;
    std::string reference;  ///< identity; empty: there is none yet
    std::string reference_method;
    std::optional<double> target;    ///< relative standard error that was asked for
    std::vector<std::string> notes;  ///< warnings about the reference and about what is left out of judgement
};

/// The experiment as it was run: the rows that tables have, in their order.
struct ResultIndex {
    std::string title;
    std::string experiment_text;
    double epsilon = default_epsilon;
    int seeds = 1;
    int threads = 0;
    std::vector<IndexScene> scenes;
    std::vector<std::string> methods;                                            ///< labels
    std::map<std::pair<std::string, std::string>, std::string> effects_missing;  ///< (scene, label) -> names, by `;`
    std::map<std::string, std::string> cell_keys;                                ///< folder name of a cell -> key
};

class ResultFolder {
public:
    explicit ResultFolder(std::string path) : path_(std::move(path)) {}

    const std::string& path() const { return path_; }
    std::string file(const std::string& name) const { return path_ + "/" + name; }
    std::string cell_folder(const std::string& folder_name) const { return path_ + "/cells/" + folder_name; }
    /// What its process leaves for the run; gone once the cell is complete.
    std::string work_folder(const std::string& folder_name) const { return cell_folder(folder_name) + "/work"; }
    std::string cell_image(const std::string& folder_name) const { return cell_folder(folder_name) + "/final.exr"; }
    /// The final image's map of FLIP, if it has one.
    std::string flip_map(const std::string& folder_name) const { return cell_folder(folder_name) + "/flip.png"; }
    std::string reference_image(const std::string& scene) const {
        return path_ + "/images/" + scene + "-reference.exr";
    }
    /// The final image of seed 1.
    std::string method_image(const std::string& scene, const std::string& method) const {
        return method_file(scene, method, ".exr");
    }
    /// The map of FLIP of that image.
    std::string method_flip_map(const std::string& scene, const std::string& method) const {
        return method_file(scene, method, "-flip.png");
    }

    /// Makes a folder and its parents. Throws InputError if that is impossible, RunError on a full disk.
    static void make(const std::string& path);

    /// Makes the folder and those in it and sees that files can be made there. Throws InputError.
    void prepare() const;
    /// Removes what a killed run left unfinished. The caller must have locked the folder.
    void remove_leftovers() const;

    void write_index(const ResultIndex& index) const;
    /// Throws InputError if the folder holds no results.
    ResultIndex read_index() const;
    void write_cell(const std::string& folder_name, const Cell& cell) const;
    /// Empty if there is no complete cell with this key, or if its record or image is damaged: `damage`, if given, then
    /// says so.
    std::optional<Cell> read_cell(const std::string& folder_name, const std::string& key,
                                  std::string* damage = nullptr) const;

private:
    /// One of the images that show a method on a scene.
    std::string method_file(const std::string& scene, const std::string& method, const std::string& ending) const;

    std::string path_;
};

/// Where the results of an experiment of that name go: results/NAME. Throws InputError for names that would lead out of
/// it or into the references.
std::string result_folder_of(const std::string& experiment);

/// Throws InputError, with the reason, if no file can be made in a folder (RunError on a full disk). Asking for
/// permissions would not do: they do not bind root, and know nothing of read-only file systems.
void require_writable(const std::string& folder);

/// SHA-1 of a file's bytes.
std::string file_hash(const std::string& path);

/// A label or a name as part of a file's name.
std::string file_name_of(const std::string& text);

/// Where a cell's folder is.
std::string cell_folder_name(const std::string& scene, const std::string& method, std::uint64_t seed);

}  // namespace gib
