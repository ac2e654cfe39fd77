// Renders one cell of an experiment, judges its images and stores them.
#include "common/images/image_digest.h"
#include "common/images/image_file.h"
#include "experiments/external/external_cell.h"
#include "experiments/results/flip_record.h"
#include "experiments/results/frames.h"
#include "experiments/results/judgement.h"
#include "experiments/results/manifest.h"
#include "experiments/run/cell_queue.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// The folder in the result folder in which the command of another renderer finds its scene and leaves its image. Its name
/// has no characters of a label, because some programs cannot take a path with `=`.
constexpr const char* command_folder = "command";

/// The work folder of a cell, which is removed with this object: on a full disk, what a failed cell left there would
/// take the space of all others.
class WorkFolder {
public:
    explicit WorkFolder(std::string path) : path_(std::move(path)) {
        fs::remove_all(path_);
        ResultFolder::make(path_);
    }
    ~WorkFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

}  // namespace

CellTiming ExperimentRun::render_cell(const PlannedCell& cell, const std::string& work_folder,
                                      const PassObserver& observer) {
    if (!cell.external) {
        const CellRequest request{.scene_path = cell.scene->entry.path,
                                  .resolution = experiment_.resolution,
                                  .folders = experiment_.paths,
                                  .scene_hash = cell.identity.scene_hash,
                                  .method = cell.identity.method,
                                  .seed = cell.identity.seed,
                                  .budget = cell.identity.budget,
                                  .threads = threads_,
                                  .work_folder = work_folder};
        return run_cell_process(options_.program, request, observer);
    }
    const bool in_povray_form = cell.external->scene_format == SceneFormat::povray;
    const std::uint32_t spp = std::min(cell.identity.spp, cell.identity.budget.passes.value_or(cell.identity.spp));
    const ExternalCell external{.method = *cell.external,
                                .scene_file = cell.scene->entry.path,
                                .scene_text = in_povray_form ? cell.scene->povray : "",
                                .folder = fs::path(fs::absolute(experiment_.path)).parent_path().string(),
                                .width = cell.scene->width,
                                .height = cell.scene->height,
                                .seed = cell.identity.seed,
                                .spp = spp,
                                .seconds = cell.identity.budget.seconds,
                                .threads = threads_,
                                .cell_folder = folder_.cell_folder(cell.name),
                                .work_folder = work_folder};
    return run_external_cell(options_.program, external);
}

void ExperimentRun::run_cell(const PlannedCell& cell, const Judgement& judgement, const PassObserver& observer) {
    const std::string folder = folder_.cell_folder(cell.name);
    if (cell.external && judgement.leaves_out_components())
        throw RunError(
            "the reference does not resolve some components, and the image of another renderer has none, so that "
            "the rest of it cannot be judged");
    fs::remove(folder + "/cell.json");  // from here on the cell is not complete
    fs::remove(folder_.failure_file(cell.name));
    forget_flip(folder_, cell.name);
    forget_frames(folder_, cell.name);
    ResultFolder::make(folder);
    const std::string for_command =
        options_.shared ? fmt::format("{}-{}", command_folder, cell.identity.key().substr(0, 12)) : command_folder;
    const WorkFolder work(cell.external ? folder_.file(for_command) : folder_.work_folder(cell.name));
    const CellTiming timing = render_cell(cell, work.path(), observer);

    Cell record;
    record.scene = cell.identity.scene;
    record.method = cell.identity.method;
    record.seed = cell.identity.seed;
    record.key = cell.identity.key();
    record.build = build_;
    record.cpu = cpu_model();
    record.processor_seconds = timing.measurement.processor_seconds;
    record.waiting_seconds = timing.measurement.waiting_seconds;
    record.load_seconds = timing.load_seconds;
    record.prepare_seconds = timing.measurement.prepare_seconds;
    record.converged = timing.measurement.converged;
    record.stages = timing.measurement.stages;
    const double epsilon = judgement.epsilon(experiment_.epsilon);
    for (const auto& checkpoint : timing.measurement.checkpoints) {
        const LayeredImage image = read_image(checkpoint_image(work.path(), checkpoint.passes));
        record.checkpoints.push_back({checkpoint, judgement.errors(image, epsilon)});
        if (keeps_frame(record.seed, checkpoint.passes, timing.measurement.checkpoints.back().passes))
            write_frame(folder_, cell.name, checkpoint.passes, judgement.total_of(image));
    }
    LayeredImage image = read_image(checkpoint_image(work.path(), record.last().passes));
    image.metadata.clear();
    if (!cell.external) image = layers_of(components_in(image));
    write_exr(folder_.cell_image(cell.name), image);
    record.image = image_digest(image);
    record.image_file = file_hash(folder_.cell_image(cell.name));
    folder_.write_cell(cell.name, record);
    if (const NonFinite& bad = record.last().counts.non_finite; bad.count > 0)
        progress_.message(fmt::format(
            "warning: {}, {}: {} samples were not finite and were dropped; first: seed {}, pass {}, pixel {}",
            record.scene, record.method, bad.count, record.seed, bad.first_pass, bad.first_pixel));
}

}  // namespace gib
