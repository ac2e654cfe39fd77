#pragma once
// A result folder holds, besides tables, an index of the experiment and one record for each complete cell. Tables and
// the report are made from the index and the records alone.

#include "experiments/measuring/measure.h"
#include "experiments/metrics/statistics.h"
#include "experiments/results/layer.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The format of a result folder, which its index and its manifest name. A program reads no other format.
inline constexpr const char* results_format = "gibench results 1";

/// The name of the sum of all components in tables.
inline constexpr const char* total_name = "total";

/// The version of the definitions of errors and times, which rises when stored numbers mean something else.
inline constexpr int definitions_version = 1;

/// Everything that decides the result of a cell. A stored cell is reused only if all of it is equal.
struct CellIdentity {
    std::string scene;   ///< name
    std::string method;  ///< label
    std::uint64_t seed = 1;
    std::string scene_hash;  ///< hash of the scene's content, including the resolution
    std::uint32_t spp = 0;   ///< most passes; neither the label nor the scene need state them
    Budget budget;
    std::optional<double> epsilon;  ///< as the experiment gives it
    int threads = 0;                ///< number of threads, on which the seconds depend
    std::string reference;          ///< identity of the reference, its number of samples included
    std::string command = {};       ///< ExternalMethod::identity(); empty: a method of gibench

    /// SHA-1 of all members, 40 hexadecimal digits.
    std::string key() const;
};

struct CellCheckpoint {
    Checkpoint checkpoint;
    std::map<Layer, ImageError> errors;  ///< of the total and each component of the reference
};

/// One complete cell.
struct Cell {
    std::string scene, method;
    std::uint64_t seed = 1;
    std::string key;
    std::string build;        ///< digest of the program that measured it
    std::string image;        ///< digest of the final image's pixels (image_digest.h)
    std::string image_file;   ///< SHA-1 of the image's file
    double load_seconds = 0;  ///< time of reading the scene and building its tree; not charged
    double prepare_seconds = 0;
    bool converged = false;
    std::vector<CellCheckpoint> checkpoints;
    std::vector<StageTimes::Stage> stages;
    std::string cpu = {};          ///< name of the processor that measured it
    double processor_seconds = 0;  ///< Measurement::processor_seconds
    double waiting_seconds = 0;    ///< Measurement::waiting_seconds

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

/// The experiment as it was run: the scenes and methods of the tables' rows, in their order.
struct ResultIndex {
    std::string title;
    std::string experiment_text;
    std::optional<double> epsilon;  ///< as the experiment gives it; none: the default of each scene (epsilon.h)
    int seeds = 1;
    int threads = 0;
    int definitions = definitions_version;  ///< of the program that measured the cells
    std::vector<IndexScene> scenes;
    std::vector<std::string> methods;         ///< labels
    std::vector<std::string> externals = {};  ///< those of other renderers
    std::map<std::string, std::string> given_names =
        {};  ///< label -> its `label` in the experiment file, if it has one
    std::map<std::pair<std::string, std::string>, LeftOut> left_out;  ///< by scene and label
    std::map<std::string, std::string> cell_keys;                     ///< folder name of a cell -> key

    /// Whether the label is a command of another renderer.
    bool is_external(const std::string& label) const;
    /// Nothing, where nothing is known.
    LeftOut left_out_by(const std::string& scene, const std::string& label) const;
};

class ResultFolder {
public:
    explicit ResultFolder(std::string path) : path_(std::move(path)) {}

    const std::string& path() const { return path_; }
    std::string file(const std::string& name) const { return path_ + "/" + name; }
    std::string cell_folder(const std::string& folder_name) const { return path_ + "/cells/" + folder_name; }
    /// The folder in which the cell's process leaves its results. It is removed when the process has ended.
    std::string work_folder(const std::string& folder_name) const { return cell_folder(folder_name) + "/work"; }
    std::string cell_image(const std::string& folder_name) const { return cell_folder(folder_name) + "/final.exr"; }
    std::string cell_record(const std::string& folder_name) const { return cell_folder(folder_name) + "/cell.json"; }
    /// The lock of the process that measures the cell.
    std::string cell_lock(const std::string& folder_name) const { return cell_folder(folder_name) + "/.lock"; }
    /// The message of the cell's last attempt, if it failed.
    std::string failure_file(const std::string& folder_name) const { return cell_folder(folder_name) + "/failure.txt"; }
    /// The map of FLIP of the final image, if there is one.
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

    /// Makes the folder and its subfolders and checks that files can be made in them. Throws InputError, or RunError
    /// on a full disk.
    void prepare() const;
    /// Removes what a killed run left unfinished, but nothing of a cell that a share has begun. The caller must have
    /// locked the folder. A share that begins a command's cell at the same time may still lose its folder, and the cell
    /// fails.
    void remove_leftovers() const;

    /// Throws InputError if the index or the manifest names another format than results_format. Files that name none,
    /// or cannot be read, are accepted.
    void require_known_format() const;
    void write_index(const ResultIndex& index) const;
    /// Throws InputError if the folder holds no results, or results of another format.
    ResultIndex read_index() const;
    void write_cell(const std::string& folder_name, const Cell& cell) const;
    /// Reads the record of a cell. Empty if there is no complete cell with this key, or if its record or image is
    /// damaged; `damage`, if given, then receives a message.
    std::optional<Cell> read_cell(const std::string& folder_name, const std::string& key,
                                  std::string* damage = nullptr) const;

private:
    /// The path of one of the images that show a method on a scene.
    std::string method_file(const std::string& scene, const std::string& method, const std::string& ending) const;

    std::string path_;
};

/// The folder for the results of an experiment: that of --out, else results/NAME. Throws InputError for names that
/// would lead out of results/ or into results/references/.
std::string result_folder_of(const std::optional<std::string>& out, const std::string& experiment);

/// Throws InputError, with the reason, if no file can be made in a folder, or RunError on a full disk. It makes a
/// file to find out, because permissions do not bind root and do not show that a file system is read-only.
void require_writable(const std::string& folder);

/// SHA-1 of a file's bytes.
std::string file_hash(const std::string& path);

/// A label or a name as part of a file's name: at most 100 characters, with `_` for those that are unsafe.
std::string file_name_of(const std::string& text);

/// The name of a cell's folder: readable, and different for different labels.
std::string cell_folder_name(const std::string& scene, const std::string& method, std::uint64_t seed);

}  // namespace gib
