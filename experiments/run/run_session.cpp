#include "experiments/run/run_session.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "common/core/reject.h"
#include "experiments/analysis/analysis.h"
#include "experiments/report/report.h"
#include "experiments/report/terminal.h"
#include "experiments/report/words.h"
#include "experiments/results/manifest.h"

#include <fmt/format.h>

#include <filesystem>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// Throws InputError if a share of an experiment is measuring a cell in this folder.
void require_no_share(const ResultFolder& folder) {
    for (const auto& cell : fs::directory_iterator(folder.file("cells")))
        if (const std::string lock = folder.cell_lock(cell.path().filename()); is_locked(lock))
            reject({}, "{} is measuring a share of '{}': wait until it has ended", lock_owner(lock), folder.path());
}

/// Makes the folder, and locks it if this process works there alone.
std::optional<FileLock> opened(const ResultFolder& folder, FolderUse use) {
    folder.require_known_format();
    folder.prepare();
    const std::string references = fs::path(cached_reference_path("")).parent_path().string();
    ResultFolder::make(references);
    std::optional<FileLock> lock;
    if (use == FolderUse::alone) lock.emplace(lock_result_folder(folder.path()));
    require_writable(references);
    if (!lock) return lock;
    require_no_share(folder);
    folder.remove_leftovers();
    remove_leftovers_in(references);
    return lock;
}

/// Links a picture to `to`, or removes `to` if the tables do not have its cell.
void link_or_remove(bool is_there, const std::string& from, const std::string& to) {
    if (is_there) link_file(from, to);
    else fs::remove(to);
}

void link_images(const ResultIndex& index, const ResultFolder& folder) {
    for (const auto& scene : index.scenes)
        for (const auto& method : index.methods) {
            const std::string name = cell_folder_name(scene.name, method, 1);
            const auto key = index.cell_keys.find(name);
            const bool complete = key != index.cell_keys.end() && folder.read_cell(name, key->second);
            link_or_remove(complete, folder.cell_image(name), folder.method_image(scene.name, method));
            // A cell without FLIP has no map.
            link_or_remove(complete && fs::exists(folder.flip_map(name)), folder.flip_map(name),
                           folder.method_flip_map(scene.name, method));
        }
}

ResultIndex index_of(const RunSession& run) {
    const Experiment& experiment = run.setup.experiment;
    ResultIndex index;
    index.title = experiment.title;
    index.experiment_text = experiment.text;
    index.epsilon = experiment.epsilon;
    index.seeds = experiment.seeds;
    index.threads = run.setup.threads;
    for (std::size_t i = 0; i < run.setup.scenes.size(); ++i) {
        const RunScene& scene = run.setup.scenes[i];
        const std::string& image = scene.entry.reference_image;
        const std::size_t more = scene.entry.reference_replicates.size();
        index.scenes.push_back(
            {.name = scene.entry.name,
             .path = scene.entry.path,
             .content_hash = scene.content_hash,
             .reference = run.references.identity(i),
             .reference_method = image.empty()
                                     ? experiment.reference_method.text()
                                     : "the image " + image + (more > 0 ? fmt::format(" and {} more", more) : ""),
             .target = scene.entry.goal.target,
             .notes = run.references.notes(i)});
    }
    for (const auto& label : experiment.methods)
        index.methods.push_back(label.text());
    for (const auto& [label, external] : experiment.externals)
        index.externals.push_back(label);
    index.given_names = experiment.given_names;
    index.left_out = run.setup.left_out;
    for (const WorkCell& cell : run.list.all())
        if (!cell.identity.reference.empty()) index.cell_keys[cell.name] = cell.identity.key();
    return index;
}

}  // namespace

RunSession::RunSession(RunSetup checked, const RunOptions& options, FolderUse use)
    : setup(std::move(checked)),
      folder(result_folder_of(options.out, setup.experiment.name)),
      lock(opened(folder, use)),
      references(setup, folder, log),
      list(setup, options.only),
      runner(setup, folder, log) {
    log.progress.quiet = options.quiet;
    list.use(references);
}

void RunSession::make_references() {
    for (std::size_t scene = 0; scene < setup.scenes.size(); ++scene)
        if (list.has(scene)) references.make(scene);
    // The index has to keep the cells that other shares have measured meanwhile.
    for (std::size_t scene = 0; scene < setup.scenes.size(); ++scene)
        if (!list.has(scene)) references.read_stored(scene);
    list.use(references);
}

void RunSession::forget_cells() {
    std::size_t forgotten = 0;
    for (const WorkCell* cell : list.selected())
        forgotten += fs::remove(folder.cell_record(cell->name));
    if (forgotten > 0) log.progress.note(fmt::format("cells forgotten that were measured before: {}", forgotten));
}

std::string RunSession::what_is_left() const {
    const auto cells = list.with_records(folder);
    const std::size_t left = left_of(cells).size();
    if (left == 0) return "";
    return fmt::format("{} of {} cells are not complete; `gibench status {}` lists them", left, cells.size(),
                       folder.path());
}

void RunSession::write_index() { folder.write_index(index_of(*this)); }

std::string RunSession::write_results() {
    const ResultIndex index = index_of(*this);
    folder.write_index(index);
    ManifestRun manifest{.command_line = setup.command_line,
                         .experiment_file = setup.experiment.path,
                         .resolution = setup.experiment.resolution,
                         .cells = complete_cells(list, folder)};
    const auto write_manifest = [&] { write_file(folder.file("manifest.json"), manifest_text(index, manifest)); };
    write_manifest();  // the analysis reads it
    std::string report;
    with_threads(setup.threads, [&] {
        const Analysis analysis = analyse(folder);
        for (const auto& scene : index.scenes)
            manifest.unjudged[scene.name] = analysis.unjudged(scene.name);
        write_manifest();
        std::vector<std::string> damage = analysis.damage;
        link_images(index, folder);
        write_tables(analysis, folder);
        report = write_report(analysis, folder, &damage);
        verdict = terminal_verdict(analysis);
        for (const auto& what : damage)
            log.progress.message("warning: " + what);
        for (const Warning& warning : analysis.warnings) {
            const std::string text = about_scene(warning.scene, warning.sentence + help_of(warning));
            // A busy machine makes nothing wrong but times.
            if (warning.kind == Warning::Kind::busy_machine) log.progress.note("note: " + text);
            else log.progress.message("warning: " + text);
        }
    });
    return report;
}

}  // namespace gib
