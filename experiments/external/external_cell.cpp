#include "experiments/external/external_cell.h"

#include "common/core/files.h"
#include "common/images/image_file.h"
#include "experiments/external/command_image.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>

namespace gib {

namespace {

namespace fs = std::filesystem;

std::string absolute(const std::string& path) { return fs::absolute(path).lexically_normal().string(); }

}  // namespace

CellTiming run_external_cell(const std::string& program, const ExternalCell& cell) {
    const std::string work = absolute(cell.work_folder), out = work + "/image." + cell.method.image_format;
    std::string scene = absolute(cell.scene_file);
    if (!cell.scene_text.empty()) {
        scene = work + "/scene.pov";
        write_file(scene, cell.scene_text);
    }
    std::map<std::string, std::string> values = {{"scene", scene},
                                                 {"out", out},
                                                 {"spp", std::to_string(cell.spp)},
                                                 {"seed", std::to_string(cell.seed)},
                                                 {"threads", std::to_string(cell.threads)},
                                                 {"width", std::to_string(cell.width)},
                                                 {"height", std::to_string(cell.height)}};
    if (cell.seconds) values["seconds"] = fmt::format("{}", *cell.seconds);
    const auto [image, cost] = run_image_command(program, {.name = "its command",
                                                           .command = filled_command(cell.method, values),
                                                           .out = out,
                                                           .folder = absolute(cell.folder),
                                                           .timeout = cell.method.timeout,
                                                           .width = cell.width,
                                                           .height = cell.height,
                                                           .cell_folder = cell.cell_folder,
                                                           .work_folder = work});
    write_scratch_exr(checkpoint_image(cell.work_folder, cell.spp), {{{"", image}}, {}});
    CellTiming timing;
    timing.measurement.checkpoints.push_back(
        {.passes = cell.spp, .seconds = cost.seconds, .counts = {}, .peak_rss_mib = cost.peak_rss_mib});
    timing.measurement.stages.push_back({"command", cost.seconds});
    return timing;
}

}  // namespace gib
