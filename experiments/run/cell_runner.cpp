#include "experiments/run/cell_runner.h"

#include "common/core/files.h"
#include "common/images/image_digest.h"
#include "common/images/image_file.h"
#include "experiments/external/commands.h"
#include "experiments/results/pictures.h"
#include "experiments/system/build_info.h"
#include "experiments/system/file_lock.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// A folder that is removed with this object: on a full disk, what a failed cell left there would take the space of all
/// others.
struct WorkFolder {
    std::string path;
    ~WorkFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};

/// The folder in which a cell's process leaves its images. The one of a command has no characters of a label in its
/// name, because some programs cannot take a path with `=`.
std::string work_folder_of(const WorkCell& cell, const ResultFolder& folder) {
    return cell.has_command() ? folder.file("command-" + cell.identity.key().substr(0, 12))
                              : folder.work_folder(cell.name);
}

}  // namespace

void CellRunner::run(const WorkCell& cell, const PassObserver& observer) {
    try {
        if (cell.identity.reference.empty()) throw RunError("the scene has no reference");
        ResultFolder::make(folder_.cell_folder(cell.name));
        const auto lock = FileLock::if_free(folder_.cell_lock(cell.name));
        if (!lock || folder_.read_cell(cell.name, cell.identity.key())) return;
        measure(cell, observer);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& error) {
        log_.fail(cell.text(), error.what());
        keep_failure(cell.name, error.what());
    }
}

void CellRunner::keep_failure(const std::string& cell, const std::string& message) {
    try {
        ResultFolder::make(folder_.cell_folder(cell));
        write_file(folder_.failure_file(cell), message + "\n");
    } catch (const std::exception& error) {
        log_.progress.message(fmt::format("warning: the message is not kept: {}", error.what()));
    }
}

void CellRunner::measure(const WorkCell& cell, const PassObserver& observer) {
    if (referred_ != cell.identity.reference) {
        referred_.clear();
        judgement_.reset();
        reference_.reset();
        reference_ = read_reference(folder_.reference_image(cell.identity.scene));
        judgement_.emplace(*reference_);
        referred_ = cell.identity.reference;
    }
    if (cell.has_command() && judgement_->leaves_out_components())
        throw RunError(
            "no verdict: the reference lacks components, which cannot be separated in the image of a command");
    fs::remove(folder_.cell_record(cell.name));  // from here on the cell is not complete
    fs::remove(folder_.failure_file(cell.name));
    forget_flip(folder_, cell.name);
    forget_frames(folder_, cell.name);
    const WorkFolder work{work_folder_of(cell, folder_)};
    fs::remove_all(work.path);
    ResultFolder::make(work.path);
    const Cell record = judged(cell, render(cell, work.path, observer), work.path);
    folder_.write_cell(cell.name, record);
    if (const NonFinite& bad = record.last().counts.non_finite; bad.count > 0)
        log_.progress.message(fmt::format(
            "warning: {}, {}: {} samples were not finite and were dropped; first: seed {}, pass {}, pixel {}",
            record.scene, record.method, bad.count, record.seed, bad.first_pass, bad.first_pixel));
}

Measurement CellRunner::render(const WorkCell& cell, const std::string& work_folder,
                               const PassObserver& observer) const {
    const RunScene& scene = setup_.scenes[cell.scene];
    const CellIdentity& identity = cell.identity;
    const auto command_cell = [&](const ExternalMethod& method) {
        return CommandCell{
            .method = method,
            .folder = fs::absolute(setup_.experiment.path).lexically_normal().parent_path().string(),
            .width = scene.width,
            .height = scene.height,
            .threads = setup_.threads,
            .cell_folder = folder_.cell_folder(cell.name),
            .work_folder = work_folder,
        };
    };
    if (cell.external) {
        Measurement result = run_external_cell(
            command_cell(*cell.external), {.scene_file = scene.entry.path,
                                           .seed = identity.seed,
                                           .spp = std::min(identity.spp, identity.budget.passes.value_or(identity.spp)),
                                           .seconds = identity.budget.seconds});
        // More time would not change its image.
        result.converged = !cell.external->takes("spp") && !cell.external->takes("seconds");
        return result;
    }
    const auto reads = [&](const char* layer) { return cell.filter && cell.filter->takes(layer); };
    Measurement result = run_cell_process({.scene_path = scene.entry.path,
                                           .resolution = setup_.experiment.resolution,
                                           .folders = setup_.experiment.paths,
                                           .scene_hash = identity.scene_hash,
                                           .method = identity.method,
                                           .seed = identity.seed,
                                           .budget = identity.budget,
                                           .threads = setup_.threads,
                                           .features = reads("albedo") || reads("normal") || reads("depth"),
                                           .variance = reads("variance"),
                                           .work_folder = work_folder},
                                          observer);
    if (cell.filter) filter_checkpoints(command_cell(*cell.filter), result);
    return result;
}

Cell CellRunner::judged(const WorkCell& cell, const Measurement& measured, const std::string& work_folder) const {
    Cell record;
    record.scene = cell.identity.scene;
    record.method = cell.identity.method;
    record.seed = cell.identity.seed;
    record.key = cell.identity.key();
    record.build = setup_.build;
    record.processor_seconds = measured.processor_seconds;
    record.waiting_seconds = measured.waiting_seconds;
    record.load_seconds = measured.load_seconds;
    record.prepare_seconds = measured.prepare_seconds;
    record.converged = measured.converged;
    record.stages = measured.stages;
    record.cpu = cpu_model();
    const double epsilon = judgement_->epsilon(setup_.experiment.epsilon);
    LayeredImage image;
    for (const auto& checkpoint : measured.checkpoints) {
        image = read_image(checkpoint_image(work_folder, checkpoint.passes));
        record.checkpoints.push_back({checkpoint, judgement_->errors(image, epsilon)});
        if (keeps_frame(record.seed, checkpoint.passes, measured.checkpoints.back().passes))
            write_frame(folder_, cell.name, checkpoint.passes, judgement_->total_of(image));
    }
    image.metadata.clear();
    if (!cell.has_command()) image = layers_of(components_in(image));
    write_exr(folder_.cell_image(cell.name), image);
    record.image = image_digest(image);
    record.image_file = file_hash(folder_.cell_image(cell.name));
    return record;
}

namespace {

/// The share of a cell's work that is done, by the limit (spp, passes or seconds) that is nearest.
double share_done(const CellIdentity& cell, std::uint32_t passes, double seconds) {
    const auto done = static_cast<double>(passes);
    double share = done / cell.spp;
    if (cell.budget.passes) share = std::max(share, done / *cell.budget.passes);
    if (cell.budget.seconds) share = std::max(share, seconds / *cell.budget.seconds);
    return std::min(share, 1.0);
}

}  // namespace

std::size_t run_cells(const std::vector<const WorkCell*>& cells, CellRunner& runner, ProgressLine& progress,
                      const std::function<double()>& seconds_left) {
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (seconds_left && !(seconds_left() > 0)) {
            progress.note(fmt::format("no time is left for {} cells", cells.size() - i));
            return i;
        }
        const WorkCell& cell = *cells[i];
        // Cells are taken to last as long as the mean of those before.
        const auto show = [&](std::uint32_t passes, double seconds) {
            const double done = (static_cast<double>(i) + share_done(cell.identity, passes, seconds)) /
                                static_cast<double>(cells.size());
            double left = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() *
                          (1 / std::max(done, 1e-9) - 1);
            if (seconds_left) left = std::min(left, std::max(0.0, seconds_left()));
            progress.update(done, done > 0 ? std::optional(left) : std::nullopt,
                            fmt::format("cell {} of {}: {}", i + 1, cells.size(), cell.text()));
        };
        show(0, 0);
        runner.run(cell, show);
    }
    return cells.size();
}

}  // namespace gib
